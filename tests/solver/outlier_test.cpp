// L1 against outliers: a gradient or a primal pixel that is off by 1e6 must stay where it is.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"

#include <ostream>

namespace gradus::testing {
namespace {

constexpr std::uint32_t width = 128, height = 96;

struct Place {
    std::uint32_t x, y;
};
constexpr Place places[] = {{30, 20}, {90, 15}, {64, 48}, {31, 75}, {100, 70}};

double distance_to_places(std::uint32_t x, std::uint32_t y) {
    double nearest = 1e9;
    for (const Place &place : places)
        nearest = std::min(nearest, std::hypot(double(x) - place.x, double(y) - place.y));
    return nearest;
}

/// Mean squared error against the clean image, relative as in relMSE, of pixels farther from the places than
/// `distance`, and nearer.
struct Errors {
    double far = 0, near = 0;
};

Errors errors(const PoissonProblem &problem, const std::vector<float> &image, double distance) {
    Errors sums, counts;
    for (std::uint32_t c = 0; c < problem.channels; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t i = problem.at(c, x, y);
                const double clean = problem.clean[i];
                const double error = std::pow(image[i] - clean, 2) / (clean * clean + 1e-3);
                (distance_to_places(x, y) > distance ? sums.far : sums.near) += error;
                (distance_to_places(x, y) > distance ? counts.far : counts.near) += 1;
            }
    return {sums.far / counts.far, sums.near / counts.near};
}

struct Case {
    const char *name;
    bool joint, keep_mean;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

class Outliers : public ::testing::TestWithParam<Case> {
  protected:
    static PoissonOptions options() {
        PoissonOptions options;
        options.joint_channels = GetParam().joint;
        options.keep_mean = GetParam().keep_mean;
        return options;
    }

    /// An outlier in one equation leaves its weight at about 1e-6, as if the equation were not there, and takes nothing
    /// from the others. So the image hardly differs from the one without that equation, even beside it.
    void check(std::vector<float> PoissonProblem::*input, float outlier, const char *provoked_by) {
        PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
        PoissonSolver &solver = solver_for(problem);
        const Errors before = errors(problem, solve(solver, problem.images(), options()).image, 4);
        for (const Place &place : places)
            (problem.*input)[problem.at(1, place.x, place.y)] += outlier;
        const Errors after = errors(problem, solve(solver, problem.images(), options()).image, 4);
        std::printf("relMSE away from outliers %.5f, without them %.5f; beside them %.5f, %.5f\n", after.far,
                    before.far, after.near, before.near);
        record_stability({"Reconstruction", "outliers: one value off by far decides many pixels", provoked_by,
                          "L1: their weight falls to nothing, as if they were not there",
                          "how much more relMSE there is more than 4 pixels away, relatively",
                          std::max(after.far / before.far - 1, 0.0), 0.05});
        EXPECT_LE(after.near, before.near * 2);
    }
};

TEST_P(Outliers, InDx) { check(&PoissonProblem::dx, 1e6f, "five differences in dx off by 1e6"); }
TEST_P(Outliers, InDy) { check(&PoissonProblem::dy, -1e6f, "five differences in dy off by -1e6"); }
TEST_P(Outliers, InThePrimal) { check(&PoissonProblem::primal, 1e3f, "five pixels of the primal off by 1e3"); }

INSTANTIATE_TEST_SUITE_P(L1, Outliers,
                         ::testing::Values(Case{"Plain", true, false}, Case{"PlainByChannel", false, false},
                                           Case{"KeepMean", true, true}, Case{"KeepMeanByChannel", false, true}),
                         [](const auto &info) { return std::string(info.param.name); });

/// L2 spreads an outlier over the image, which is why L1 exists; this shows that the test above can tell.
TEST(OutliersL2, AreSpread) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
    problem.dx[problem.at(1, 64, 48)] += 1e6f;
    EXPECT_GT(errors(problem, solve(problem, l2_options(LinearMethod::automatic)).image, 4).far, 1e3);
}

} // namespace
} // namespace gradus::testing
