// <shape type="shapegroup">: shapes that are seen where instances of the group are.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_shapegroup(Properties &properties, SceneBuilder &) {
    properties.objects("shape");
    return ShapeGroup();
}

} // namespace gradus
