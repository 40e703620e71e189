#include "runtime/io/plugins/parameters_of_bsdfs.h"

#include "runtime/io/refractive_index.h"
#include "runtime/io/text.h"

#include <algorithm>
#include <cmath>

namespace gradus {

ParameterList parameters_of_roughness() {
    // Below this, single precision cannot hold the distribution's peak.
    constexpr double least_alpha = 1e-4;
    constexpr double most_alpha = 1e30;
    const auto roughness = [&](const char *name, const char *otherwise, const char *about) {
        return Parameter{name, Takes::textured_number, otherwise, about}
            .at_least(0)
            .at_most(most_alpha)
            .raised_to(least_alpha);
    };
    return joined({{Parameter{"distribution", Takes::choice, "beckmann",
                              "of the microfacets; phong and as, of 0.x, are read as beckmann of the same alpha"}
                        .of({"beckmann", "ggx", "phong", "as"}),
                    roughness("alpha", "0.1", "roughness; below 1e-4 it is 1e-4"),
                    roughness("alpha_u", nullptr, "roughness along dp/du").as("alpha"),
                    roughness("alpha_v", nullptr, "roughness across it").as("alpha")},
                   meaningless({"sample_visible"})}); // visible normals are always sampled
}

ParameterList roughness_left_over() { return meaningless({"alpha", "distribution"}); }

Microfacet read_roughness(Properties &properties, Bsdf &bsdf) {
    bsdf.alpha_u = properties.textured_number("alpha_u");
    bsdf.alpha_v = properties.textured_number("alpha_v");
    const std::string distribution = properties.choice("distribution");
    if (distribution == "phong" || distribution == "as")
        properties.diagnostics().warn(properties.location_of("distribution"),
                                      "the distribution \"" + distribution + "\" is read as beckmann");
    return distribution == "ggx" ? Microfacet::ggx : Microfacet::beckmann;
}

ParameterList parameters_of_dielectric() {
    return {{"int_ior", Takes::refractive_index, "bk7", "index of refraction behind the front"},
            {"ext_ior", Takes::refractive_index, "air", "index of refraction before it"},
            {"specular_reflectance", Takes::reflectance, "1", "what reflection is times"},
            {"specular_transmittance", Takes::reflectance, "1", "what transmission is times"}};
}

void read_dielectric(Properties &properties, Bsdf &bsdf) {
    bsdf.ior = float(properties.refractive_index("int_ior") / properties.refractive_index("ext_ior"));
    bsdf.specular_reflectance = properties.color("specular_reflectance");
    bsdf.specular_transmittance = properties.color("specular_transmittance");
}

ParameterList parameters_of_plastic() {
    return {{"diffuse_reflectance", Takes::reflectance, "0.5", "albedo of the base"},
            {"specular_reflectance", Takes::reflectance, "1", "what reflection by the coat is times"},
            {"int_ior", Takes::refractive_index, "polypropylene", "index of refraction of the coat"},
            {"ext_ior", Takes::refractive_index, "air", "index of refraction around it"},
            {"nonlinear", Takes::boolean, "false", "light that the coat throws back takes the base's colour again"}};
}

void read_plastic(Properties &properties, Bsdf &bsdf) {
    bsdf.ior = float(properties.refractive_index("int_ior") / properties.refractive_index("ext_ior"));
    bsdf.reflectance = properties.color("diffuse_reflectance");
    bsdf.specular_reflectance = properties.color("specular_reflectance");
    bsdf.nonlinear = properties.boolean("nonlinear") ? 1.0f : 0.0f;
}

ParameterList parameters_of_two_lobes() {
    return {
        {"diffuse_reflectance", Takes::reflectance, "0.5", "albedo of the diffuse part"},
        {"specular_reflectance", Takes::reflectance, "0.2", "weight of the lobe"},
        {"ensure_energy_conservation", Takes::boolean, "true", "both are scaled to a sum of 0.99 where it exceeds 1"}};
}

void read_two_lobes(Properties &properties, Bsdf &bsdf) {
    const bool together = properties.boolean("ensure_energy_conservation");
    const auto read = [&](const char *name) { // each alone counts once the sum is right
        return together ? properties.color_as_written(name) : properties.color(name);
    };
    bsdf.reflectance = read("diffuse_reflectance");
    bsdf.specular_reflectance = read("specular_reflectance");
    const auto scale = [](Rgb &color, float by) { color = {color.r * by, color.g * by, color.b * by}; };
    const float most =
        std::max({bsdf.reflectance.r + bsdf.specular_reflectance.r, bsdf.reflectance.g + bsdf.specular_reflectance.g,
                  bsdf.reflectance.b + bsdf.specular_reflectance.b});
    if (together && most > 1) {
        scale(bsdf.reflectance, 0.99f / most);
        scale(bsdf.specular_reflectance, 0.99f / most);
    }
}

ParameterList parameters_of_principled() {
    const auto share = [](const char *name, const char *otherwise, const char *about) {
        return Parameter{name, Takes::textured_number, otherwise, about}.at_least(0).at_most(1);
    };
    return {{"base_color", Takes::reflectance, "0.5", "albedo"},
            share("roughness", "0.5", "square root of the microfacets' alpha"),
            share("anisotropic", "0", "how much longer highlights are along dp/du"),
            share("spec_trans", "0", "from opaque to transparent"),
            share("spec_tint", "0", "how much of base_color the reflection has"),
            share("sheen", "0", "strength of a lobe at grazing angles"),
            share("sheen_tint", "0", "how much of base_color it has"),
            share("flatness", "0", "from diffuse reflection to one as of scattering below the surface")};
}

void read_principled(Properties &properties, Bsdf &bsdf) {
    bsdf.reflectance = properties.color("base_color");
    float most_roughness = 0, most_anisotropic = 0;
    bsdf.roughness = properties.textured_number("roughness", &most_roughness);
    bsdf.anisotropic = properties.textured_number("anisotropic", &most_anisotropic);
    bsdf.spec_trans = properties.textured_number("spec_trans");
    bsdf.spec_tint = properties.textured_number("spec_tint");
    bsdf.sheen = properties.textured_number("sheen");
    bsdf.sheen_tint = properties.textured_number("sheen_tint");
    bsdf.flatness = properties.textured_number("flatness");
    // The least there is, and one that differs from it where there may be a longer axis, which needs dp/du.
    const float aspect = std::sqrt(1 - 0.9f * most_anisotropic);
    const float longest = most_anisotropic > 0 ? most_roughness : float(bsdf.roughness);
    bsdf.alpha_u = std::max(longest * longest / aspect, 0.001f);
    bsdf.alpha_v = std::max(bsdf.roughness * bsdf.roughness * aspect, 0.001f);
}

// 0.x took copper in air where nothing is said, Mitsuba 3 takes a perfect mirror.
ParameterList parameters_of_conductor() {
    return {
        Parameter{"material", Takes::string, "none", "a metal's name; none: a perfect mirror"}.before_2("Cu"),
        Parameter{"eta", Takes::color, nullptr, "index of refraction, beside a material in 0.x alone"}.or_else(
            "by material; 0 beside k"),
        Parameter{"k", Takes::color, nullptr, "its imaginary part, as eta"}.or_else("by material; 1 beside eta"),
        Parameter{"ext_eta", Takes::refractive_index, "vacuum", "index of refraction around it"}.before_2("air").also(
            "ext_ior"),
        {"specular_reflectance", Takes::reflectance, "1", "what reflection is times"}};
}

void read_conductor(Properties &properties, Bsdf &bsdf) {
    const std::string material = properties.string("material");
    const bool has_eta = properties.has("eta"), has_k = properties.has("k");
    const bool is_mirror = !has_eta && !has_k && lower_case(material) == "none";
    if ((has_eta || has_k) && lower_case(material) != "none" && !properties.element().is_legacy())
        throw properties.error("material", "give a conductor's material or its eta and k, not both");
    const std::optional<ConductorIndex> named = conductor_index(material);
    if (!named) {
        std::string message = "unknown conductor \"" + material + "\"";
        if (const auto nearest = nearest_name(material, conductor_names()))
            message += "; did you mean \"" + *nearest + "\"?";
        throw properties.error("material", message + " (known: " + join(conductor_names()) + ")");
    }
    bsdf.eta = has_eta ? Rgb(properties.color("eta")) : named->eta;
    bsdf.k = has_k ? Rgb(properties.color("k")) : named->k;
    const double outside = properties.refractive_index("ext_eta");
    if (!is_mirror) // which stays one, whatever is around it
        for (Rgb *index : {&bsdf.eta, &bsdf.k})
            *index = {float(index->r / outside), float(index->g / outside), float(index->b / outside)};
    // Beyond that all is reflected, and the squares of squares in single precision are too large.
    constexpr float most_index = 1e8f;
    for (Rgb *index : {&bsdf.eta, &bsdf.k})
        *index = {std::min(index->r, most_index), std::min(index->g, most_index), std::min(index->b, most_index)};
    bsdf.specular_reflectance = properties.color("specular_reflectance");
}

} // namespace gradus
