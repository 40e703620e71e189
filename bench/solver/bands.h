// Rows shared out among threads, for what the solver is measured against.
#pragma once

#include <cstddef>
#include <thread>
#include <vector>

namespace gradus::bench {

/// Calls work(first, last) for `threads` bands of `count` rows, each in a thread of its own, and waits for all.
template <class Work>
void in_bands(std::size_t count, int threads, Work work) {
    const auto bound = [&](int band) { return count * std::size_t(band) / std::size_t(threads); };
    std::vector<std::thread> others;
    for (int band = 1; band < threads; ++band)
        others.emplace_back([&, band] { work(bound(band), bound(band + 1)); });
    work(0, bound(1));
    for (std::thread &thread : others)
        thread.join();
}

} // namespace gradus::bench
