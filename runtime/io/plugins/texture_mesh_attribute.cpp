// <texture type="mesh_attribute">: numbers that a mesh bears at its vertices, interpolated, or by face.
//   name  vertex_color, face_color or another that begins with vertex_ or face_; scale (1)
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Texture texture_mesh_attribute(Properties &properties, SceneBuilder &) {
    Texture texture;
    texture.kind = Texture::Kind::mesh_attribute;
    texture.attribute = properties.string("name", "");
    if (texture.attribute.empty())
        throw properties.error("name", "a mesh_attribute needs the name of an attribute, as vertex_color");
    if (!texture.attribute.starts_with("vertex_") && !texture.attribute.starts_with("face_"))
        throw properties.error("name", "the name of a mesh attribute begins with vertex_ or face_, not as in \"" +
                                           texture.attribute + "\"");
    const auto scale = float(properties.number("scale", 1, 0, 1e30));
    texture.scale = {scale, scale, scale};
    return texture;
}

} // namespace gradus
