#include "runtime/trace/ray_order.h"

#include <algorithm>

namespace gradus {

namespace {

/// Spreads three bits so that two zeros follow each.
constexpr std::uint32_t spread(std::uint32_t x) { return (x & 1u) | (x & 2u) << 2 | (x & 4u) << 4; }

} // namespace

void RayOrdering::sort(std::vector<std::uint32_t> &rows, const float *const origin[3],
                       const float *const direction[3], bool by_cell) {
    const std::size_t count = rows.size();
    keys_.resize(count);
    sorted_.resize(count);
    const std::size_t key_count = by_cell ? 8 * cells * cells * cells : 8;
    count_.assign(key_count + 1, 0);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t row = rows[i];
        std::uint32_t key = 0;
        for (int axis = 0; axis < 3; ++axis)
            key |= (direction[axis][row] < 0 ? 1u : 0u) << axis;
        if (by_cell) {
            std::uint32_t cell = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const float place = (origin[axis][row] - low_[axis]) * scale_[axis];
                const int step = std::clamp(static_cast<int>(place), 0, cells - 1);
                cell |= spread(static_cast<std::uint32_t>(step)) << axis;
            }
            key = key << 9 | cell;
        }
        keys_[i] = static_cast<std::uint16_t>(key);
    }
    for (std::size_t i = 0; i < count; ++i)
        ++count_[keys_[i] + 1];
    for (std::size_t key = 1; key <= key_count; ++key)
        count_[key] += count_[key - 1];
    for (std::size_t i = 0; i < count; ++i)
        sorted_[count_[keys_[i]]++] = rows[i];
    rows.swap(sorted_);
}

} // namespace gradus
