#include "runtime/io/plugins/parameters_of_maps.h"

#include <limits>

namespace gradus {

ParameterList parameters_of_maps() {
    // The program of 0.x files has neither.
    return {{"bsdf", Takes::objects, nullptr, "one"},
            Parameter{"flip_invalid_normals", Takes::boolean, "true",
                      "normals that the eye would see from behind are turned"}
                .before_2("false"),
            Parameter{"use_shadowing_function", Takes::boolean, "true", "grazing light is dimmed"}.before_2("false")};
}

Material read_mapped(Properties &properties, SceneBuilder &builder, NormalTexture::Kind kind) {
    const auto nested = properties.objects("bsdf");
    const auto textures = properties.objects("texture");
    if (nested.size() != 1)
        throw SceneError(properties.location(),
                         properties.type() + " needs one nested BSDF, not " + std::to_string(nested.size()));
    if (textures.size() != 1)
        throw SceneError(properties.location(),
                         properties.type() + " needs one nested texture, not " + std::to_string(textures.size()));
    NormalTexture map;
    map.kind = kind;
    map.turns_over = properties.boolean("flip_invalid_normals");
    map.shadows = properties.boolean("use_shadowing_function");
    if (kind == NormalTexture::Kind::bump)
        map.scale = float(properties.number("scale"));
    const FoundTexture found = builder.texture(*textures.front().element, std::numeric_limits<float>::lowest(),
                                               std::numeric_limits<float>::max());
    map.texture = found.index;
    const Texture &texture = builder.texture_at(found.index);
    if (kind == NormalTexture::Kind::bump && texture.kind == Texture::Kind::mesh_attribute)
        throw SceneError(textures.front().location,
                         "a bump map cannot be a mesh attribute, which has no slope in (u, v)");
    if (kind == NormalTexture::Kind::bump && (texture.kind != Texture::Kind::bitmap || texture.is_nearest))
        properties.diagnostics().warn(textures.front().location,
                                      "a texture in steps has no slope: as a bump map it turns no normals");
    if (kind == NormalTexture::Kind::normal && texture.is_srgb)
        properties.diagnostics().warn(textures.front().location,
                                      "the normal map is decoded from sRGB; nearly all are meant to be read raw");
    return builder.with_map(builder.build_object<Material>(*nested.front().element), map, nested.front().location);
}

} // namespace gradus
