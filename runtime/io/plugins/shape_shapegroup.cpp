// <shape type="shapegroup">: shapes that are seen where instances of the group are.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_shapegroup() {
    return {
        "shapes that are seen where instances of the group are; emitters among them shine from each. None in groups",
        {{"shape", Takes::objects, nullptr, "any number"}}};
}

ShapeGeometry shape_shapegroup(Properties &, SceneBuilder &) { return ShapeGroup(); }

} // namespace gradus
