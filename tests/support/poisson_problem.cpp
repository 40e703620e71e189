#include "tests/support/poisson_problem.h"

#include <cmath>
#include <numbers>
#include <random>

namespace gradus::testing {

HostImages PoissonProblem::images() const {
    HostImages images;
    images.primal = primal.data();
    images.dx = dx.data();
    images.dy = dy.data();
    return images;
}

HostImages PoissonProblem::images_with_variances() const {
    HostImages result = images();
    result.primal_variance = primal_variance.data();
    result.dx_variance = dx_variance.data();
    result.dy_variance = dy_variance.data();
    return result;
}

std::vector<float> synthetic_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    struct Disc {
        double x, y, radius, value;
    };
    constexpr Disc discs[] = {
        {0.25, 0.3, 0.15, 1.5}, {0.7, 0.25, 0.08, 5.0}, {0.6, 0.7, 0.2, 0.05}, {0.2, 0.8, 0.1, 0.6}};
    std::vector<float> image;
    image.reserve(std::size_t(channels) * height * width);
    for (std::uint32_t c = 0; c < channels; ++c)
        for (std::uint32_t row = 0; row < height; ++row)
            for (std::uint32_t column = 0; column < width; ++column) {
                const double x = (column + 0.5) / width, y = (row + 0.5) / height;
                double value = 0.3 + 0.2 * std::cos(5 * x + 2 * c) * std::sin(4 * y + 1);
                if (x + 0.3 * y > 0.75) // a step
                    value *= 0.2;
                if (y > 0.9) // stripes of two pixels
                    value *= column / 2 % 2 ? 1.5 : 0.7;
                for (const Disc &disc : discs)
                    if (std::hypot(x - disc.x, y - disc.y) < disc.radius)
                        value = disc.value * (1 + 0.2 * c + 0.3 * x);
                image.push_back(float(value));
            }
    return image;
}

namespace {

float difference(const std::vector<float> &image, std::size_t from, std::size_t to) { return image[to] - image[from]; }

} // namespace

PoissonProblem make_exact_problem(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    PoissonProblem problem;
    problem.width = width;
    problem.height = height;
    problem.channels = channels;
    problem.clean = problem.primal = synthetic_image(width, height, channels);
    problem.dx.assign(problem.clean.size(), 0);
    problem.dy.assign(problem.clean.size(), 0);
    for (std::uint32_t c = 0; c < channels; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t i = problem.at(c, x, y);
                if (x + 1 < width)
                    problem.dx[i] = difference(problem.clean, i, i + 1);
                if (y + 1 < height)
                    problem.dy[i] = difference(problem.clean, i, i + width);
            }
    return problem;
}

PoissonProblem make_poisson_problem(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                                    std::uint64_t seed, const PoissonNoise &noise) {
    PoissonProblem problem = make_exact_problem(width, height, channels);
    const std::size_t size = problem.clean.size();
    problem.primal_variance.resize(size);
    problem.dx_variance.assign(size, 1);
    problem.dy_variance.assign(size, 1);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    const double gradient_variance =
        noise.gradient * noise.gradient + noise.outlier_rate * noise.outlier_strength * noise.outlier_strength;
    // An outlier comes from one path, so it is in all channels.
    const auto outlier = [&] {
        return uniform(random) < noise.outlier_rate ? noise.outlier_strength * normal(random) : 0;
    };
    const auto disturb = [&](float &difference, float &variance, double level, double outlier) {
        difference = float(difference + level * (noise.gradient * normal(random) + outlier));
        variance = float(level * level * gradient_variance);
    };
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const double factor = std::exp2(std::sin(2 * std::numbers::pi * (x + 2.0 * y) / (width + height)));
            const double sigma = noise.primal * factor, outlier_x = outlier(), outlier_y = outlier();
            for (std::uint32_t c = 0; c < channels; ++c) {
                const std::size_t i = problem.at(c, x, y);
                const double value = problem.clean[i];
                problem.primal[i] = float(value * std::exp(sigma * normal(random) - 0.5 * sigma * sigma));
                problem.primal_variance[i] = float(value * value * std::expm1(sigma * sigma));
                if (x + 1 < width)
                    disturb(problem.dx[i], problem.dx_variance[i], value * factor, outlier_x);
                if (y + 1 < height)
                    disturb(problem.dy[i], problem.dy_variance[i], value * factor, outlier_y);
            }
        }
    return problem;
}

PoissonProblem make_jumping_problem(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                                    std::uint64_t seed) {
    PoissonProblem problem = make_exact_problem(width, height, channels);
    const std::size_t size = problem.clean.size();
    problem.primal_variance.resize(size);
    problem.dx_variance.resize(size);
    problem.dy_variance.resize(size);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto disturb = [&](float &value, float &variance, double of_noise) {
        value = float(value + std::sqrt(of_noise) * normal(random));
        variance = float(of_noise);
    };
    for (std::uint32_t c = 0; c < channels; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t i = problem.at(c, x, y);
                const double level = problem.clean[problem.at(0, x, y)], square = 0.01 * level * level;
                const double stripes = x / 5 % 3 == 0 ? 30 : y / 7 % 4 == 0 ? 0.01 : 1;
                disturb(problem.primal[i], problem.primal_variance[i], level * level * level * stripes);
                if (x + 1 < width)
                    disturb(problem.dx[i], problem.dx_variance[i], square * (x % 40 < 3 ? 300 : stripes));
                if (y + 1 < height)
                    disturb(problem.dy[i], problem.dy_variance[i], square * (y % 50 < 2 ? 300 : stripes));
            }
    return problem;
}

} // namespace gradus::testing
