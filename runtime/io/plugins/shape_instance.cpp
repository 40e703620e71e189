// <shape type="instance">: the shapes of a shapegroup, nested or by <ref>, once more.
//   to_world, applied after those of the shapes; normals are mapped as normals, so that a mirror turns no front
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_instance(Properties &properties, SceneBuilder &builder) {
    const std::vector<Properties::Object> shapes = properties.objects("shape");
    if (shapes.size() != 1)
        throw SceneError(properties.location(), "an instance needs one shapegroup");
    Properties inner(*shapes.front().element, builder.resolver(), properties.diagnostics());
    if (inner.type() != "shapegroup")
        throw SceneError(shapes.front().location,
                         "an instance is of a shapegroup, not of a shape of type \"" + inner.type() + "\"");
    ShapeGroup group;
    for (const Properties::Object &shape : inner.objects("shape"))
        group.shapes.push_back(shape.element);
    group.instanced = shapes.front().element;
    group.to_world = properties.transform("to_world");
    group.location = properties.location();
    return group;
}

} // namespace gradus
