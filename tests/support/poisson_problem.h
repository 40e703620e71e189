// Synthetic problems for the screened Poisson solver: an image, and noisy estimates of it and of its differences.
#pragma once

#include "solver/poisson_solver.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus::testing {

/// Planes are laid out as in solver/poisson_solver.h. Differences hold 0 in the column or row that is not read.
struct PoissonProblem {
    std::uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> clean; ///< the image without noise
    std::vector<float> primal, dx, dy;
    std::vector<float> primal_variance, dx_variance, dy_variance; ///< of the noise that was added, where there is some

    std::size_t pixels() const { return std::size_t(width) * height; }
    std::size_t at(std::uint32_t channel, std::uint32_t x, std::uint32_t y) const {
        return (std::size_t(channel) * height + y) * width + x;
    }
    HostImages images() const;
    HostImages images_with_variances() const;
};

/// Noise relative to the local value of the image, scaled from pixel to pixel by a factor between 1/2 and 2.
struct PoissonNoise {
    double primal = 0.7;           ///< standard deviation of the logarithm: lognormal with mean 1, a heavy tail
    double gradient = 0.03;        ///< standard deviation of the differences
    double outlier_rate = 0.01;    ///< share of the differences with an outlier, in all channels
    double outlier_strength = 2.0; ///< its standard deviation
};

/// A smooth background with discs, a step and fine stripes, from about 0.02 to 5; channels differ.
std::vector<float> synthetic_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels);

/// The synthetic image with noise. Equal arguments give equal problems.
PoissonProblem make_poisson_problem(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                                    std::uint64_t seed, const PoissonNoise &noise = {});

/// The synthetic image with normal noise whose variances jump as those of renders do: next to none in the dark, and from
/// stripe to stripe by factors up to 30,000. Equal arguments give equal problems.
PoissonProblem make_jumping_problem(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                                    std::uint64_t seed);

/// The differences of `clean` and itself as the primal: no noise, but for the rounding of the differences.
PoissonProblem make_exact_problem(std::uint32_t width, std::uint32_t height, std::uint32_t channels);

} // namespace gradus::testing
