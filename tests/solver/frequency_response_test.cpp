// The frequency response of the L2 solver: Lehtinen et al. 2013, eq. 19,
//
//     F{I} = (alpha^2 F{Ig} + conj(Hx) F{Ix} + conj(Hy) F{Iy}) / (alpha^2 + |Hx|^2 + |Hy|^2),   H = e^(i w) - 1,
//
// which is for periodic images. With free borders the eigenvectors of the operator are the modes of the DCT-II,
// P(x) = cos(w (x + 1/2)) at w = pi k / W, with eigenvalue 4 sin^2(w / 2) = |H|^2. Their differences are modes of the
// DST-I, P(x + 1) - P(x) = -2 sin(w / 2) S(x) with S(x) = sin(w (x + 1)), and the adjoint gives S(x - 1) - S(x) =
// -2 sin(w / 2) P(x). So a primal P comes out times alpha^2 / (alpha^2 + |H|^2), and a difference S as P times
// -2 sin(w / 2) / (alpha^2 + |H|^2): conj(H) up to its phase, which is that of the half pixel between P and S.
#include "tests/solver/solver_fixture.h"
#include "tests/support/worse.h"

namespace gradus::testing {
namespace {

constexpr std::uint32_t width = 20, height = 13, channels = 8;
constexpr double allowed = 1e-4;

enum class Input { primal, dx, dy };

struct Mode {
    std::uint32_t i = 0, j = 0;
    double wx() const { return std::numbers::pi * i / width; }
    double wy() const { return std::numbers::pi * j / height; }
    double eigenvalue() const { return 4 * std::pow(std::sin(wx() / 2), 2) + 4 * std::pow(std::sin(wy() / 2), 2); }
    double cosine(std::uint32_t x, std::uint32_t y) const {
        return std::cos(wx() * (x + 0.5)) * std::cos(wy() * (y + 0.5));
    }
    double value(Input input, std::uint32_t x, std::uint32_t y) const {
        switch (input) {
        case Input::dx:
            return std::sin(wx() * (x + 1)) * std::cos(wy() * (y + 0.5));
        case Input::dy:
            return std::cos(wx() * (x + 0.5)) * std::sin(wy() * (y + 1));
        default:
            return cosine(x, y);
        }
    }
    double gain(Input input, double alpha) const {
        const double numerator = input == Input::dx   ? -2 * std::sin(wx() / 2)
                                 : input == Input::dy ? -2 * std::sin(wy() / 2)
                                                      : alpha * alpha;
        return numerator / (alpha * alpha + eigenvalue());
    }
};

/// All frequencies, a mode in each channel of as many problems as it takes.
class FrequencyResponse : public ::testing::TestWithParam<LinearMethod> {
  protected:
    void check(Input input, double alpha) {
        PoissonProblem problem;
        problem.width = width;
        problem.height = height;
        problem.channels = channels;
        PoissonSolver &solver = solver_for(problem);
        std::vector<Mode> modes;
        for (std::uint32_t j = 0; j < height; ++j)
            for (std::uint32_t i = 0; i < width; ++i)
                if ((input != Input::dx || i > 0) && (input != Input::dy || j > 0))
                    modes.push_back({i, j});
        for (std::size_t first = 0; first < modes.size(); first += channels) {
            const std::size_t count = std::min<std::size_t>(channels, modes.size() - first);
            for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
                plane->assign(problem.pixels() * channels, 0);
            std::vector<float> &plane = input == Input::dx   ? problem.dx
                                        : input == Input::dy ? problem.dy
                                                             : problem.primal;
            for (std::uint32_t c = 0; c < count; ++c)
                for (std::uint32_t y = 0; y < height; ++y)
                    for (std::uint32_t x = 0; x < width; ++x)
                        plane[problem.at(c, x, y)] = float(modes[first + c].value(input, x, y));
            // The residual of one mode falls by its eigenvalue, but tolerances are for all channels together.
            const Solution solution = solve(solver, problem.images(), l2_options(GetParam(), alpha, 1e-7));
            for (std::uint32_t c = 0; c < count; ++c)
                compare(problem, solution.image, c, modes[first + c], input, alpha);
        }
    }

    void compare(const PoissonProblem &problem, const std::vector<float> &image, std::uint32_t channel,
                 const Mode &mode, Input input, double alpha) {
        double projection = 0, squares = 0, far = 0;
        const double gain = mode.gain(input, alpha);
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const double cosine = mode.cosine(x, y), value = image[problem.at(channel, x, y)];
                projection += value * cosine;
                squares += cosine * cosine;
                far = worse(far, std::abs(value - gain * cosine));
            }
        const double measured = projection / squares;
        EXPECT_NEAR(measured / gain, 1, allowed) << "frequency " << mode.i << ", " << mode.j << ", alpha " << alpha;
        EXPECT_LE(far, allowed * std::max(1.0, std::abs(gain)))
            << "other frequencies beside " << mode.i << ", " << mode.j << ", alpha " << alpha;
        largest = worse(largest, std::abs(measured / gain - 1));
    }

    void TearDown() override { std::printf("largest relative deviation %.1e\n", largest); }

    double largest = 0;
};

TEST_P(FrequencyResponse, ToThePrimal) {
    for (const double alpha : {0.2, 0.5, 1.0})
        check(Input::primal, alpha);
}

TEST_P(FrequencyResponse, ToDifferences) {
    for (const double alpha : {0.2, 0.5, 1.0}) {
        check(Input::dx, alpha);
        check(Input::dy, alpha);
    }
}

INSTANTIATE_TEST_SUITE_P(Solver, FrequencyResponse,
                         ::testing::Values(LinearMethod::cg, LinearMethod::pcg, LinearMethod::multigrid),
                         method_parameter_name);

} // namespace
} // namespace gradus::testing
