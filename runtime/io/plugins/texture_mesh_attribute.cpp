// <texture type="mesh_attribute">: numbers that a mesh bears at its vertices, interpolated, or by face.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_mesh_attribute() {
    return {"numbers that a mesh bears. A shape that lacks them is an error",
            {Parameter{"name", Takes::string, nullptr, "begins with `vertex_` (interpolated) or `face_`"}.required(),
             Parameter{"scale", Takes::number, "1", "what they are times"}.at_least(0).at_most(1e30)}};
}

Texture texture_mesh_attribute(Properties &properties, SceneBuilder &) {
    Texture texture;
    texture.kind = Texture::Kind::mesh_attribute;
    texture.attribute = properties.string("name");
    if (!texture.attribute.starts_with("vertex_") && !texture.attribute.starts_with("face_"))
        throw properties.error("name", "the name of a mesh attribute begins with vertex_ or face_, not as in \"" +
                                           texture.attribute + "\"");
    const auto scale = float(properties.number("scale"));
    texture.scale = {scale, scale, scale};
    return texture;
}

} // namespace gradus
