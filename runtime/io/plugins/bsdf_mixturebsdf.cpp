// <bsdf type="mixturebsdf">, of 0.x: a mixture of any number of BSDFs, read as mixtures of two within each other.
#include "runtime/io/plugins/parameters_of_blends.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace gradus {

namespace {

/// One for each of `count` parts, none negative.
std::vector<double> read_weights(Properties &properties, std::size_t count) {
    std::string text = properties.string("weights");
    std::ranges::replace(text, ';', ',');
    const std::optional<std::vector<double>> weights = parse_numbers(text);
    if (!weights || weights->size() != count)
        throw properties.error("weights", "mixturebsdf needs a weight for each of its " + std::to_string(count) +
                                              " nested BSDFs, not \"" + text + "\"");
    if (std::ranges::any_of(*weights, [](double weight) { return weight < 0; }))
        throw properties.error("weights", "\"weights\" must not be negative");
    return *weights;
}

} // namespace

Declaration declare_bsdf_mixturebsdf() {
    return {"a mixture of any number of BSDFs, each of which may be a mixture again, as in 0.x; what `blendbsdf` says "
            "holds for it too",
            joined({{Parameter{"weights", Takes::string, nullptr,
                               "shares of the BSDFs, in their order. What they lack of 1 is black; where they sum to "
                               "more, they are scaled to 1"}
                         .required()
                         .of_before_2(),
                     {"bsdf", Takes::objects, nullptr, "one or more"}},
                    meaningless({"ensure_energy_conservation"})})};
}

Material bsdf_mixturebsdf(Properties &properties, SceneBuilder &builder) {
    const std::vector<NestedObject> nested = properties.objects("bsdf");
    std::vector<double> weights = read_weights(properties, nested.size());
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (!(sum > 0))
        throw properties.error("weights", "\"weights\" must sum to more than 0");
    std::vector<Material> parts;
    for (const NestedObject &part : nested)
        parts.push_back(builder.build_object<Material>(*part.element));
    if (sum < 1) {
        parts.emplace_back().front = black_bsdf();
        weights.push_back(1 - sum);
    } else if (sum > 1 + 1e-6) {
        properties.diagnostics().warn(properties.location_of("weights"),
                                      "\"weights\" sum to more than 1, which would create energy; they are scaled");
    }
    std::optional<Material> mixture;
    double held = 0; // weight of what the mixture holds
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (weights[i] == 0)
            continue;
        held += weights[i];
        mixture =
            mixture ? blended(*mixture, parts[i], float(weights[i] / held), builder, properties.location()) : parts[i];
    }
    return *mixture;
}

} // namespace gradus
