// <shape type="merge">: shapes in a shape, which render as they would by themselves.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_merge() {
    return {"shapes that count as if they stood by themselves", {{"shape", Takes::objects, nullptr, "any number"}}};
}

ShapeGeometry shape_merge(Properties &properties, SceneBuilder &) {
    ShapeGroup group;
    for (const NestedObject &shape : properties.objects("shape"))
        group.shapes.push_back(shape.element);
    return group;
}

} // namespace gradus
