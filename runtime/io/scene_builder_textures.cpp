// The part of the scene builder that reads textures, and keeps blends: each picture once, each texture once for each
// range.
#include "runtime/error.h"
#include "runtime/io/absent_plugins.h"
#include "runtime/io/bitmap_reader.h"
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/scene_builder.h"
#include "runtime/io/text.h"
#include "runtime/phases.h"
#include "runtime/scene/traits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <unordered_set>
#include <utility>

namespace gradus {

/// Those that shapes, lights and what else makes the image come to; of BSDFs and textures that are there to be referred
/// to, only those that are. <ref>s that lead nowhere are told where they are read.
std::unordered_set<const Element *> SceneBuilder::used_objects() const {
    std::unordered_set<const Element *> used;
    std::vector<const Element *> left; // no recursion: references may be as deep as a file is long
    for (const Element &child : document_.root.children)
        if (child.tag != "bsdf" && child.tag != "texture")
            left.push_back(&child);
    while (!left.empty()) {
        const Element *const element = left.back();
        left.pop_back();
        const std::string *const id = element->tag == "ref" ? element->attribute("id") : nullptr;
        const Element *const meant = id ? find_by_id(*id) : element;
        if (!meant || !used.insert(meant).second)
            continue;
        for (const Element &child : meant->children)
            if (child.tag == "ref" || is_object_tag(child.tag))
                left.push_back(&child);
    }
    return used;
}

/// Has the pictures that textures name decoded, as the rest is built.
void SceneBuilder::begin_pictures() {
    const auto used = pictures_.empty() ? std::unordered_set<const Element *>() : used_objects();
    std::vector<Picture> pictures;
    const Plugin<Texture> plugin = find_plugin<Texture>("bitmap");
    for (const Element *element : pictures_) {
        if (!used.contains(element))
            continue; // nobody will ask for it
        // What is wrong with it, or strange, is said where it is built.
        diagnostics_.hold();
        try {
            Properties properties(*element, *plugin.declaration, resolve_, diagnostics_, &read_texture_);
            pictures.push_back(read_picture(properties, *this));
        } catch (const SceneError &) {
        }
        diagnostics_.release();
    }
    constexpr unsigned most_threads = 8;
    constexpr std::uint64_t most_bytes = 512u << 20;
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    // The loader decodes too.
    const unsigned threads = pictures.size() > 1 ? std::min(std::max(cores - 1, 1u), most_threads) : 0;
    pictures_ahead_.emplace(pictures, threads, most_bytes, [this](const Picture &picture) {
        const auto file = finder_.open(picture.path);
        if (!file)
            throw Error(ExitCode::image, "cannot read " + picture.path.string());
        return read_bitmap(*file,
                           {picture.is_linear, picture.channel, limits_.texture_bytes / LoadLimits().texture_bytes});
    });
}

void SceneBuilder::count_texture_bytes(std::uint64_t words, const Location &location) {
    texture_bytes_ += words * sizeof(std::uint32_t);
    if (texture_bytes_ > limits_.texture_bytes)
        throw SceneError(location, fmt::format("the textures up to this one have more than {} MiB of pixels{}",
                                               limits_.texture_bytes >> 20, limits_hint));
}

std::shared_ptr<const Bitmap> SceneBuilder::bordered(const std::shared_ptr<const Bitmap> &inner,
                                                     const PictureBorder &border, const Location &location) {
    if (border == PictureBorder() || inner == stand_in_)
        return inner;
    std::shared_ptr<const Bitmap> &known = bordered_[{inner.get(), border}];
    if (!known) {
        const std::uint64_t texels = std::uint64_t(inner->width + border.columns()) * (inner->height + border.rows());
        count_texture_bytes(Bitmap::words_for(texels, inner->format, inner->is_color), location);
        known = std::make_shared<const Bitmap>(with_border(*inner, border));
    }
    return known;
}

std::shared_ptr<const Bitmap> SceneBuilder::bitmap(const Picture &picture, const Location &location, bool &is_srgb) {
    auto known = bitmaps_.find(picture);
    if (known == bitmaps_.end() && stand_in_) {
        is_srgb = false;
        return stand_in_;
    }
    if (known == bitmaps_.end()) {
        const Phase phase(phases_, phase_names::pictures);
        ReadBitmap read;
        try {
            read = pictures_ahead_->take(picture);
        } catch (const Error &error) {
            throw SceneError(location, error.what());
        }
        if (read.not_numbers > 0)
            diagnostics_.warn(location, fmt::format("{}: {} values that are no finite numbers become 0",
                                                    picture.path.string(), read.not_numbers));
        count_texture_bytes(read.bitmap.words.size(), location);
        known =
            bitmaps_
                .emplace(picture, DecodedBitmap{std::make_shared<const Bitmap>(std::move(read.bitmap)), read.is_srgb})
                .first;
    }
    is_srgb = known->second.is_srgb;
    return known->second.bitmap;
}

/// texture_range(), which goes over all texels of a picture, once for all textures that are alike in what it goes by.
TextureRange SceneBuilder::range_of(const Texture &texture) {
    if (texture.kind != Texture::Kind::bitmap)
        return texture_range(texture);
    const auto [known, is_new] =
        ranges_.try_emplace({texture.bitmap.get(), texture.is_srgb, texture.scale, texture.lowest, texture.highest});
    if (is_new)
        known->second = texture_range(texture);
    return known->second;
}

/// The same of a texture that is clamped nowhere, once for all scales.
TextureRange SceneBuilder::unclamped_range_of(Texture texture) {
    const std::array<float, 3> scale = std::exchange(texture.scale, {1, 1, 1});
    TextureRange range = range_of(texture);
    for (std::size_t c = 0; c < 3; ++c) {
        for (double *value : {&range.mean[c], &range.least[c], &range.most[c]})
            *value *= scale[c];
        if (scale[c] < 0)
            std::swap(range.least[c], range.most[c]);
    }
    return range;
}

FoundTexture SceneBuilder::texture(const Element &element, double lowest, double highest, StandsFor stands_for,
                                   OneColor one_color) {
    const auto key = std::make_tuple(&element, lowest, highest, stands_for, one_color);
    if (const auto known = textures_.find(key); known != textures_.end())
        return known->second;
    auto built = built_textures_.find(&element);
    if (built == built_textures_.end()) {
        try {
            built = built_textures_.emplace(&element, build_object<Texture>(element)).first;
        } catch (const SceneError &error) {
            built = built_textures_.emplace(&element, error).first;
        }
    }
    if (const auto *error = std::get_if<SceneError>(&built->second))
        throw *error;
    Texture texture = std::get<Texture>(built->second);
    if (stands_for == StandsFor::number) // a texture of one colour is a checkerboard, too
        for (std::array<float, 3> *color : {&texture.color_0, &texture.color_1})
            color->fill(((*color)[0] + (*color)[1] + (*color)[2]) / 3);
    texture.name = element.attribute_or("id", element.attribute_or("type", "") + " at " + element.location.text());
    texture.lowest = std::numeric_limits<float>::lowest();
    texture.highest = std::numeric_limits<float>::max();
    FoundTexture found;
    found.range = unclamped_range_of(texture);
    const double least = *std::min_element(found.range.least.begin(), found.range.least.end());
    const double most = *std::max_element(found.range.most.begin(), found.range.most.end());
    texture.lowest = float(lowest);
    texture.highest = float(highest);
    constexpr double not_worth_a_word = 1e-3;
    if (least < lowest || most > highest) {
        const bool is_known =
            texture.kind != Texture::Kind::mesh_attribute && !(stand_in_ && texture.bitmap == stand_in_);
        if (is_known && (least < lowest - not_worth_a_word || most > highest + not_worth_a_word))
            diagnostics_.warn(element.location,
                              fmt::format("the texture has values from {:.4g} to {:.4g}; they are clamped to {:.4g} to "
                                          "{:.4g}",
                                          least, most, lowest, highest));
        found.range = range_of(texture);
    }
    const bool is_one_color = texture.kind == Texture::Kind::checkerboard && found.range.least == found.range.most;
    if (is_one_color && one_color == OneColor::is_no_texture) {
        textures_.emplace(key, found);
        return found;
    }
    found.index = std::int32_t(scene_.textures.size());
    scene_.textures.push_back(std::move(texture));
    textures_.emplace(key, found);
    return found;
}

/// Pictures are not read for it.
void SceneBuilder::check_unused_texture(const Element &element) {
    if (!built_textures_.contains(&element) && !find_plugin<Texture>(type_of(element)))
        diagnostics_.warn(element.location, "unused texture: " + unknown_plugin("texture", type_of(element)));
}

std::int32_t SceneBuilder::scaled(std::int32_t index, float factor) {
    if (factor == 1)
        return index;
    Texture texture = texture_at(index);
    for (float &scale : texture.scale)
        scale *= factor;
    texture.lowest *= factor; // it is clamped before it is scaled
    texture.highest *= factor;
    scene_.textures.push_back(std::move(texture));
    return std::int32_t(scene_.textures.size()) - 1;
}

/// Before shapes are read: of a texture that names a mesh attribute, the name.
void SceneBuilder::want_attribute(const Element &texture) {
    const std::string type(trimmed(texture.attribute_or("type", "")));
    std::string name = type == "vertexcolors" ? "vertex_color" : "";
    for (const Element &child : texture.children)
        if (type == "mesh_attribute" && trimmed(child.attribute_or("name", "")) == "name")
            name = std::string(trimmed(child.attribute_or("value", "")));
    if (!name.empty())
        wanted_attributes_.insert(name);
}

/// Numbers that are none become 0.
void SceneBuilder::settle_attributes(Mesh &mesh, const std::string &name, const Location &location) {
    std::size_t changed = 0;
    for (MeshAttribute &attribute : mesh.attributes)
        for (float &value : attribute.values)
            if (!std::isfinite(value)) {
                value = 0;
                ++changed;
            }
    if (changed > 0)
        diagnostics_.warn(
            location,
            fmt::format("shape \"{}\": {} values of attributes that are no finite numbers become 0", name, changed));
}

/// mesh: that of the shape, nullptr of a sphere.
void SceneBuilder::check_attributes(const Shape &shape, const Mesh *mesh, const Location &location) const {
    for_each_texture(scene_, shape, [&](std::int32_t number) {
        const Texture &texture = scene_.textures[std::size_t(number)];
        if (texture.kind == Texture::Kind::mesh_attribute && (!mesh || !find_attribute(*mesh, texture.attribute)))
            throw SceneError(location, "shape \"" + shape.name + "\" has no attribute \"" + texture.attribute +
                                           "\", which its texture \"" + texture.name + "\" reads");
    });
}

} // namespace gradus
