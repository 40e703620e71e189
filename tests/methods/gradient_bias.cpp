#include "tests/methods/gradient_bias.h"

#include "tests/support/gradient_layers.h"
#include "tests/support/stability.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <tuple>

namespace gradus::testing {
namespace {

/// The mean product of the vectors of two seeds, and its standard error if the vectors had mean 0: then the products of
/// different pairs are not correlated, even where the pairs share a seed.
std::pair<double, double> mean_product(const std::vector<std::vector<double>> &vectors) {
    double sum = 0, squares = 0, pairs = 0;
    for (std::size_t a = 0; a < vectors.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const double product = std::inner_product(vectors[a].begin(), vectors[a].end(), vectors[b].begin(), 0.0);
            sum += product;
            squares += product * product;
            pairs += 1;
        }
    return {sum / pairs, std::sqrt(squares) / pairs};
}

/// Of differences to the right and downwards.
std::vector<double> values_of_both(const Image &right, const Image &down) {
    std::vector<double> values = values_of(right);
    const std::vector<double> more = values_of(down);
    values.insert(values.end(), more.begin(), more.end());
    return values;
}

} // namespace

double BiasEstimate::at_most() const { return std::sqrt((std::max(squared, 0.0) + 4 * standard_error) / magnitude); }

double GradientBias::at_most() const { return std::max(primal.at_most(), differences.at_most()); }

BiasEstimate estimate_bias(const std::vector<std::vector<double>> &estimates,
                           const std::vector<std::vector<double>> &truths) {
    std::vector<std::vector<double>> residuals = estimates;
    for (std::size_t seed = 0; seed < truths.size(); ++seed)
        std::transform(residuals[seed].begin(), residuals[seed].end(), truths[seed].begin(), residuals[seed].begin(),
                       std::minus<>());
    BiasEstimate bias;
    std::tie(bias.squared, bias.standard_error) = mean_product(residuals);
    bias.magnitude = mean_product(truths).first;
    return bias;
}

SceneMaker scene_for_bias(int max_depth) {
    SceneMaker scene(32, 1);
    scene.scene.settings.max_depth = max_depth;
    return scene;
}

GradientBias gradient_bias(const Scene &scene, const GradientSamples &samples) {
    return gradient_bias(scene, scene, samples);
}

GradientBias gradient_bias(const Scene &scene, const Scene &path_traced, const GradientSamples &samples) {
    Scene with_gradients = scene, without = path_traced;
    with_gradients.settings.samples_per_pixel = samples.gradient_domain;
    without.settings.samples_per_pixel = samples.path_tracing;
    std::vector<std::vector<double>> primal, change, true_primal, true_change;
    RenderOptions unweighted; // of all samples; the reconstruction is not looked at
    unweighted.reconstruction = Reconstruction::l1;
    RenderOptions of_truth;
    if (samples.by_tree) {
        unweighted.lights = RenderOptions::Lights::tree;
        of_truth.lights = RenderOptions::Lights::power;
    }
    for (const Image &image : render_seeds(with_gradients, samples.seeds, unweighted, 1, "gpt")) {
        primal.push_back(values_of(whole(image)));
        change.push_back(values_of_both(whole_differences(image, true), whole_differences(image, false)));
    }
    for (const Image &image : render_seeds(without, samples.seeds, of_truth, 1 + samples.seeds, "pt")) {
        true_primal.push_back(values_of(image));
        true_change.push_back(values_of_both(differences(image, "", true), differences(image, "", false)));
    }
    return {estimate_bias(primal, true_primal), estimate_bias(change, true_change)};
}

void expect_no_bias(const GradientBias &bias, const GradientRow &row) {
    for (const auto &[name, estimate] : {std::pair{"primal", bias.primal}, {"differences", bias.differences}}) {
        std::printf("%-11s squared bias %.1f standard errors, relative bias at most %.2g\n", name,
                    estimate.squared / estimate.standard_error, estimate.at_most());
        EXPECT_TRUE(estimate.is_none()) << name;
    }
    record_stability({row.area, row.failure, row.provoked_by, row.contract, "bias at most", bias.at_most(), row.limit});
}

} // namespace gradus::testing
