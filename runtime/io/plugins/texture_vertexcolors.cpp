// <texture type="vertexcolors"> (0.x): the colours that a mesh bears at its vertices, interpolated.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_vertexcolors() { return {"the attribute `vertex_color` of a mesh, of 0.x", {}}; }

Texture texture_vertexcolors(Properties &, SceneBuilder &) {
    Texture texture;
    texture.kind = Texture::Kind::mesh_attribute;
    texture.attribute = "vertex_color";
    return texture;
}

} // namespace gradus
