// Puts rays in an order in which packets of neighbours stay together in the acceleration structure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace gradus {

/// Components of directions below this have no sign. Embree divides by 1e-18 for them, and takes the sides of a beam
/// from the least of its rays' quotients: one of them beside rays of negative components would lose all.
constexpr float least_component = 1e-18f;

/// How rays are put in order before they are traced.
enum class RayOrder {
    none,   ///< as they come
    octant, ///< by the signs of the direction
    cell    ///< by those and by a coarse Morton cell of the origin
};

/// The columns that extension and shadow rays share.
struct SegmentColumns {
    const float *origin[3];
    const float *direction[3];
    /// Of four lines of so many rows, row i of each is much like that of the others; 0: nothing is known.
    std::size_t line = 0;
    /// From this row on they are rays of a camera, pixel after pixel; only where `line` is 0.
    std::size_t alike_from = std::numeric_limits<std::size_t>::max();
};

/// Some rows [begin, end) and, line by line, those `apart` rows further on, which belong to them.
struct RowLines {
    std::size_t begin, end;
    std::uint32_t lines = 1; ///< or 4
    std::size_t apart = 0;
};

/// A counting sort of the rows of one chunk by a small key. Stable, so that the order never changes; rows that belong
/// together are side by side before.
class RayOrdering {
  public:
    /// `low` and `high` bound all ray origins.
    RayOrdering(const std::array<float, 3> &low, const std::array<float, 3> &high);

    static constexpr int cell_bits = 3; ///< along each axis

    /// The rows whose `state` equals `wanted`, in order; valid until the next call.
    const std::vector<std::uint32_t> &sort(const SegmentColumns &rays, const std::uint32_t *state, std::uint32_t wanted,
                                           const RowLines &rows, RayOrder order);

    /// Places in the sorted rows at which a new octant begins, the end included; one range for RayOrder::none.
    const std::vector<std::uint32_t> &groups() const { return groups_; }

  private:
    std::array<float, 3> low_{}, scale_{};
    std::vector<std::uint16_t> keys_;
    std::vector<std::uint32_t> sorted_, count_, groups_;
};

} // namespace gradus
