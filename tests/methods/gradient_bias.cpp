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

/// For values_of_both(): the sum of both pixels of a difference, of the primal layer; 0 at the border.
std::vector<double> sums_of_both(const Image &image) {
    const Layer primal(image, "primal");
    const auto sums = [&](bool right) {
        return image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
            const std::uint32_t to_x = right ? x + 1 : x, to_y = right ? y : y + 1;
            return to_x < image.width && to_y < image.height ? primal(c, to_x, to_y) + primal(c, x, y) : 0.0;
        });
    };
    return values_of_both(sums(true), sums(false));
}

/// Twice the share of the residuals that is of each pattern's kind, by seed: that of all other seeds, so that noise of
/// both is independent.
Spread share_of(const std::vector<std::vector<double>> &estimates, const std::vector<std::vector<double>> &truths,
                const std::vector<std::vector<double>> &patterns) {
    const double magnitude = mean_product(patterns).first;
    std::vector<double> sum(patterns[0].size(), 0.0), shares;
    for (const std::vector<double> &pattern : patterns)
        std::transform(pattern.begin(), pattern.end(), sum.begin(), sum.begin(), std::plus<>());
    for (std::size_t seed = 0; seed < patterns.size(); ++seed) {
        double product = 0;
        for (std::size_t i = 0; i < sum.size(); ++i)
            product += (estimates[seed][i] - truths[seed][i]) * (sum[i] - patterns[seed][i]);
        shares.push_back(2 * product / double(patterns.size() - 1) / magnitude);
    }
    return spread_of(shares);
}

} // namespace

bool OffsetError::is_none() const {
    return std::fabs(one_way.mean) <= 9.4 * one_way.standard_error + 1e-5 &&
           std::fabs(both_ways.mean) <= 9.4 * both_ways.standard_error + 1e-5;
}

double OffsetError::at_most() const { return std::fabs(one_way.mean) + 4 * one_way.standard_error; }

double BiasEstimate::found() const { return std::sqrt(std::max(squared, 0.0) / magnitude); }

double BiasEstimate::at_most() const { return std::sqrt((std::max(squared, 0.0) + 4 * standard_error) / magnitude); }

double GradientBias::at_most() const { return std::max(primal.at_most(), differences.at_most()); }

double GradientBias::found() const { return std::max(primal.found(), differences.found()); }

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

void hide_all_kinds(SceneMaker &scene, float z) {
    const Material hidden[] = {two_sided(diffuse(0.5)), material_of(mirror()), material_of(glass(1.5)),
                               material_of(rough_metal(0.3)), material_of(rough_glass(0.3, 1.5))};
    float x = 0;
    for (const Material &material : hidden)
        scene.sphere({x++, 0, z}, 0.1f, scene.material(material));
}

GradientBias gradient_bias(const Scene &scene, const GradientSamples &samples) {
    return gradient_bias(scene, scene, samples);
}

GradientBias gradient_bias(const Scene &scene, const Scene &path_traced, const GradientSamples &samples) {
    Scene with_gradients = scene, without = path_traced;
    with_gradients.settings.samples_per_pixel = samples.gradient_domain;
    without.settings.samples_per_pixel = samples.path_tracing;
    std::vector<std::vector<double>> primal, change, true_primal, true_change, carried_sums, carried_changes;
    RenderOptions unweighted, of_truth;
    do_not_weigh(unweighted);
    if (samples.by_tree) {
        unweighted.lights = RenderOptions::Lights::tree;
        of_truth.lights = RenderOptions::Lights::power;
    }
    for (const Image &image : render_seeds(with_gradients, samples.seeds, unweighted, 1, "gpt")) {
        primal.push_back(values_of(whole(image)));
        change.push_back(values_of_both(whole_differences(image, true), whole_differences(image, false)));
        // What the camera sees of lights is carried by no offset path.
        carried_sums.push_back(sums_of_both(image));
        carried_changes.push_back(
            values_of_both(differences(image, "primal", true), differences(image, "primal", false)));
    }
    for (const Image &image : render_seeds(without, samples.seeds, of_truth, 1 + samples.seeds, "pt")) {
        true_primal.push_back(values_of(image));
        true_change.push_back(values_of_both(differences(image, "", true), differences(image, "", false)));
    }
    return {estimate_bias(primal, true_primal),
            estimate_bias(change, true_change),
            {share_of(change, true_change, carried_sums), share_of(change, true_change, carried_changes)}};
}

void expect_no_bias(const GradientBias &bias, const GradientRow &row) {
    for (const auto &[name, estimate] : {std::pair{"primal", bias.primal}, {"differences", bias.differences}}) {
        std::printf("%-11s squared bias %.1f standard errors, relative bias at most %.2g\n", name,
                    estimate.squared / estimate.standard_error, estimate.at_most());
        EXPECT_TRUE(estimate.is_none()) << name;
    }
    const OffsetError &offsets = bias.offsets;
    std::printf("offset paths off by %.5f +- %.5f one way, %.5f +- %.5f both ways\n", offsets.one_way.mean,
                offsets.one_way.standard_error, offsets.both_ways.mean, offsets.both_ways.standard_error);
    EXPECT_TRUE(offsets.is_none());
    StabilityRow recorded{row.area,       row.failure,    row.provoked_by, row.contract,
                          "bias at most", bias.at_most(), row.limit};
    recorded.found = bias.found();
    recorded.also = StabilityMeasure{"offset paths off by at most", offsets.at_most(), row.offset_limit,
                                     std::fabs(offsets.one_way.mean)};
    record_stability(recorded);
}

} // namespace gradus::testing
