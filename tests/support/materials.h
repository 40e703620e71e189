// Materials built in code, for small scenes.
#pragma once

#include "runtime/scene/coating.h"
#include "runtime/scene/scene.h"

namespace gradus::testing {

inline Bsdf diffuse(double albedo) {
    Bsdf bsdf;
    bsdf.kind = BsdfKind::diffuse;
    bsdf.reflectance = {float(albedo), float(albedo), float(albedo)};
    return bsdf;
}

/// Metal that reflects all light.
inline Bsdf mirror() {
    Bsdf bsdf;
    bsdf.kind = BsdfKind::conductor;
    return bsdf;
}

/// ior: inside over outside.
inline Bsdf glass(double ior) {
    Bsdf bsdf;
    bsdf.kind = BsdfKind::dielectric;
    bsdf.ior = float(ior);
    return bsdf;
}

/// GGX, as rough along both axes.
inline Bsdf rough_metal(double roughness) {
    Bsdf bsdf;
    bsdf.kind = BsdfKind::roughconductor_ggx;
    bsdf.alpha_u = bsdf.alpha_v = float(roughness);
    return bsdf;
}

/// As rough_metal(); ior: inside over outside.
inline Bsdf rough_glass(double roughness, double ior) {
    Bsdf bsdf = rough_metal(roughness);
    bsdf.kind = BsdfKind::roughdielectric_ggx;
    bsdf.ior = float(ior);
    return bsdf;
}

/// A diffuse base under a smooth coat; ior: inside over outside.
inline Bsdf plastic(double albedo, double ior) {
    Bsdf bsdf = diffuse(albedo);
    bsdf.kind = BsdfKind::plastic;
    bsdf.ior = float(ior);
    set_coating(bsdf);
    return bsdf;
}

inline Material material_of(const Bsdf &front) {
    Material material;
    material.front = front;
    return material;
}

inline Material two_sided(const Bsdf &front, const Bsdf &back) {
    Material material;
    material.front = front;
    material.back = back;
    material.two_sided = true;
    return material;
}

/// The same on both sides.
inline Material two_sided(const Bsdf &bsdf) { return two_sided(bsdf, bsdf); }

} // namespace gradus::testing
