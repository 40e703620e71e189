#include "runtime/scene/texture_tables.h"

#include "kernels/shared/texture.h"
#include "runtime/error.h"
#include "runtime/scene/traits.h"
#include "runtime/scene/vertex_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>

namespace gradus {

using namespace lib_float;

namespace {

void check_words(std::uint64_t words) {
    // Kernels name them by signed numbers, for which processors gather sixteen at once.
    if (words > 0x7FFFFFFFu)
        throw Error(ExitCode::device, "the scene's textures and mesh attributes have more than 8 GiB");
}

/// Of one picture, whose texels kernels count by 32 bits; four of them may share a word.
void check_texels(const Bitmap &bitmap) {
    if (std::uint64_t(bitmap.width) * bitmap.height > std::uint64_t(1) << 32)
        throw Error(ExitCode::device, fmt::format("a picture of {} x {} texels has more than 2^32, the most that a "
                                                  "texture may have",
                                                  bitmap.width, bitmap.height));
}

/// The pictures one after the other, each once. By picture: its first word.
std::map<const Bitmap *, std::uint32_t> add_bitmaps(const Scene &scene, SceneTables &tables) {
    std::map<const Bitmap *, std::uint32_t> offsets;
    const bool has_srgb = std::any_of(scene.textures.begin(), scene.textures.end(), [](const Texture &texture) {
        return (texture_features(texture) & textures_of_srgb) != 0;
    });
    std::uint64_t words = has_srgb ? texture_srgb_words : 0;
    std::vector<const Bitmap *> bitmaps;
    for (const Texture &texture : scene.textures)
        if (texture.bitmap && offsets.emplace(texture.bitmap.get(), std::uint32_t(words)).second) {
            check_texels(*texture.bitmap);
            bitmaps.push_back(texture.bitmap.get());
            words += texture.bitmap->words.size();
        }
    check_words(words);
    std::vector<std::uint32_t> &texels = tables.texels;
    texels.reserve(std::size_t(words) + 1);
    for (std::uint32_t code = 0; has_srgb && code < texture_srgb_words; ++code)
        texels.push_back(std::bit_cast<std::uint32_t>(float(srgb_to_linear_value(code / 255.0))));
    for (const Bitmap *bitmap : bitmaps)
        texels.insert(texels.end(), bitmap->words.begin(), bitmap->words.end());
    texels.push_back(0); // one at least
    return offsets;
}

/// How a mesh attribute lies in the words.
struct AttributePlace {
    std::uint32_t offset = 0, channels = 1;
    std::uint32_t first = 0, count = 1; ///< the triangles, or the vertices that they share, that are there
    bool by_vertex = false;             ///< of these
    /// Of one of them.
    std::size_t words(const std::string &name) const {
        return std::size_t(channels) * (is_by_face(name) || by_vertex ? 1 : 3);
    }
};

/// Calls visit(attribute or nullptr, shape, number of its first triangle or vertex, how many it has) for each mesh of
/// the scene, in the order of the tables.
template <class Visit>
void for_each_mesh(const Scene &scene, const SceneTables &tables, const std::string &name, bool by_vertex,
                   const Visit &visit) {
    std::size_t first = by_vertex ? tables.first_vertex : 0;
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh) {
            const Mesh &mesh = scene.meshes[shape.geometry];
            const std::size_t count = by_vertex ? table_vertex_count(scene, shape) : mesh.triangles.size();
            visit(find_attribute(mesh, name), shape, first, count);
            first += count;
        }
}

void put_attribute(const MeshAttribute &attribute, const Scene &scene, const Shape &shape, std::size_t count,
                   const AttributePlace &place, std::uint32_t *to) {
    const auto put = [&](std::size_t element) {
        for (std::size_t c = 0; c < place.channels; ++c)
            *to++ = std::bit_cast<std::uint32_t>(
                attribute.values[element * attribute.channels + (attribute.channels > 1 ? c : 0)]);
    };
    const bool has_own = has_own_vertices(scene, shape);
    for (std::size_t i = 0; i < count; ++i)
        if (place.by_vertex)
            put(has_own ? scene.meshes[shape.geometry].triangles[i / 3][i % 3] : i);
        else if (is_by_face(attribute.name))
            put(i);
        else
            for (const std::uint32_t corner : scene.meshes[shape.geometry].triangles[i])
                put(corner);
}

/// The mesh attributes that textures name, each from the first triangle or vertex that has it to the last.
std::map<std::string, AttributePlace> add_attributes(const Scene &scene, SceneTables &tables) {
    std::map<std::string, AttributePlace> places;
    for (const Texture &texture : scene.textures) {
        const std::string &name = texture.attribute;
        if (texture.kind != Texture::Kind::mesh_attribute || places.contains(name))
            continue;
        AttributePlace &place = places[name];
        place.by_vertex = tables.is_indexed() && !is_by_face(name);
        std::size_t begin = SIZE_MAX, end = 0;
        for_each_mesh(scene, tables, name, place.by_vertex,
                      [&](const MeshAttribute *attribute, const Shape &, std::size_t first, std::size_t count) {
                          if (!attribute)
                              return;
                          place.channels = std::max(place.channels, attribute->channels);
                          begin = std::min(begin, first);
                          end = std::max(end, first + count);
                      });
        if (begin >= end) { // no shape has it: none takes what is there
            begin = 0;
            end = 1;
        }
        const std::size_t words = place.words(name), base = tables.texels.size();
        check_words(base + (end - begin) * words);
        tables.texels.resize(base + (end - begin) * words);
        place.offset = std::uint32_t(base);
        place.first = std::uint32_t(begin);
        place.count = std::uint32_t(end - begin);
        for_each_mesh(scene, tables, name, place.by_vertex,
                      [&](const MeshAttribute *attribute, const Shape &shape, std::size_t first, std::size_t count) {
                          if (attribute)
                              put_attribute(*attribute, scene, shape, count, place,
                                            &tables.texels[base + (first - begin) * words]);
                      });
    }
    if (!places.empty())
        tables.texels.resize(tables.texels.size() + 2); // who takes the last for a picture reads three words
    return places;
}

std::uint32_t flags_of(const Texture &texture) {
    std::uint32_t flags = std::uint32_t(texture.wrap) << 4 | std::uint32_t(texture.wrap_along_v()) << 8;
    flags |= texture.is_nearest ? texture_flag_nearest : 0;
    if (texture.kind == Texture::Kind::checkerboard)
        return flags | texture_flag_checkerboard;
    if (texture.kind == Texture::Kind::mesh_attribute)
        return texture_format_real | texture_flag_attribute |
               (is_by_face(texture.attribute) ? texture_flag_by_face : 0);
    flags |= texture.is_srgb && texture.bitmap->format == Bitmap::Format::byte ? texture_flag_srgb : 0;
    return flags | std::uint32_t(texture.bitmap->format) | (texture.bitmap->is_color ? texture_flag_color : 0);
}

void add_normal_map(const NormalTexture &map, SceneTables &tables) {
    std::uint32_t flags = 0;
    if (map.kind != NormalTexture::Kind::none)
        flags = normal_map_there | (map.turns_over ? normal_map_turns : 0) | (map.shadows ? normal_map_shadows : 0) |
                (map.kind == NormalTexture::Kind::bump ? normal_map_is_bump : 0) |
                (map.is_outside ? normal_map_is_outside : 0);
    tables.normal_maps.insert(tables.normal_maps.end(),
                              {flags, flags == 0 ? texture_absent : std::uint32_t(map.texture)});
    tables.bump_scales.push_back(map.scale);
}

} // namespace

void add_triangle_texcoords(const Mesh &mesh, const std::array<std::uint32_t, 3> &triangle, SceneTables &tables) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto &[u, v] = mesh.texcoords.empty() ? unit_texcoords[corner] : mesh.texcoords[triangle[corner]];
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
    const std::map<std::string, AttributePlace> attributes = add_attributes(scene, tables);
    for (const Texture &texture : scene.textures) {
        const bool has_bitmap = texture.bitmap != nullptr;
        const bool is_attribute = texture.kind == Texture::Kind::mesh_attribute;
        const AttributePlace attribute = is_attribute ? attributes.at(texture.attribute) : AttributePlace();
        const std::uint32_t flags = flags_of(texture) | (attribute.channels > 1 ? texture_flag_color : 0) |
                                    (attribute.by_vertex ? texture_flag_by_vertex : 0);
        tables.textures.insert(tables.textures.end(),
                               {flags, has_bitmap ? offsets.at(texture.bitmap.get()) : attribute.offset,
                                has_bitmap ? texture.bitmap->width : 1, has_bitmap ? texture.bitmap->height : 1,
                                attribute.first, attribute.count});
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
        std::vector<std::uint32_t> numbers(distinct.begin(), distinct.end());
        numbers.resize(lookups, texture_absent);
        tables.material_lookups.insert(tables.material_lookups.end(), numbers.begin(), numbers.end());
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
        const std::uint32_t kind = tables.place_of_kind(bsdf_kind_name(bsdf), class_of_blends_and_maps);
        const bool is_blend = bsdf.blend != no_blend;
        tables.record_kind.push_back(is_blend || kind == tables.kinds.size() ? 0 : kind);
        const Blend blend = is_blend ? scene.blends[std::size_t(bsdf.blend)] : Blend();
        tables.blends.insert(
            tables.blends.end(),
            {is_blend ? parts + blend.first : blend_none, parts + blend.second,
             blend.weight.texture == no_texture ? texture_absent : std::uint32_t(blend.weight.texture)});
        tables.blend_weights.push_back(blend.weight.value);
    }
}

} // namespace gradus
