// What a scene needs of the kernels. What a scene does not need is neither compiled, allocated nor branched on.
#pragma once

#include "runtime/scene/scene.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

/// Values of the names that kernel files declare in their "//! traits:" lines: 1 where the scene has the feature.
using TraitMap = std::map<std::string, int>;

TraitMap scene_traits(const Scene &scene);

/// The same as a list, in the order in which `gradus inspect` prints them.
std::vector<std::pair<std::string, int>> trait_list(const Scene &scene);

/// Bits of TRAIT_TEXTURES (kernels/shared/texture.h) for what a texture has.
int texture_features(const Texture &texture);

/// Columns that textured parameters take, for a value of TRAIT_TEXTURED.
std::uint32_t textured_column_count(int textured);

/// Calls visit(number, parameter) for each parameter of the Bsdf that its kind reads and that is a texture: its number
/// in GRADUS_TEXTURED_PARAMETERS, its index in Scene::textures.
void for_each_textured_parameter(const Bsdf &bsdf, const std::function<void(int number, std::int32_t texture)> &visit);

/// The textures among these, each once.
std::vector<std::int32_t> distinct_textures(const Bsdf &bsdf);

/// The most that a BSDF of the scene's shapes has.
int most_lookups(const Scene &scene);

/// One line that says what a trait stands for; empty for an unknown one.
std::string trait_description(const std::string &name);

/// Every feature on, as if the scene had it: what a renderer without specialised kernels would run.
TraitMap with_all_traits(TraitMap traits);

/// What GRADUS_BSDF_KINDS says of a kind, and what follows from it.
struct BsdfKindTraits {
    std::string name;
    bool is_dirac;                       ///< has Dirac lobes alone, which light sampling cannot meet
    bool is_mixed;                       ///< has a Dirac lobe beside rough ones
    bool transmits;                      ///< has both sides by nature
    bool refracts;                       ///< and changes the index
    bool has_roughness;                  ///< alpha_u and alpha_v
    std::vector<std::string> parameters; ///< members of Bsdf that it reads
};

const BsdfKindTraits &bsdf_kind_traits(BsdfKind kind);

/// Whether a kind with Dirac lobes alone is among the scene's BSDFs, nested ones included.
bool has_dirac_bsdf(const Scene &scene);

/// The BSDF of the kernels that a Bsdf of the scene uses: a name of GRADUS_BSDF_KINDS.
std::string bsdf_kind_name(const Bsdf &bsdf);

/// All of GRADUS_BSDF_KINDS by name; a kind's place is its number in kernels.
std::vector<std::string> all_bsdf_kinds();

/// The kind of that name, which must be one of these.
BsdfKind bsdf_kind_named(const std::string &name);

/// That place for the kind of one Bsdf.
std::uint32_t bsdf_kind_number(const Bsdf &bsdf);

/// Calls visit(bsdf) for a BSDF, or for those that it blends.
template <class Visit>
void for_each_part(const Scene &scene, const Bsdf &bsdf, const Visit &visit) {
    if (bsdf.blend == no_blend)
        return visit(bsdf);
    const Blend &blend = scene.blends[std::size_t(bsdf.blend)];
    for_each_part(scene, scene.blended[blend.first], visit);
    for_each_part(scene, scene.blended[blend.second], visit);
}

/// Calls visit(bsdf) for each side of each material that a shape has; of blends for their parts.
template <class Visit>
void for_each_bsdf(const Scene &scene, Visit visit) {
    for (const Shape &shape : scene.shapes) {
        const Material &material = scene.materials[shape.material];
        for_each_part(scene, material.front, visit);
        if (material.two_sided)
            for_each_part(scene, material.back, visit);
    }
}

/// Calls visit(texture) for each texture, by index, that a shape's material or emitter has.
void for_each_texture(const Scene &scene, const Shape &shape, const std::function<void(std::int32_t)> &visit);

/// Calls visit(emitter, one of textured_lights_...) for each light that has a texture, and for each projector.
void for_each_light_texture(const Scene &scene, const std::function<void(const Emitter &, int what)> &visit);

/// Blends within blends that a BSDF has, itself counted in.
int blend_depth(const Scene &scene, const Bsdf &bsdf);
/// Calls visit(blend) for each blend within a BSDF.
void for_each_blend(const Scene &scene, const Bsdf &bsdf, const std::function<void(const Blend &, int level)> &visit,
                    int level = 0);

/// The kinds that occur on the scene's shapes, in the order of GRADUS_BSDF_KINDS.
std::vector<std::string> bsdf_kinds(const Scene &scene);

/// True for kinds that light sampling cannot meet.
bool bsdf_kind_is_dirac(const std::string &name);

/// True for kinds that have a Dirac lobe beside rough ones.
bool bsdf_kind_is_mixed(const std::string &name);

} // namespace gradus
