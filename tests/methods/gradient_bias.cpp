#include "tests/methods/gradient_bias.h"

#include "tests/support/gradient_layers.h"
#include "tests/support/stability.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

std::vector<double> values_of(const Image &image) {
    std::vector<double> values;
    for (const char *color : colors) {
        const std::vector<float> &channel = image.find(color)->values;
        values.insert(values.end(), channel.begin(), channel.end());
    }
    return values;
}

std::vector<double> less(std::vector<double> a, const std::vector<double> &b) {
    std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::minus<>());
    return a;
}

std::vector<double> joined(std::vector<double> a, const std::vector<double> &b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// dx or dy of a gradient-domain render, with what the camera sees of lights.
std::vector<double> estimated_differences(const Image &image, bool right) {
    const Image seen = differences(image, "direct", right);
    return values_of(image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
        return layer(image, right ? "dx" : "dy", c, x, y) + layer(seen, "", c, x, y);
    }));
}

} // namespace

double BiasEstimate::at_most() const { return std::sqrt((std::max(squared, 0.0) + 4 * standard_error) / magnitude); }

double GradientBias::at_most() const { return std::max(primal.at_most(), differences.at_most()); }

BiasEstimate estimate_bias(const std::vector<std::vector<double>> &residuals,
                           const std::vector<std::vector<double>> &truths) {
    BiasEstimate estimate;
    std::tie(estimate.squared, estimate.standard_error) = mean_product(residuals);
    estimate.magnitude = mean_product(truths).first;
    return estimate;
}

GradientBias gradient_bias(const Scene &scene, const GradientSamples &samples) {
    return gradient_bias(scene, scene, samples);
}

GradientBias gradient_bias(const Scene &scene, const Scene &path_traced, const GradientSamples &samples) {
    Scene with_gradients = scene, without = path_traced;
    with_gradients.settings.samples_per_pixel = samples.gradient_domain;
    without.settings.samples_per_pixel = samples.path_tracing;
    const std::vector<Image> estimates = render_seeds(with_gradients, samples.seeds, {}, 1, "gpt");
    const std::vector<Image> truths = render_seeds(without, samples.seeds, {}, 1 + samples.seeds, "pt");
    std::vector<std::vector<double>> primal, true_primal, change, true_change;
    for (std::size_t seed = 0; seed < samples.seeds; ++seed) {
        true_primal.push_back(values_of(truths[seed]));
        primal.push_back(less(values_of(whole(estimates[seed])), true_primal.back()));
        true_change.push_back(
            joined(values_of(differences(truths[seed], "", true)), values_of(differences(truths[seed], "", false))));
        change.push_back(
            less(joined(estimated_differences(estimates[seed], true), estimated_differences(estimates[seed], false)),
                 true_change.back()));
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
