// BSDFs of a scene file: the materials of its shapes, blends and maps.
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/scene_builder.h"
#include "runtime/scene/coating.h"
#include "runtime/scene/traits.h"

namespace gradus {

/// A BSDF that no shape uses cannot harm the image: what is wrong with it is worth a warning. Its pictures are not
/// worth to be decoded, and nothing of it stays in the scene.
void SceneBuilder::check_unused_bsdfs(const std::vector<const Element *> &elements) {
    const std::size_t textures = scene_.textures.size(), blends = scene_.blends.size(), blended = scene_.blended.size();
    Bitmap gray;
    gray.resize(1, 1, Bitmap::Format::byte, false);
    gray.set(0, 0, 0, 128);
    stand_in_ = std::make_shared<const Bitmap>(std::move(gray));
    for (const Element *element : elements)
        try {
            if (!built_materials_.contains(element))
                build_object<Material>(*element);
        } catch (const SceneError &error) {
            diagnostics_.warn(element->location, std::string("unused BSDF: ") + error.what());
        }
    stand_in_.reset();
    scene_.textures.resize(textures);
    scene_.blends.resize(blends);
    scene_.blended.resize(blended);
    blend_parts_.resize(blends);
}

bool SceneBuilder::is_bsdf(const Element &child) const {
    return (child.tag == "ref" ? resolve_(child) : child).tag == "bsdf";
}

std::uint32_t SceneBuilder::material_of(const Element &shape) {
    const std::vector<NestedObject> bsdfs = nested_objects(shape, "bsdf", resolve_);
    if (bsdfs.size() > 1)
        throw SceneError(bsdfs[1].location,
                         std::string("a shape has one BSDF; this is its second") +
                             (type_of(shape) == "obj" ? "; only in files of 0.x is there one for each material that "
                                                        "an OBJ file names"
                                                      : ""));
    if (bsdfs.empty()) {
        // Mitsuba 3's defaults: half of the light is reflected, but nothing by a shape that emits.
        const bool emits = !nested_objects(shape, "emitter", resolve_).empty();
        std::int64_t &index = emits ? default_emitter_material_ : default_material_;
        if (index < 0) {
            index = std::int64_t(scene_.materials.size());
            scene_.materials.push_back({});
            scene_.materials.back().name = emits ? "default of emitters" : "default";
            if (emits)
                scene_.materials.back().front.reflectance = {0, 0, 0};
        }
        return std::uint32_t(index);
    }
    const Element &element = *bsdfs.front().element;
    const auto known = materials_.find(&element);
    if (known != materials_.end())
        return known->second;
    Material material = build_object<Material>(element);
    material.name = element.attribute_or("id", element.attribute_or("type", "") + " at " + element.location.text());
    const auto index = std::uint32_t(scene_.materials.size());
    scene_.materials.push_back(material);
    materials_[&element] = index;
    return index;
}

std::uint32_t SceneBuilder::boundary_material() {
    if (boundary_material_ < 0) {
        boundary_material_ = std::int64_t(scene_.materials.size());
        scene_.materials.push_back({});
        scene_.materials.back().front.kind = BsdfKind::null;
        scene_.materials.back().name = "boundary of a medium";
    }
    return std::uint32_t(boundary_material_);
}

void SceneBuilder::check_blended(std::uint64_t more, const Location &location) const {
    if (scene_.blended.size() + more > limits_.blended)
        throw SceneError(location,
                         "the blends up to this one hold more than " + std::to_string(limits_.blended) + " BSDFs" +
                             limits_hint,
                         "blended");
}

Bsdf SceneBuilder::blend(const Bsdf &first, const Bsdf &second, const Number &weight, const Location &location) {
    // Whatever goes through a blend meets a part as often as it is held, and blends of a blend twice are soon millions.
    const auto parts_of = [this](const Bsdf &part) {
        return part.blend == no_blend ? 1 : blend_parts_[std::size_t(part.blend)];
    };
    const std::uint64_t parts = parts_of(first) + parts_of(second);
    if (parts > limits_.blend_parts)
        throw SceneError(location,
                         "a blend of more than " + std::to_string(limits_.blend_parts) + " BSDFs" + limits_hint);
    check_blended(2, location);
    blend_parts_.push_back(parts);
    Blend blend;
    blend.weight = weight;
    blend.first = std::uint32_t(scene_.blended.size());
    scene_.blended.push_back(first);
    blend.second = std::uint32_t(scene_.blended.size());
    scene_.blended.push_back(second);
    Bsdf bsdf;
    bsdf.blend = std::int32_t(scene_.blends.size());
    scene_.blends.push_back(blend);
    return bsdf;
}

Bsdf SceneBuilder::with_map(const Bsdf &bsdf, const NormalTexture &map, const Location &location) {
    if (bsdf.blend != no_blend) {
        // All of it is copied.
        check_blended(2 * (blend_parts_[std::size_t(bsdf.blend)] - 1), location);
        const Blend parts = scene_.blends[std::size_t(bsdf.blend)];
        const Bsdf first = with_map(Bsdf(scene_.blended[parts.first]), map, location);
        return blend(first, with_map(Bsdf(scene_.blended[parts.second]), map, location), parts.weight, location);
    }
    if (bsdf.map.kind != NormalTexture::Kind::none)
        throw SceneError(location, "a normal map or bump map around another one is not supported");
    Bsdf mapped = bsdf;
    if (bsdf.kind != BsdfKind::null) // which has no normal
        mapped.map = map;
    return mapped;
}

Material SceneBuilder::with_map(Material material, const NormalTexture &map, const Location &location) {
    NormalTexture of_sides = map;
    of_sides.is_outside = material.two_sided;
    const bool is_alike = material.back == material.front;
    material.front = with_map(material.front, of_sides, location);
    if (material.two_sided)
        material.back = is_alike ? material.front : with_map(material.back, of_sides, location);
    return material;
}

void SceneBuilder::set_coating(Bsdf &bsdf) {
    if (bsdf.alpha_u.texture != no_texture)
        return gradus::set_coating(bsdf);
    const auto [known, is_new] = coatings_.try_emplace({bsdf.kind, bsdf.ior, bsdf.alpha_u.value}, bsdf);
    if (is_new)
        gradus::set_coating(known->second);
#define GRADUS_TAKE(with, name, value, text) bsdf.name = known->second.name;
    GRADUS_COAT_PARAMETERS(GRADUS_TAKE, )
#undef GRADUS_TAKE
}

bool SceneBuilder::transmits(const Bsdf &bsdf) const {
    bool found = false;
    for_each_part(scene_, bsdf, [&](const Bsdf &part) { found |= bsdf_kind_traits(part.kind).transmits; });
    return found;
}

} // namespace gradus
