#include "runtime/io/plugins/parameters_of_bsdfs.h"

#include "runtime/io/refractive_index.h"
#include "runtime/io/text.h"
#include "runtime/scene/coating.h"

#include <algorithm>
#include <cmath>

namespace gradus {

Microfacet read_roughness(Properties &properties, Bsdf &bsdf) {
    const std::string name = lower_case(properties.string("distribution", "beckmann"));
    if (name != "beckmann" && name != "ggx")
        throw properties.error("distribution",
                               "unknown microfacet distribution \"" + name + "\" (known: beckmann, ggx)");
    // Below this, single precision cannot hold the distribution's peak.
    constexpr double least_alpha = 1e-4;
    constexpr double most_alpha = 1e30;
    const Number alpha = properties.textured_number("alpha", 0.1f, 0, most_alpha, least_alpha);
    bsdf.alpha_u = properties.textured_number("alpha_u", alpha, 0, most_alpha, least_alpha);
    bsdf.alpha_v = properties.textured_number("alpha_v", alpha, 0, most_alpha, least_alpha);
    properties.ignore({"sample_visible"}); // visible normals are always sampled
    return name == "ggx" ? Microfacet::ggx : Microfacet::beckmann;
}

void read_dielectric(Properties &properties, Bsdf &bsdf) {
    bsdf.ior = float(properties.refractive_index("int_ior", "bk7") / properties.refractive_index("ext_ior", "air"));
    bsdf.specular_reflectance = properties.color("specular_reflectance", {1, 1, 1}, ColorUse::reflectance);
    bsdf.specular_transmittance = properties.color("specular_transmittance", {1, 1, 1}, ColorUse::reflectance);
}

void read_plastic(Properties &properties, Bsdf &bsdf) {
    bsdf.ior =
        float(properties.refractive_index("int_ior", "polypropylene") / properties.refractive_index("ext_ior", "air"));
    bsdf.reflectance = properties.color("diffuse_reflectance", {0.5f, 0.5f, 0.5f}, ColorUse::reflectance);
    bsdf.specular_reflectance = properties.color("specular_reflectance", {1, 1, 1}, ColorUse::reflectance);
    bsdf.nonlinear = properties.boolean("nonlinear", false) ? 1.0f : 0.0f;
    set_coating(bsdf);
}

void read_two_lobes(Properties &properties, Bsdf &bsdf) {
    bsdf.reflectance = properties.color("diffuse_reflectance", {0.5f, 0.5f, 0.5f}, ColorUse::reflectance);
    bsdf.specular_reflectance = properties.color("specular_reflectance", {0.2f, 0.2f, 0.2f}, ColorUse::reflectance);
    const auto scale = [](Rgb &color, float by) { color = {color.r * by, color.g * by, color.b * by}; };
    const float most =
        std::max({bsdf.reflectance.r + bsdf.specular_reflectance.r, bsdf.reflectance.g + bsdf.specular_reflectance.g,
                  bsdf.reflectance.b + bsdf.specular_reflectance.b});
    if (properties.boolean("ensure_energy_conservation", true) && most > 1) {
        scale(bsdf.reflectance, 0.99f / most);
        scale(bsdf.specular_reflectance, 0.99f / most);
    }
}

void read_principled(Properties &properties, Bsdf &bsdf) {
    const auto share = [&](const char *name, float otherwise) {
        return properties.textured_number(name, otherwise, 0, 1, 0);
    };
    bsdf.reflectance = properties.color("base_color", {0.5f, 0.5f, 0.5f}, ColorUse::reflectance);
    bsdf.roughness = share("roughness", 0.5f);
    bsdf.anisotropic = share("anisotropic", 0);
    bsdf.spec_trans = share("spec_trans", 0);
    bsdf.spec_tint = share("spec_tint", 0);
    bsdf.sheen = share("sheen", 0);
    bsdf.sheen_tint = share("sheen_tint", 0);
    bsdf.flatness = share("flatness", 0);
    const float squared = bsdf.roughness * bsdf.roughness, aspect = std::sqrt(1 - 0.9f * bsdf.anisotropic);
    bsdf.alpha_u = std::max(squared / aspect, 0.001f);
    bsdf.alpha_v = std::max(squared * aspect, 0.001f);
}

void read_conductor(Properties &properties, Bsdf &bsdf) {
    // 0.x took copper where nothing is said, Mitsuba 3 takes a perfect mirror.
    const std::string material = properties.string("material", properties.element().is_legacy() ? "Cu" : "none");
    const bool has_eta = properties.has("eta"), has_k = properties.has("k");
    if (has_eta != has_k)
        throw properties.error(has_eta ? "eta" : "k", "a conductor needs both eta and k, or a material");
    if (has_eta && properties.has("material"))
        throw properties.error("material", "give a conductor's material or its eta and k, not both");
    const std::optional<ConductorIndex> named = conductor_index(material);
    if (has_eta) {
        bsdf.eta = properties.color("eta", {}, ColorUse::index);
        bsdf.k = properties.color("k", {}, ColorUse::index);
    } else if (named) {
        bsdf.eta = named->eta;
        bsdf.k = named->k;
    } else {
        std::string message = "unknown conductor \"" + material + "\"";
        if (const auto nearest = nearest_name(material, conductor_names()))
            message += "; did you mean \"" + *nearest + "\"?";
        throw properties.error("material", message + " (known: " + join(conductor_names()) + ")");
    }
    const std::string around = properties.element().is_legacy() ? "air" : "vacuum";
    const double first = properties.refractive_index("ext_ior", around);
    const double outside = properties.has("ext_eta") ? properties.refractive_index("ext_eta", around) : first;
    // A perfect mirror stays one, whatever is around it.
    if (has_eta || lower_case(material) != "none")
        for (Rgb *index : {&bsdf.eta, &bsdf.k})
            *index = {float(index->r / outside), float(index->g / outside), float(index->b / outside)};
    bsdf.specular_reflectance = properties.color("specular_reflectance", {1, 1, 1}, ColorUse::reflectance);
}

} // namespace gradus
