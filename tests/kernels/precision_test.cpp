// The float build of every BSDF against the double build of the same source, on inputs that float holds exactly.
#include <gtest/gtest.h>

#include "tests/kernels/bsdf_arguments.h"
#include "tests/kernels/function_table.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

using namespace gradus::testing;

namespace {

/// The errors of one quantity.
class ErrorStatistics {
  public:
    void add(double error) { errors.push_back(error); }
    double quantile(double share) {
        const auto place = errors.begin() + static_cast<std::ptrdiff_t>(share * (errors.size() - 1));
        std::nth_element(errors.begin(), place, errors.end());
        return *place;
    }
    std::size_t count() const { return errors.size(); }

  private:
    std::vector<double> errors;
};

/// The same for all kinds: to draw them takes longer than to evaluate a BSDF.
std::vector<Arguments> draw_all_arguments(std::uint64_t seed, double smallest_alpha) {
    std::mt19937_64 random(seed);
    std::vector<Arguments> all(200'000);
    for (Arguments &a : all)
        a = draw_arguments(random, smallest_alpha);
    return all;
}

} // namespace

// Float arithmetic knows a half vector to about 1e-7 / |h|, and the logarithm of D changes by up to 10 / alpha per
// radian: that sets the largest errors at the smallest roughness. The stated edges, where float loses more, are left
// out: see is_edge.
TEST(Precision, FloatEvaluationMatchesDouble) {
    const auto in_float = float_functions(), in_double = double_functions();
    const std::vector<Arguments> all = draw_all_arguments(17, 0.01);
    double worst = 0;
    for (std::size_t kind = 0; kind < in_float.size(); ++kind) {
        if (in_float[kind].is_delta)
            continue;
        ErrorStatistics eval, pdf, reverse, weight;
        for (std::size_t i = 0; i < all.size(); ++i) {
            Arguments a = all[i];
            // Below 1 coats have a critical angle as well, and thin surfaces ever smoother microfacets.
            const std::string name = in_float[kind].name;
            if (name.find("plastic") != std::string::npos || name == "principledthin")
                a[Field::ior] = std::max(a[Field::ior], rounded(1 / a[Field::ior]));
            // Two of three pairs are where the BSDF samples them; the third is anywhere.
            const Sampled drawn = in_float[kind].sample(a), exactly_drawn = in_double[kind].sample(a);
            if (exactly_drawn.pdf > 0 && drawn.pdf > 0 && distance(exactly_drawn.wo, drawn.wo) < 0.1)
                weight.add(std::fabs(drawn.weight[1] - exactly_drawn.weight[1]));
            if (i % 3 != 0)
                for (int axis = 0; axis < 3; ++axis)
                    a.wo[axis] = rounded(exactly_drawn.wo[axis]);
            if (is_edge(a, in_float[kind].refracts))
                continue;
            const Evaluated approximate = in_float[kind].evaluate(a), exact = in_double[kind].evaluate(a);
            if (exact.pdf > 1e-6)
                pdf.add(std::fabs(approximate.pdf / exact.pdf - 1));
            if (exact.pdf_reverse > 1e-6)
                reverse.add(std::fabs(approximate.pdf_reverse / exact.pdf_reverse - 1));
            if (exact.value[1] > 1e-6)
                eval.add(std::fabs(approximate.value[1] / exact.value[1] - 1));
        }
        std::printf("  %-26s eval %.1e (99.9 %%) %.1e (max)  pdf %.1e %.1e  weight %.1e %.1e\n", in_float[kind].name,
                    eval.quantile(0.999), eval.quantile(1), pdf.quantile(0.999), pdf.quantile(1),
                    weight.quantile(0.999), weight.quantile(1));
        EXPECT_GT(eval.count(), 30'000u) << in_float[kind].name;
        EXPECT_LE(eval.quantile(0.999), 1e-4) << in_float[kind].name;
        EXPECT_LE(pdf.quantile(0.999), 1e-4) << in_float[kind].name;
        EXPECT_LE(reverse.quantile(0.999), 1e-4) << in_float[kind].name;
        EXPECT_LE(reverse.quantile(1), 3e-4) << in_float[kind].name;
        EXPECT_LE(eval.quantile(1), 3e-4) << in_float[kind].name;
        EXPECT_LE(pdf.quantile(1), 3e-4) << in_float[kind].name;
        EXPECT_LE(weight.quantile(0.999), 1e-5) << in_float[kind].name;
        worst = std::max({worst, eval.quantile(1), pdf.quantile(1)});
    }
    record_stability({"Numbers", "float: what is left where terms cancel",
                      "every BSDF, roughness 0.01 to 1, away from grazing angles and the critical one",
                      "float all through", "largest relative error of a value or density", worst, 3e-4});
}

TEST(Precision, FloatSamplesMatchDouble) {
    const auto in_float = float_functions(), in_double = double_functions();
    const std::vector<Arguments> all = draw_all_arguments(18, 1e-4);
    double worst = 0;
    for (std::size_t kind = 0; kind < in_float.size(); ++kind) {
        ErrorStatistics direction, by_root;
        int compared = 0, differing = 0;
        for (const Arguments &a : all) {
            const Sampled approximate = in_float[kind].sample(a), exact = in_double[kind].sample(a);
            ++compared;
            // A lobe chosen by a comparison, or a failure at the horizon, may fall on the other side of it.
            if ((approximate.pdf > 0) != (exact.pdf > 0) || approximate.eta != rounded(exact.eta)) {
                differing += std::fabs(approximate.eta - exact.eta) > 1e-6 || (approximate.pdf > 0) != (exact.pdf > 0);
                if (std::fabs(approximate.eta - exact.eta) > 1e-6)
                    continue;
            }
            direction.add(distance(approximate.wo, exact.wo));
            by_root.add(distance(approximate.wo, exact.wo) * std::sqrt(1 - a.u1));
        }
        std::printf("  %-26s wo %.1e (99.9 %%) %.1e (max), other lobe %d of %d\n", in_float[kind].name,
                    direction.quantile(0.999), direction.quantile(1), differing, compared);
        EXPECT_LE(direction.quantile(0.999), 5e-6) << in_float[kind].name;
        worst = worse(worst, direction.quantile(0.999));
        // Near u1 = 1 Beckmann's slope is a double root: it is known to the root of the rounding error, which goes with
        // one over the root of what is left to 1.
        const bool is_beckmann = std::string(in_float[kind].name).find("beckmann") != std::string::npos;
        EXPECT_LE(direction.quantile(1), is_beckmann ? 5e-3 : 1e-4) << in_float[kind].name;
        EXPECT_LE(by_root.quantile(1), is_beckmann ? 2.5e-5 : 1e-4) << in_float[kind].name;
        EXPECT_LE(differing, compared / 10'000) << in_float[kind].name;
    }
    record_stability({"Numbers", "float: what is left where terms cancel", "samples of every BSDF, roughness 1e-4 to 1",
                      "float all through", "99.9th percentile of the error of a direction", worst, 5e-6});
}
