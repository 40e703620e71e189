#include "runtime/scene/traits.h"

#include "kernels/shared/texture.h"
#include "runtime/scene/camera_clips.h"
#include "runtime/scene/filter_table.h"
#include "runtime/scene/material_class.h"
#include "runtime/scene/vertex_table.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>

namespace gradus {

namespace {

struct TraitText {
    const char *name, *text;
};

constexpr TraitText descriptions[] = {
    {"TRAIT_TRIANGLES", "triangle meshes"},
    {"TRAIT_SPHERES", "spheres"},
    {"TRAIT_INDEXED", "triangles by index, for they are many: how many numbers a vertex has"},
    {"TRAIT_INSTANCES", "groups of shapes that are at several places"},
    {"TRAIT_SHADING_NORMALS", "interpolated normals"},
    {"TRAIT_ANISOTROPIC", "anisotropic roughness, which needs tangents"},
    {"TRAIT_TWO_SIDED", "materials seen alike from both sides"},
    {"TRAIT_TWO_FACED", "materials whose two sides differ"},
    {"TRAIT_MIXED_LOBES", "materials with a mirror beside a rough lobe"},
    {"TRAIT_REFRACTION", "dielectrics: paths keep their index ratio for Russian roulette"},
    {"TRAIT_ENVIRONMENT", "light from where rays leave the scene"},
    {"TRAIT_LIGHT_TRIANGLE", "emitting triangles"},
    {"TRAIT_LIGHT_SPHERE", "emitting spheres"},
    {"TRAIT_LIGHT_POINT", "point lights"},
    {"TRAIT_LIGHT_DIRECTIONAL", "directional lights"},
    {"TRAIT_LIGHT_CONSTANT", "sampling of a constant environment"},
    {"TRAIT_LIGHT_ENVIRONMENT", "an environment map"},
    {"TRAIT_LIGHT_SPOT", "spots"},
    {"TRAIT_TEXTURED_LIGHTS", "lights with textures, a bit each for surfaces, spots and projectors"},
    {"TRAIT_LIGHT_TEXTURES", "what these textures have, a bit each"},
    {"TRAIT_HIDE_EMITTERS", "emitters that the camera does not see"},
    {"TRAIT_MATERIAL", "materials that differ from place to place or from path to path"},
    {"TRAIT_BLENDS", "mixtures of BSDFs, how deeply nested"},
    {"TRAIT_TEXTURED", "parameters of materials that are textures, a bit each"},
    {"TRAIT_TEXTURES", "what these textures have, a bit each"},
    {"TRAIT_LOOKUPS", "the most textures that a material has"},
    {"TRAIT_BLEND_TEXTURES", "what textures that are weights of blends have, a bit each"},
    {"TRAIT_TEXTURED_NORMALS", "1: normal maps, 2: bump maps"},
    {"TRAIT_NORMAL_TEXTURES", "what textures of these have, a bit each"},
    {"TRAIT_BLEND_LEVELS", "depths of nesting at which weights of blends are textures, a bit each"},
    {"TRAIT_FILTER", "a pixel filter other than a box: one more than its reach in pixels"},
    {"TRAIT_ORTHOGRAPHIC", "orthographic camera"},
    {"TRAIT_THIN_LENS", "camera with a lens"},
    {"TRAIT_NEAR_CLIP", "surfaces before the camera's near plane"},
    {"TRAIT_FAR_CLIP", "surfaces beyond its far plane"},
    {"TRAIT_CAMERA_ORIGINS", "camera rays that do not all begin at one point"},
};

std::vector<std::string> words_of(const std::string &text) {
    std::istringstream stream(text);
    return {std::istream_iterator<std::string>(stream), {}};
}

BsdfKindTraits kind_from(const char *name, int lobes, bool transmits, const char *parameters) {
    BsdfKindTraits kind{name, lobes == 1, lobes == 2, transmits, false, false, words_of(parameters)};
    const auto has = [&](const char *parameter) { return std::ranges::count(kind.parameters, parameter) > 0; };
    kind.refracts = transmits && has("ior");
    kind.has_roughness = has("alpha_u");
    return kind;
}

const std::vector<BsdfKindTraits> &kinds() {
#define GRADUS_KIND_TRAITS(name, lobes, transmits, parameters) kind_from(#name, lobes, transmits, parameters),
    static const std::vector<BsdfKindTraits> list = {GRADUS_BSDF_KINDS(GRADUS_KIND_TRAITS)};
#undef GRADUS_KIND_TRAITS
    return list;
}

std::size_t place_of(const std::string &name) {
    return std::size_t(std::ranges::find(kinds(), name, &BsdfKindTraits::name) - kinds().begin());
}

} // namespace

const BsdfKindTraits &bsdf_kind_traits(BsdfKind kind) { return kinds().at(std::size_t(kind)); }

bool has_dirac_bsdf(const Scene &scene) {
    bool result = false;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { result = result || bsdf_kind_traits(bsdf.kind).is_dirac; });
    return result;
}

std::string bsdf_kind_name(const Bsdf &bsdf) { return bsdf_kind_traits(bsdf.kind).name; }

std::vector<std::string> all_bsdf_kinds() {
    std::vector<std::string> names;
    for (const BsdfKindTraits &kind : kinds())
        names.push_back(kind.name);
    return names;
}

BsdfKind bsdf_kind_named(const std::string &name) { return BsdfKind(&kinds().at(place_of(name)) - kinds().data()); }

std::uint32_t bsdf_kind_number(const Bsdf &bsdf) { return std::uint32_t(bsdf.kind); }

std::vector<std::string> bsdf_kinds(const Scene &scene) {
    std::set<std::string> found;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { found.insert(bsdf_kind_name(bsdf)); });
    std::vector<std::string> ordered;
    for (const BsdfKindTraits &kind : kinds())
        if (found.contains(kind.name))
            ordered.push_back(kind.name);
    return ordered;
}

bool bsdf_kind_is_dirac(const std::string &name) {
    const std::size_t place = place_of(name);
    return place < kinds().size() && kinds()[place].is_dirac;
}

namespace {

/// Whether what a texture is worth may leave its bounds, or these are not 0 and 1.
bool may_need_bounds(const Texture &texture) {
    if (texture.lowest > 0 || texture.highest < 1 || texture.scale != Texture().scale ||
        texture.kind == Texture::Kind::mesh_attribute)
        return true;
    const auto is_unit = [](float value) { return value >= 0 && value <= 1; };
    if (texture.kind == Texture::Kind::checkerboard)
        return !std::ranges::all_of(texture.color_0, is_unit) || !std::ranges::all_of(texture.color_1, is_unit);
    return texture.bitmap->format == Bitmap::Format::half || texture.bitmap->format == Bitmap::Format::real;
}

} // namespace

int texture_features(const Texture &texture) {
    using namespace lib_float;
    int features = texture.to_uv == Texture().to_uv ? 0 : textures_mapped;
    if (texture.to_uv[1] != 0 || texture.to_uv[3] != 0)
        features |= textures_turned;
    if (may_need_bounds(texture))
        features |= textures_bounded;
    if (texture.scale != Texture().scale)
        features |= textures_scaled;
    if (texture.kind == Texture::Kind::checkerboard)
        return features | textures_checkerboards;
    if (texture.kind == Texture::Kind::mesh_attribute)
        return features | textures_of_meshes | textures_in_color; // which it has the mesh knows
    const int formats[] = {textures_of_bytes, textures_of_words, textures_of_halves, textures_of_reals};
    features |= formats[int(texture.bitmap->format)];
    if (texture.is_srgb && texture.bitmap->format == Bitmap::Format::byte)
        features |= textures_of_srgb;
    features |= texture.bitmap->is_color ? textures_in_color : textures_in_gray;
    features |= texture.is_nearest ? textures_nearest : textures_bilinear;
    const bool repeats = texture.wrap == Texture::Wrap::repeat && texture.wrap_along_v() == Texture::Wrap::repeat;
    return features | (repeats ? 0 : textures_wrapped_otherwise);
}

std::uint32_t textured_column_count(int textured) {
    std::uint32_t columns = 0;
#define GRADUS_COLOR_COLUMNS(with, name, value, text) columns += textured >> lib_float::parameter_##name & 1 ? 3u : 0u;
#define GRADUS_NUMBER_COLUMN(with, name, value, text)                                                                  \
    columns += std::uint32_t(textured >> lib_float::parameter_##name & 1);
    GRADUS_TEXTURED_PARAMETERS(GRADUS_COLOR_COLUMNS, GRADUS_NUMBER_COLUMN, )
#undef GRADUS_COLOR_COLUMNS
#undef GRADUS_NUMBER_COLUMN
    return columns;
}

void for_each_textured_parameter(const Bsdf &bsdf, const std::function<void(int number, std::int32_t texture)> &visit) {
    static_assert(lib_float::textured_parameters <= 31, "TRAIT_TEXTURED has a bit for each");
    const std::vector<std::string> &read = bsdf_kind_traits(bsdf.kind).parameters;
#define GRADUS_VISIT(with, name, value, text)                                                                          \
    if (bsdf.name.texture != no_texture && std::ranges::count(read, #name) > 0)                                        \
        visit(lib_float::parameter_##name, bsdf.name.texture);
    GRADUS_TEXTURED_PARAMETERS(GRADUS_VISIT, GRADUS_VISIT, )
#undef GRADUS_VISIT
}

std::vector<std::int32_t> distinct_textures(const Bsdf &bsdf) {
    std::vector<std::int32_t> distinct;
    for_each_textured_parameter(bsdf, [&](int, std::int32_t texture) {
        if (std::ranges::count(distinct, texture) == 0)
            distinct.push_back(texture);
    });
    return distinct;
}

int most_lookups(const Scene &scene) {
    std::size_t most = 0;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { most = std::max(most, distinct_textures(bsdf).size()); });
    return int(most);
}

int blend_depth(const Scene &scene, const Bsdf &bsdf) {
    if (bsdf.blend == no_blend)
        return 0;
    const Blend &blend = scene.blends[std::size_t(bsdf.blend)];
    return 1 +
           std::max(blend_depth(scene, scene.blended[blend.first]), blend_depth(scene, scene.blended[blend.second]));
}

void for_each_blend(const Scene &scene, const Bsdf &bsdf, const std::function<void(const Blend &, int level)> &visit,
                    int level) {
    if (bsdf.blend == no_blend)
        return;
    const Blend &blend = scene.blends[std::size_t(bsdf.blend)];
    visit(blend, level);
    for_each_blend(scene, scene.blended[blend.first], visit, level + 1);
    for_each_blend(scene, scene.blended[blend.second], visit, level + 1);
}

void for_each_texture(const Scene &scene, const Shape &shape, const std::function<void(std::int32_t)> &visit) {
    const auto visit_if = [&](std::int32_t texture) {
        if (texture != no_texture)
            visit(texture);
    };
    const Material &material = scene.materials[shape.material];
    visit_if(material.opacity.texture);
    if (shape.emitter >= 0)
        visit_if(scene.emitters[std::size_t(shape.emitter)].texture);
    for (const Bsdf *side : {&material.front, &material.back}) {
        if (side == &material.back && !material.two_sided)
            continue;
        for_each_blend(scene, *side, [&](const Blend &blend, int) { visit_if(blend.weight.texture); });
        for_each_part(scene, *side, [&](const Bsdf &part) {
            for_each_textured_parameter(part, [&](int, std::int32_t texture) { visit_if(texture); });
            visit_if(part.map.texture);
        });
    }
}

void for_each_light_texture(const Scene &scene, const std::function<void(const Emitter &, int what)> &visit) {
    for (const Shape &shape : scene.shapes)
        if (shape.emitter >= 0 && scene.emitters[std::size_t(shape.emitter)].texture != no_texture)
            visit(scene.emitters[std::size_t(shape.emitter)], textured_lights_of_surfaces);
    for (const Emitter &emitter : scene.emitters)
        if (emitter.kind == Emitter::Kind::projector && !(emitter.value == Rgb{}))
            visit(emitter, textured_lights_projectors);
        else if (emitter.kind == Emitter::Kind::spot && emitter.texture != no_texture && !(emitter.value == Rgb{}))
            visit(emitter, textured_lights_spots);
}

bool bsdf_kind_is_mixed(const std::string &name) {
    const std::size_t place = place_of(name);
    return place < kinds().size() && kinds()[place].is_mixed;
}

namespace {

/// Of textures, blends and normal maps.
void add_material_traits(const Scene &scene, TraitMap &traits) {
    const MaterialClass all = class_of_all_materials(scene);
    traits["TRAIT_TEXTURED"] = all.textured;
    traits["TRAIT_TEXTURES"] = all.parameter.features;
    traits["TRAIT_LOOKUPS"] = all.lookups;
    traits["TRAIT_BLENDS"] = all.blends;
    traits["TRAIT_BLEND_TEXTURES"] = all.blend.features;
    traits["TRAIT_BLEND_LEVELS"] = all.blend_levels;
    traits["TRAIT_TEXTURED_NORMALS"] = all.normals;
    traits["TRAIT_NORMAL_TEXTURES"] = all.normal.features;
    traits["TRAIT_MATERIAL"] = all.textured != 0 || all.normals != 0 || all.blends > 0;
}

/// Of lights with textures.
void add_light_texture_traits(const Scene &scene, TraitMap &traits) {
    for_each_light_texture(scene, [&](const Emitter &emitter, int what) {
        traits["TRAIT_TEXTURED_LIGHTS"] |= what;
        if (emitter.texture != no_texture)
            traits["TRAIT_LIGHT_TEXTURES"] |= texture_features(scene.textures[std::size_t(emitter.texture)]);
    });
}

} // namespace

TraitMap scene_traits(const Scene &scene) {
    TraitMap traits;
    for (const TraitText &trait : descriptions)
        traits[trait.name] = 0;
    for (const Shape &shape : scene.shapes) {
        const bool mesh = shape.kind == Shape::Kind::mesh;
        traits[mesh ? "TRAIT_TRIANGLES" : "TRAIT_SPHERES"] = 1;
        if (mesh && !scene.meshes[shape.geometry].normals.empty())
            traits["TRAIT_SHADING_NORMALS"] = 1;
        if (shape.emitter >= 0)
            traits[mesh ? "TRAIT_LIGHT_TRIANGLE" : "TRAIT_LIGHT_SPHERE"] = 1;
        const Material &material = scene.materials[shape.material];
        if (material.two_sided) {
            traits["TRAIT_TWO_SIDED"] = 1;
            if (!(material.front == material.back))
                traits["TRAIT_TWO_FACED"] = 1;
        }
    }
    for_each_bsdf(scene, [&](const Bsdf &bsdf) {
        const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
        if (kind.is_mixed)
            traits["TRAIT_MIXED_LOBES"] = 1;
        if (kind.refracts)
            traits["TRAIT_REFRACTION"] = 1;
        if (kind.has_roughness && bsdf.alpha_u != bsdf.alpha_v)
            traits["TRAIT_ANISOTROPIC"] = 1;
    });
    add_material_traits(scene, traits);
    add_light_texture_traits(scene, traits);
    for (const Emitter &emitter : scene.emitters) {
        if (emitter.value == Rgb{})
            continue; // black: no light
        switch (emitter.kind) {
        case Emitter::Kind::area:
            break; // by the shape that bears it
        case Emitter::Kind::projector:
            break; // by TRAIT_TEXTURED_LIGHTS
        case Emitter::Kind::constant:
            traits["TRAIT_ENVIRONMENT"] = 1;
            traits["TRAIT_LIGHT_CONSTANT"] = 1;
            break;
        case Emitter::Kind::point:
            traits["TRAIT_LIGHT_POINT"] = 1;
            break;
        case Emitter::Kind::directional:
            traits["TRAIT_LIGHT_DIRECTIONAL"] = 1;
            break;
        case Emitter::Kind::environment:
            traits["TRAIT_ENVIRONMENT"] = 1;
            traits["TRAIT_LIGHT_ENVIRONMENT"] = 1;
            break;
        case Emitter::Kind::spot:
            traits["TRAIT_LIGHT_SPOT"] = 1;
            break;
        }
    }
    traits["TRAIT_HIDE_EMITTERS"] = scene.settings.hide_emitters;
    traits["TRAIT_FILTER"] =
        scene.film.filter == FilmSettings::Filter::box ? 0 : 1 + static_cast<int>(filter_reach(scene.film));
    const CameraClips clips = camera_clips(scene);
    traits["TRAIT_ORTHOGRAPHIC"] = scene.camera.kind == Camera::Kind::orthographic;
    traits["TRAIT_THIN_LENS"] = scene.camera.kind == Camera::Kind::thin_lens;
    traits["TRAIT_NEAR_CLIP"] = clips.near_clip;
    traits["TRAIT_FAR_CLIP"] = clips.far_clip;
    traits["TRAIT_CAMERA_ORIGINS"] = scene.camera.kind != Camera::Kind::perspective || clips.near_clip;
    traits["TRAIT_INSTANCES"] = !scene.instances.empty();
    std::size_t triangles = 0;
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh)
            triangles += scene.meshes[shape.geometry].triangles.size();
    traits["TRAIT_INDEXED"] = indexed_trait(traits, triangles);
    return traits;
}

std::vector<std::pair<std::string, int>> trait_list(const Scene &scene) {
    const TraitMap traits = scene_traits(scene);
    std::vector<std::pair<std::string, int>> list;
    for (const TraitText &trait : descriptions)
        list.emplace_back(trait.name, traits.at(trait.name));
    return list;
}

std::string trait_description(const std::string &name) {
    for (const TraitText &trait : descriptions)
        if (trait.name == name)
            return trait.text;
    return "";
}

TraitMap with_all_traits(TraitMap traits) {
    for (auto &[name, value] : traits) {
        // The filter and hidden emitters change the picture, TRAIT_INDEXED and TRAIT_INSTANCES how tables lie; the rest
        // only makes room for what is not there.
        const bool setting = name == "TRAIT_FILTER" || name == "TRAIT_HIDE_EMITTERS" || name == "TRAIT_INDEXED" ||
                             name == "TRAIT_INSTANCES" || name.starts_with("TRAIT_TEXTURE") ||
                             name == "TRAIT_MATERIAL" || name == "TRAIT_LOOKUPS" || name == "TRAIT_NORMAL_TEXTURES" ||
                             name == "TRAIT_LIGHT_TEXTURES" || name.starts_with("TRAIT_BLEND");
        if (!setting)
            value = 1;
    }
    if (traits["TRAIT_INDEXED"] != 0) // vertices have what all of these read
        traits["TRAIT_INDEXED"] = indexed_trait(traits, std::numeric_limits<std::size_t>::max());
    return traits;
}

} // namespace gradus
