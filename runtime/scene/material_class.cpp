#include "runtime/scene/material_class.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/texture.h"

namespace gradus {

namespace {

/// Records of so many textures are loaded once for all work-items (kernels/lib/texture_lookup.h): that is worth it as
/// long as choosing one of them takes less than loading it.
constexpr std::uint32_t most_counted = 4;

void add(const Scene &scene, std::int32_t texture, TextureUse &use) {
    const auto number = std::uint32_t(texture);
    use.first = use.features == 0 ? number : std::min(use.first, number);
    use.last = use.features == 0 ? number : std::max(use.last, number);
    use.features |= texture_features(scene.textures[number]);
}

TextureUse both(const TextureUse &a, const TextureUse &b) {
    if (a.features == 0 || b.features == 0)
        return a.features == 0 ? b : a;
    return {a.features | b.features, std::min(a.first, b.first), std::max(a.last, b.last)};
}

/// All that counts but which textures they are.
auto kind_of(const MaterialClass &one) {
    return std::tuple(one.on_triangles, one.on_spheres, one.two_faced, one.textured, one.all_textured, one.lookups,
                      one.blends, one.blend_levels, one.normals, one.parameter.features, one.blend.features,
                      one.normal.features);
}

MaterialClass both(const MaterialClass &a, const MaterialClass &b) {
    return {a.on_triangles || b.on_triangles, a.on_spheres || b.on_spheres,    a.two_faced || b.two_faced,
            a.textured | b.textured,          a.all_textured & b.all_textured, std::max(a.lookups, b.lookups),
            std::max(a.blends, b.blends),     a.blend_levels | b.blend_levels, a.normals | b.normals,
            both(a.parameter, b.parameter),   both(a.blend, b.blend),          both(a.normal, b.normal)};
}

/// About how much a kernel does.
int work(const MaterialClass &one) {
    const auto bits = [](int mask) { return std::popcount(unsigned(mask)); };
    return 2 * (one.on_triangles + one.on_spheres + one.two_faced) + one.lookups * bits(one.parameter.features) +
           one.blends + bits(one.blend_levels) * bits(one.blend.features) + 4 * bits(one.normals) +
           bits(one.normal.features);
}

MaterialClass class_of(const Scene &scene, const Material &material) {
    MaterialClass one;
    one.two_faced = material.two_sided && !(material.front == material.back);
    for (const Bsdf *side : {&material.front, &material.back}) {
        if (side == &material.back && !material.two_sided)
            continue;
        one.blends = std::max(one.blends, blend_depth(scene, *side));
        for_each_blend(scene, *side, [&](const Blend &blend, int level) {
            if (blend.weight.texture == no_texture)
                return;
            one.blend_levels |= 1 << std::min(level, 30);
            add(scene, blend.weight.texture, one.blend);
        });
        for_each_part(scene, *side, [&](const Bsdf &part) {
            one.lookups = std::max(one.lookups, int(distinct_textures(part).size()));
            int textured = 0;
            for_each_textured_parameter(part, [&](int number, std::int32_t texture) {
                textured |= 1 << number;
                add(scene, texture, one.parameter);
            });
            one.textured |= textured;
            one.all_textured &= textured;
            if (part.map.kind == NormalTexture::Kind::none)
                return;
            one.normals |= part.map.kind == NormalTexture::Kind::bump ? textured_normals_bump : textured_normals_given;
            add(scene, part.map.texture, one.normal);
        });
    }
    return one;
}

/// Of each material that a shape has.
std::vector<std::optional<MaterialClass>> classes_by_material(const Scene &scene) {
    std::vector<std::optional<MaterialClass>> found(scene.materials.size());
    for (const Shape &shape : scene.shapes) {
        std::optional<MaterialClass> &one = found[shape.material];
        if (!one)
            one = class_of(scene, scene.materials[shape.material]);
        one->on_triangles |= shape.kind == Shape::Kind::mesh;
        one->on_spheres |= shape.kind == Shape::Kind::sphere;
    }
    return found;
}

/// Puts class b with class a.
void merge(MaterialClasses &found, std::size_t a, std::size_t b) {
    found.classes[a] = both(found.classes[a], found.classes[b]);
    found.classes.erase(found.classes.begin() + std::ptrdiff_t(b));
    for (std::uint32_t &place : found.of_material)
        place = place == b ? std::uint32_t(a) : place > b ? place - 1 : place;
}

} // namespace

MaterialClass class_of_all_materials(const Scene &scene) {
    MaterialClass all;
    for (const std::optional<MaterialClass> &one : classes_by_material(scene))
        if (one)
            all = both(all, *one);
    return all;
}

MaterialClasses material_classes(const Scene &scene, std::size_t most) {
    const std::vector<std::optional<MaterialClass>> of_material = classes_by_material(scene);
    MaterialClasses found;
    found.of_material.resize(of_material.size());
    for (std::size_t i = 0; i < of_material.size(); ++i) {
        if (!of_material[i])
            continue;
        const MaterialClass &one = *of_material[i];
        const auto like = std::ranges::find_if(
            found.classes, [&](const MaterialClass &other) { return kind_of(other) == kind_of(one); });
        found.of_material[i] = std::uint32_t(like - found.classes.begin());
        if (like == found.classes.end())
            found.classes.push_back(one);
        else
            *like = both(*like, one);
    }
    while (found.classes.size() > most) {
        std::size_t best_a = 0, best_b = 1;
        int least = std::numeric_limits<int>::max();
        for (std::size_t a = 0; a < found.classes.size(); ++a)
            for (std::size_t b = a + 1; b < found.classes.size(); ++b) {
                const MaterialClass &one = found.classes[a], &other = found.classes[b];
                const int more = 2 * work(both(one, other)) - work(one) - work(other);
                if (more < least) {
                    least = more;
                    best_a = a;
                    best_b = b;
                }
            }
        merge(found, best_a, best_b);
    }
    if (found.classes.empty())
        found.classes.emplace_back();
    return found;
}

std::vector<KindOfClass> kinds_by_class(const Scene &scene, const MaterialClasses &classes) {
    std::set<std::pair<std::string, std::uint32_t>> found;
    for (const Shape &shape : scene.shapes) {
        const Material &material = scene.materials[shape.material];
        const std::uint32_t number = classes.of_kinds(shape.material);
        for (const Bsdf *side : {&material.front, material.two_sided ? &material.back : &material.front})
            for_each_part(scene, *side, [&](const Bsdf &part) { found.emplace(bsdf_kind_name(part), number); });
    }
    std::vector<KindOfClass> kinds;
    for (const std::string &kind : bsdf_kinds(scene))
        for (const auto &[name, number] : found)
            if (name == kind)
                kinds.push_back({name, number});
    return kinds;
}

std::map<std::string, std::string> definitions_of(const MaterialClass &one) {
    using namespace lib_float;
    const auto features = [](const TextureUse &use) {
        const std::uint32_t count = use.last - use.first + 1;
        return std::to_string(use.features == 0 ? 0
                                                : textures_with_count(use.features, count <= most_counted ? count : 0));
    };
    return {{"TRAIT_TRIANGLES", one.on_triangles ? "1" : "0"},
            {"TRAIT_SPHERES", one.on_spheres ? "1" : "0"},
            {"TRAIT_TWO_FACED", one.two_faced ? "1" : "0"},
            {"TRAIT_TEXTURES", features(one.parameter)},
            {"TRAIT_BLEND_TEXTURES", features(one.blend)},
            {"TRAIT_BLEND_LEVELS", std::to_string(one.blend_levels)},
            {"TRAIT_NORMAL_TEXTURES", features(one.normal)},
            {"CLASS_TEXTURED", std::to_string(one.textured)},
            {"CLASS_ALL_TEXTURED", std::to_string(one.all_textured)},
            {"CLASS_LOOKUPS", std::to_string(one.lookups)},
            {"CLASS_BLENDS", std::to_string(one.blends)},
            {"CLASS_NORMALS", std::to_string(one.normals)}};
}

} // namespace gradus
