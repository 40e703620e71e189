#include "runtime/trace/ray_order.h"

#include "runtime/trace/clones.h"

#include <algorithm>

namespace gradus {

namespace {

constexpr int cells = 1 << RayOrdering::cell_bits;
constexpr std::uint32_t cell_count = cells * cells * cells;

/// Spreads three bits so that two zeros follow each.
constexpr std::uint32_t spread(std::uint32_t x) { return (x & 1u) | (x & 2u) << 2 | (x & 4u) << 4; }

inline std::uint32_t step(float place) {
    // As a signed number first: a NaN or an outlier must still land in some cell.
    const int whole = static_cast<int>(place);
    return static_cast<std::uint32_t>(whole < 0 ? 0 : whole >= cells ? cells - 1 : whole);
}

/// Keys of rows [0, count): octant, then cell; `unwanted` for rows of another state. One plain loop over columns, so
/// that the compiler vectorises it.
GRADUS_CLONES void make_keys(const float *ox, const float *oy, const float *oz, const float *dx, const float *dy,
                             const float *dz, const std::uint32_t *state, std::uint32_t wanted, const float *low,
                             const float *scale, bool by_cell, std::uint16_t unwanted, std::size_t count,
                             std::uint16_t *keys) {
    const float low_x = low[0], low_y = low[1], low_z = low[2];
    const float scale_x = by_cell ? scale[0] : 0, scale_y = by_cell ? scale[1] : 0, scale_z = by_cell ? scale[2] : 0;
    const std::uint32_t octant_step = by_cell ? cell_count : 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t octant = (dx[i] < 0 ? 1u : 0u) | (dy[i] < 0 ? 2u : 0u) | (dz[i] < 0 ? 4u : 0u);
        const std::uint32_t cell = spread(step((ox[i] - low_x) * scale_x)) |
                                   spread(step((oy[i] - low_y) * scale_y)) << 1 |
                                   spread(step((oz[i] - low_z) * scale_z)) << 2;
        const std::uint32_t key = octant * octant_step + cell;
        keys[i] = static_cast<std::uint16_t>(state[i] == wanted ? key : unwanted);
    }
}

} // namespace

RayOrdering::RayOrdering(const std::array<float, 3> &low, const std::array<float, 3> &high) : low_(low) {
    for (int axis = 0; axis < 3; ++axis) {
        const float extent = high[axis] - low[axis];
        scale_[axis] = extent > 0 ? cells / extent : 0;
    }
}

const std::vector<std::uint32_t> &RayOrdering::sort(const SegmentColumns &rays, const std::uint32_t *state,
                                                    std::uint32_t wanted, std::size_t begin, std::size_t end,
                                                    RayOrder order) {
    groups_.assign(1, 0);
    if (order == RayOrder::none) {
        sorted_.clear();
        for (std::size_t row = begin; row < end; ++row)
            if (state[row] == wanted)
                sorted_.push_back(static_cast<std::uint32_t>(row));
        groups_.push_back(static_cast<std::uint32_t>(sorted_.size()));
        return sorted_;
    }
    const std::size_t count = end - begin;
    const bool by_cell = order == RayOrder::cell;
    const std::uint32_t octant_keys = by_cell ? cell_count : 1, key_count = 8 * octant_keys;
    keys_.resize(count);
    make_keys(rays.origin[0] + begin, rays.origin[1] + begin, rays.origin[2] + begin, rays.direction[0] + begin,
              rays.direction[1] + begin, rays.direction[2] + begin, state + begin, wanted, low_.data(), scale_.data(),
              by_cell, static_cast<std::uint16_t>(key_count), count, keys_.data());
    // One more key than there are, for the rows that are not wanted: no branch is needed for them.
    count_.assign(key_count + 2, 0);
    for (std::size_t i = 0; i < count; ++i)
        ++count_[keys_[i] + 1u];
    for (std::uint32_t key = 1; key <= key_count; ++key)
        count_[key] += count_[key - 1];
    for (std::uint32_t octant = 1; octant <= 8; ++octant)
        groups_.push_back(count_[octant * octant_keys]);
    const std::size_t wanted_count = count_[key_count];
    sorted_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        sorted_[count_[keys_[i]]++] = static_cast<std::uint32_t>(begin + i);
    sorted_.resize(wanted_count);
    return sorted_;
}

} // namespace gradus
