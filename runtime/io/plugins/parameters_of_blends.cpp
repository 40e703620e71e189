#include "runtime/io/plugins/parameters_of_blends.h"

#include "runtime/io/diagnostics.h"

#include <algorithm>
#include <utility>

namespace gradus {

namespace {

/// What the back of a material is, seen as a front. One-sided BSDFs absorb there.
Bsdf back_of(const Material &material) { return material.two_sided ? material.back : black_bsdf(); }

/// The opacity of a blend of masks, which leaves them as parts without holes. Rays meet either part with its share: the
/// blend has holes, and where it has none the weight is another one. Textures would make that another one at each
/// place.
Number common_opacity(Material (&parts)[2], Number &weight, const Location &location) {
    const Number first = parts[0].opacity, second = parts[1].opacity;
    parts[0].opacity = parts[1].opacity = 1;
    if (first == second)
        return first;
    if (first.texture != no_texture || second.texture != no_texture || weight.texture != no_texture)
        throw SceneError(location,
                         "a blend of masks of different opacities is supported where these and its weight are "
                         "numbers, not textures; masks of the same opacity, one texture by its id, may be "
                         "blended by any weight");
    const float opacity = (1 - weight) * first + weight * second;
    weight = opacity > 0 ? Number(std::min(weight * second / opacity, 1.0f)) : weight;
    return opacity;
}

} // namespace

Bsdf black_bsdf() {
    Bsdf black;
    black.reflectance = {0, 0, 0};
    return black;
}

Material blended(Material first, Material second, Number weight, SceneBuilder &builder, const Location &location) {
    Material parts[2] = {std::move(first), std::move(second)};
    Material material;
    material.opacity = common_opacity(parts, weight, location);
    material.two_sided = parts[0].two_sided || parts[1].two_sided;
    if (material.two_sided)
        for (const Material &part : parts)
            if (builder.transmits(part.front))
                throw SceneError(location,
                                 "a blend of a two-sided BSDF and of one that lets light through is not supported");
    material.front = builder.blend(parts[0].front, parts[1].front, weight, location);
    if (material.two_sided)
        material.back = parts[0].back == parts[0].front && parts[1].back == parts[1].front && parts[0].two_sided &&
                                parts[1].two_sided
                            ? material.front
                            : builder.blend(back_of(parts[0]), back_of(parts[1]), weight, location);
    return material;
}

} // namespace gradus
