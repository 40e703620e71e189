#include "runtime/direct_light/shared_rays.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace gradus {

namespace {

/// The last of [0, end) for which `holds`, plus 1, where it holds for all before that one. (Of a view of numbers clang
/// 14 makes no std::ranges::partition_point.)
template <class Predicate>
std::size_t partition_point(std::size_t end, const Predicate &holds) {
    std::size_t begin = 0;
    while (begin < end) {
        const std::size_t middle = begin + (end - begin) / 2;
        if (holds(middle))
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

} // namespace

std::vector<std::uint32_t> shared_rays(const std::vector<float> &needs, double rays, std::uint32_t least,
                                       std::uint32_t most) {
    std::vector<std::size_t> order(needs.size()); // the neediest first
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return needs[a] > needs[b]; });
    std::vector<double> sums(needs.size() + 1, 0);
    for (std::size_t i = 0; i < order.size(); ++i)
        sums[i + 1] = sums[i] + needs[order[i]];
    // Rays for a need of one where the first `count` share them: those before `full` get the most.
    const auto rate = [&](std::size_t count) {
        const auto rest_over = [&](std::size_t full) {
            return (rays - double(full) * most) / (sums[count] - sums[full]);
        };
        const std::size_t full =
            partition_point(count, [&](std::size_t full) { return rest_over(full) * needs[order[full]] > most; });
        return full < count ? rest_over(full) : double(most) / needs[order[count - 1]];
    };
    const std::size_t count =
        partition_point(needs.size(), [&](std::size_t last) { return rate(last + 1) * needs[order[last]] >= least; });
    std::vector<std::uint32_t> shares(needs.size(), 0);
    const double of_all = count > 0 ? rate(count) : 0;
    for (std::size_t i = 0; i < count; ++i)
        shares[order[i]] = std::uint32_t(std::min<double>(of_all * needs[order[i]], most));
    return shares;
}

} // namespace gradus
