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
    // As a signed number: a NaN or an outlier must still land in some cell.
    return static_cast<std::uint32_t>(std::min(std::max(static_cast<int>(place), 0), cells - 1));
}

/// Where keys are made from: plain pointers that do not overlap, so that the compiler vectorises the loop.
struct KeyInput {
    const float *origin[3], *direction[3];
    const std::uint32_t *state;
    float low[3], scale[3]; ///< scale 0: no cells
    std::uint32_t octant_step, wanted, unwanted_key;
};

/// Keys of rows [0, count): octant, then cell; `unwanted_key` for rows of another state.
GRADUS_CLONES void make_keys(const KeyInput &input, std::size_t count, std::uint16_t *__restrict keys) {
    const float *__restrict ox = input.origin[0], *__restrict oy = input.origin[1], *__restrict oz = input.origin[2];
    const float *__restrict dx = input.direction[0], *__restrict dy = input.direction[1],
                            *__restrict dz = input.direction[2];
    const std::uint32_t *__restrict state = input.state;
    const float low_x = input.low[0], low_y = input.low[1], low_z = input.low[2];
    const float scale_x = input.scale[0], scale_y = input.scale[1], scale_z = input.scale[2];
    const std::uint32_t octant_step = input.octant_step, wanted = input.wanted, unwanted = input.unwanted_key;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t octant = std::uint32_t(dx[i] <= -least_component) |
                                     std::uint32_t(dy[i] <= -least_component) << 1 |
                                     std::uint32_t(dz[i] <= -least_component) << 2;
        const std::uint32_t cell = spread(step((ox[i] - low_x) * scale_x)) |
                                   spread(step((oy[i] - low_y) * scale_y)) << 1 |
                                   spread(step((oz[i] - low_z) * scale_z)) << 2;
        // A mask, not a choice: with a branch the loop would not be vectorised.
        const std::uint32_t mask = 0u - std::uint32_t(state[i] == wanted);
        keys[i] = static_cast<std::uint16_t>(((octant * octant_step + cell) & mask) | (unwanted & ~mask));
    }
}

/// Puts each row where its key says; `places` are those of the next ones.
template <std::uint32_t lines>
void place(const RowLines &rows, const std::uint16_t *__restrict keys, std::uint32_t *__restrict places,
           std::uint32_t *__restrict sorted) {
    const std::size_t count = rows.end - rows.begin;
    for (std::size_t i = 0; i < count; ++i)
        for (std::uint32_t line = 0; line < lines; ++line)
            sorted[places[keys[line * count + i]]++] = static_cast<std::uint32_t>(rows.begin + line * rows.apart + i);
}

} // namespace

RayOrdering::RayOrdering(const std::array<float, 3> &low, const std::array<float, 3> &high) : low_(low) {
    for (int axis = 0; axis < 3; ++axis) {
        const float extent = high[axis] - low[axis];
        scale_[axis] = extent > 0 ? cells / extent : 0;
    }
}

const std::vector<std::uint32_t> &RayOrdering::sort(const SegmentColumns &rays, const std::uint32_t *state,
                                                    std::uint32_t wanted, const RowLines &rows, RayOrder order) {
    groups_.assign(1, 0);
    const std::size_t count = rows.end - rows.begin;
    if (order == RayOrder::none) {
        sorted_.clear();
        for (std::size_t row = rows.begin; row < rows.end; ++row)
            for (std::size_t line = 0; line < rows.lines; ++line)
                if (const std::size_t at = row + line * rows.apart; state[at] == wanted)
                    sorted_.push_back(static_cast<std::uint32_t>(at));
        groups_.push_back(static_cast<std::uint32_t>(sorted_.size()));
        return sorted_;
    }
    const bool by_cell = order == RayOrder::cell;
    const std::uint32_t octant_keys = by_cell ? cell_count : 1, key_count = 8 * octant_keys;
    keys_.resize(rows.lines * count);
    KeyInput input;
    input.octant_step = octant_keys;
    input.wanted = wanted;
    input.unwanted_key = key_count;
    for (std::size_t line = 0; line < rows.lines; ++line) {
        const std::size_t begin = rows.begin + line * rows.apart;
        for (int axis = 0; axis < 3; ++axis) {
            input.origin[axis] = rays.origin[axis] + begin;
            input.direction[axis] = rays.direction[axis] + begin;
            input.low[axis] = low_[axis];
            input.scale[axis] = by_cell ? scale_[axis] : 0;
        }
        input.state = state + begin;
        make_keys(input, count, keys_.data() + line * count);
    }
    // One more key than there are, for the rows that are not wanted: no branch is needed for them.
    count_.assign(key_count + 2, 0);
    for (std::size_t i = 0; i < keys_.size(); ++i)
        ++count_[keys_[i] + 1u];
    for (std::uint32_t key = 1; key <= key_count; ++key)
        count_[key] += count_[key - 1];
    for (std::uint32_t octant = 1; octant <= 8; ++octant)
        groups_.push_back(count_[octant * octant_keys]);
    const std::size_t wanted_count = count_[key_count];
    sorted_.resize(keys_.size());
    if (rows.lines == 1)
        place<1>(rows, keys_.data(), count_.data(), sorted_.data());
    else
        place<4>(rows, keys_.data(), count_.data(), sorted_.data());
    sorted_.resize(wanted_count);
    return sorted_;
}

} // namespace gradus
