// <bsdf type="ward">, of Mitsuba 0.x: Ward's anisotropic lobe beside a diffuse one.
//   variant (ward, ward-duer, balanced; balanced), diffuse_reflectance (0.5), specular_reflectance (0.2),
//   alpha or alpha_u and alpha_v (0.1)
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

#include <algorithm>

namespace gradus {

Material bsdf_ward(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    bsdf.kind = BsdfKind::ward;
    const std::string variant = properties.string("variant", "balanced");
    const std::string known[] = {"ward", "ward-duer", "balanced"};
    const auto found = std::find(std::begin(known), std::end(known), variant);
    if (found == std::end(known))
        throw properties.error("variant", "unknown variant \"" + variant + "\" (known: ward, ward-duer, balanced)");
    bsdf.ward_variant = float(found - std::begin(known));
    read_two_lobes(properties, bsdf);
    const Number alpha = properties.textured_number("alpha", 0.1f, 0, 1e30, 1e-4);
    bsdf.alpha_u = properties.textured_number("alpha_u", alpha, 0, 1e30, 1e-4);
    bsdf.alpha_v = properties.textured_number("alpha_v", alpha, 0, 1e30, 1e-4);
    return material;
}

} // namespace gradus
