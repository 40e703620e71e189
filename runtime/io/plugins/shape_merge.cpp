// <shape type="merge">: shapes in a shape, which render as they would by themselves.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_merge(Properties &properties, SceneBuilder &) {
    ShapeGroup group;
    for (const Properties::Object &shape : properties.objects("shape"))
        group.shapes.push_back(shape.element);
    return group;
}

} // namespace gradus
