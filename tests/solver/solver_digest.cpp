// Solves a small problem in every way and prints a hash of each result's bits: for tests that run it with other numbers
// of threads, and under oclgrind.
//
//     solver_digest WIDTH HEIGHT THREADS [few]
//
// few: not all pairs of options, but each option with either value, and as few steps as call every kernel.
#include "solver/poisson_solver.h"
#include "tests/support/poisson_problem.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>

namespace gradus::testing {
namespace {

/// FNV-1a, 64 bits.
std::uint64_t hash(const std::vector<float> &values) {
    std::uint64_t result = 14695981039346656037ull;
    for (const float value : values) {
        std::uint32_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        for (int byte = 0; byte < 4; ++byte)
            result = (result ^ (bits >> (8 * byte) & 255)) * 1099511628211ull;
    }
    return result;
}

void print_digests(std::uint32_t width, std::uint32_t height, int threads, bool few) {
    const char *selector = std::getenv("GRADUS_TEST_DEVICE");
    Device device(selector ? selector : "", threads);
    std::fprintf(stderr, "%s, %u compute units\n", device.description().platform.c_str(),
                 device.description().compute_units);
    PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
    PoissonSolver solver(device, width, height, 3);
    const auto print = [&](const std::string &name, const HostImages &images, const PoissonOptions &options) {
        std::vector<float> result(problem.primal.size());
        const PoissonReport report = solver.solve(images, options, result.data());
        bool finite = true;
        for (const float value : result)
            finite = finite && std::isfinite(value);
        std::printf("%s: %s, %d steps, %s, %016llx\n", name.c_str(), report.method.c_str(), report.iterations,
                    finite ? "finite" : "not finite", static_cast<unsigned long long>(hash(result)));
    };

    for (const LinearMethod method :
         {LinearMethod::jacobi, LinearMethod::cg, LinearMethod::pcg, LinearMethod::multigrid})
        for (const bool weighted : {false, true}) {
            if (few && weighted && method == LinearMethod::cg)
                continue; // the kernels of jacobi and of pcg
            PoissonOptions options;
            options.norm = PoissonNorm::l2;
            options.method = method;
            options.iterations = few ? 1 : 2;
            options.weigh_by_variance = options.alpha_from_variances = weighted;
            print(weighted ? "weighted L2" : "L2", problem.images_with_variances(), options);
        }
    for (const bool joint : {true, false})
        for (const bool keep_mean : {true, false}) {
            if (few && keep_mean != joint)
                continue;
            PoissonOptions options;
            options.iterations = few && joint ? 1 : 2;
            options.joint_channels = joint;
            options.keep_mean = keep_mean;
            print(joint ? "L1" : "L1 by channel", problem.images(), options);
        }
    // Missing inputs, a pixel without any, direct light and a start.
    const std::vector<float> direct(problem.primal.size(), 0.5f);
    HostImages images = problem.images();
    images.direct = direct.data();
    images.start = problem.clean.data();
    problem.primal[problem.at(0, 1, 0)] = std::numeric_limits<float>::infinity();
    for (const std::size_t i : {problem.at(1, 0, 0), problem.at(1, width / 2, height / 2)})
        problem.primal[i] = problem.dx[i] = problem.dy[i] = std::numeric_limits<float>::quiet_NaN();
    for (const PoissonNorm norm : {PoissonNorm::l1, PoissonNorm::l2}) {
        PoissonOptions options;
        options.norm = norm;
        options.iterations = few ? 1 : 2;
        print(norm == PoissonNorm::l1 ? "L1, missing" : "L2, missing", images, options);
    }
}

} // namespace
} // namespace gradus::testing

int main(int count, char **arguments) {
    try {
        const bool few = count == 5 && std::strcmp(arguments[4], "few") == 0;
        if (count != 4 && !few)
            return 2;
        const auto number = [&](int i) { return std::uint32_t(std::atoi(arguments[i])); };
        gradus::testing::print_digests(number(1), number(2), int(number(3)), few);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
