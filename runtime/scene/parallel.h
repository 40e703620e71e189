// Loops on all cores.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace gradus {

/// Runs `work(i)` for each of [0, count), on all cores where that is more than `grain`. What it throws is thrown here.
template <class Work>
void for_each_in_parallel(std::size_t count, const Work &work, std::size_t grain = 1 << 14) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto &range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            work(i);
    });
}

} // namespace gradus
