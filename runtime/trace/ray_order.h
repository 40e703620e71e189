// Puts rays in an order in which packets of neighbours stay together in the acceleration structure.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace gradus {

/// A counting sort of the rows of one chunk by a small key. Stable.
class RayOrdering {
  public:
    /// `low` and `high` bound all ray origins.
    void set_bounds(const std::array<float, 3> &low, const std::array<float, 3> &high) {
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = low[axis];
            const float extent = high[axis] - low[axis];
            scale_[axis] = extent > 0 ? cells / extent : 0;
        }
    }

    static constexpr int cells = 8; ///< along each axis: 3 bits each

    /// Sorts `rows` (into the columns `origin` and `direction`) in place by direction octant, and where `by_cell` by
    /// the Morton cell of the origin within that.
    void sort(std::vector<std::uint32_t> &rows, const float *const origin[3], const float *const direction[3],
              bool by_cell);

  private:
    std::array<float, 3> low_{}, scale_{};
    std::vector<std::uint16_t> keys_;
    std::vector<std::uint32_t> sorted_;
    std::vector<std::uint32_t> count_;
};

} // namespace gradus
