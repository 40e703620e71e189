#include "runtime/io/plugins/parameters_of_bsdfs.h"

#include "runtime/io/refractive_index.h"
#include "runtime/io/text.h"

#include <algorithm>

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
