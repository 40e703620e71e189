#include "bench/solver/triad.h"

#include "bench/solver/bands.h"
#include "bench/spread.h"
#include "runtime/trace/clones.h"

#include <chrono>
#include <memory>
#include <vector>

namespace gradus::bench {

namespace {

GRADUS_CLONES void triad(float *a, const float *b, const float *c, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        a[i] = b[i] + 3.0f * c[i];
}

} // namespace

double triad_bandwidth(std::size_t total_bytes, int threads) {
    constexpr int passes = 10, rounds = 7;
    const std::size_t count = total_bytes / 12;
    const auto a = std::make_unique<float[]>(count), b = std::make_unique<float[]>(count),
               c = std::make_unique<float[]>(count);
    std::vector<double> rates;
    for (int round = 0; round < rounds; ++round) {
        const auto start = std::chrono::steady_clock::now();
        // Passes in one go: starting threads costs as much as a pass over small arrays.
        in_bands(count, threads, [&](std::size_t first, std::size_t last) {
            for (int pass = 0; pass < passes; ++pass)
                triad(a.get() + first, b.get() + first, c.get() + first, last - first);
        });
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        rates.push_back(double(passes) * 12.0 * double(count) / seconds);
    }
    return median(rates);
}

} // namespace gradus::bench
