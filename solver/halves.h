// The images of two independent halves of a render's samples, which judge each other.
#pragma once

#include "runtime/device/buffer.h"
#include "solver/poisson_solver.h"

#include <array>
#include <cstdint>

namespace gradus {

/// Planes as PoissonImages has them (poisson_solver.h): dx and dy are missing where a method has no differences. Each
/// has its variances, of the means: those of single samples over their number.
struct HalfImages {
    Buffer primal, dx, dy;
    Buffer primal_variance, dx_variance, dy_variance;
    /// Of all pixels: how much the half counts.
    std::uint64_t samples = 0;
};

/// That of the even samples of each pixel, and that of the odd ones. They have no random number in common but
/// what all pixels of a sample share.
using HalvedImages = std::array<HalfImages, 2>;

/// The same in memory of the host. What is null is not there.
struct HostHalves {
    std::array<HostImages, 2> images;
    std::array<std::uint64_t, 2> samples{};
};
HalvedImages uploaded_halves(Device &device, const HostHalves &halves, std::size_t bytes_of_image);

/// A half needs so many samples of each pixel to have a variance.
constexpr std::uint64_t least_half_samples = 2;

/// Whether both halves have those.
constexpr bool halves_have_variances(std::uint64_t samples, std::uint64_t pixels) {
    return samples / pixels >= 2 * least_half_samples;
}

} // namespace gradus
