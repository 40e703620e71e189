#include "runtime/scene/texture_tables.h"

#include "kernels/shared/texture.h"
#include "runtime/error.h"
#include "runtime/scene/traits.h"

#include <algorithm>
#include <map>

namespace gradus {

using namespace lib_float;

namespace {

/// The pictures one after the other, each once. By picture: its first word.
std::map<const Bitmap *, std::uint32_t> add_bitmaps(const Scene &scene, SceneTables &tables) {
    std::map<const Bitmap *, std::uint32_t> offsets;
    std::uint64_t words = 0;
    for (const Texture &texture : scene.textures)
        if (texture.bitmap && offsets.emplace(texture.bitmap.get(), std::uint32_t(words)).second)
            words += texture.bitmap->words.size();
    if (words >= 0xFFFFFFFFu)
        throw Error(ExitCode::device, "the scene's textures have more than 16 GiB of pixels");
    tables.texels.resize(std::size_t(words) + 1); // one at least
    for (const auto &[bitmap, offset] : offsets)
        std::copy(bitmap->words.begin(), bitmap->words.end(), tables.texels.begin() + offset);
    return offsets;
}

std::uint32_t flags_of(const Texture &texture) {
    std::uint32_t flags = std::uint32_t(texture.wrap) << 4 | std::uint32_t(texture.wrap_along_v()) << 8;
    flags |= texture.is_nearest ? texture_flag_nearest : 0;
    if (texture.kind == Texture::Kind::checkerboard)
        return flags | texture_flag_checkerboard;
    flags |= texture.is_srgb && texture.bitmap->format == Bitmap::Format::byte ? texture_flag_srgb : 0;
    return flags | std::uint32_t(texture.bitmap->format) | (texture.bitmap->is_color ? texture_flag_color : 0);
}

void add_normal_map(const NormalTexture &map, SceneTables &tables) {
    std::uint32_t flags = 0;
    if (map.kind != NormalTexture::Kind::none)
        flags = normal_map_there | (map.turns_over ? normal_map_turns : 0) | (map.shadows ? normal_map_shadows : 0) |
                (map.kind == NormalTexture::Kind::bump ? normal_map_is_bump : 0) |
                (map.is_outside ? normal_map_is_outside : 0);
    tables.normal_maps.insert(tables.normal_maps.end(), {flags, flags == 0 ? 0 : std::uint32_t(map.texture)});
    tables.bump_scales.push_back(map.scale);
}

} // namespace

void add_triangle_texcoords(const Mesh &mesh, const std::array<std::uint32_t, 3> &triangle, SceneTables &tables) {
    constexpr std::array<float, 2> unit[] = {{0, 0}, {1, 0}, {0, 1}};
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto &[u, v] = mesh.texcoords.empty() ? unit[corner] : mesh.texcoords[triangle[corner]];
        tables.triangle_texcoords.insert(tables.triangle_texcoords.end(), {u, v});
    }
}

void add_textures(const Scene &scene, SceneTables &tables) {
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::sphere)
            for (const Vector3 &axis : scene.spheres[shape.geometry].axes)
                tables.sphere_axes.insert(tables.sphere_axes.end(), {axis.x, axis.y, axis.z});
    // Kernels compiled for both kinds of primitives read a record of each.
    tables.sphere_axes.resize(std::max<std::size_t>(tables.sphere_axes.size(), sphere_axes_stride));
    tables.triangle_texcoords.resize(std::max<std::size_t>(tables.triangle_texcoords.size(), texcoords_stride));

    const std::map<const Bitmap *, std::uint32_t> offsets = add_bitmaps(scene, tables);
    for (const Texture &texture : scene.textures) {
        const bool has_bitmap = texture.bitmap != nullptr;
        tables.textures.insert(tables.textures.end(),
                               {flags_of(texture), has_bitmap ? offsets.at(texture.bitmap.get()) : 0,
                                has_bitmap ? texture.bitmap->width : 1, has_bitmap ? texture.bitmap->height : 1});
        auto &reals = tables.texture_reals;
        reals.insert(reals.end(), texture.to_uv.begin(), texture.to_uv.end());
        reals.insert(reals.end(), {texture.lowest, texture.highest});
        for (const auto *color : {&texture.scale, &texture.color_0, &texture.color_1})
            reals.insert(reals.end(), color->begin(), color->end());
    }
    const auto lookups = std::size_t(std::max(1, most_lookups(scene)));
    for (const Bsdf &bsdf : material_records(scene)) {
        const std::size_t first = tables.material_textures.size();
        tables.material_textures.resize(first + textured_parameters, texture_none);
        std::vector<std::int32_t> distinct = distinct_textures(bsdf);
        for_each_textured_parameter(bsdf, [&](int number, std::int32_t texture) {
            tables.material_textures[first + std::size_t(number)] =
                std::uint32_t(std::ranges::find(distinct, texture) - distinct.begin());
        });
        distinct.resize(lookups, 0);
        tables.material_lookups.insert(tables.material_lookups.end(), distinct.begin(), distinct.end());
        add_normal_map(bsdf.map, tables);
    }
    if (scene.textures.empty()) { // kernels may ask for one, whatever they then take
        tables.textures.assign(texture_stride, 0);
        tables.texture_reals.assign(texture_real_stride, 0);
    }
}

void add_blends(const Scene &scene, SceneTables &tables) {
    const std::vector<Bsdf> records = material_records(scene);
    const auto parts = std::uint32_t(records.size() - scene.blended.size());
    for (const Bsdf &bsdf : records) {
        const auto kind = std::ranges::find(tables.kinds, bsdf_kind_name(bsdf));
        const bool is_blend = bsdf.blend != no_blend;
        tables.record_kind.push_back(
            is_blend || kind == tables.kinds.end() ? 0 : std::uint32_t(kind - tables.kinds.begin()));
        const Blend blend = is_blend ? scene.blends[std::size_t(bsdf.blend)] : Blend();
        tables.blends.insert(tables.blends.end(), {is_blend ? parts + blend.first : blend_none, parts + blend.second,
                                                   std::uint32_t(blend.weight.texture)});
        tables.blend_weights.push_back(blend.weight.value);
    }
}

} // namespace gradus
