// <shape type="instance">: the shapes of a shapegroup, nested or by <ref>, once more.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_instance() {
    return {"the shapes of a shapegroup, nested or by `<ref>`, once more; kept as instances where copies would "
            "be large. None in groups",
            {{"to_world", Takes::transform, nullptr,
              "after those of the shapes; normals are mapped as normals, so that a mirror turns no front"},
             {"shape", Takes::objects, nullptr, "the shapegroup"}}};
}

ShapeGeometry shape_instance(Properties &properties, SceneBuilder &) {
    const std::vector<NestedObject> shapes = properties.objects("shape");
    if (shapes.size() != 1)
        throw SceneError(properties.location(), "an instance needs one shapegroup");
    const Element &instanced = *shapes.front().element;
    if (type_of(instanced) != "shapegroup")
        throw SceneError(shapes.front().location,
                         "an instance is of a shapegroup, not of a shape of type \"" + type_of(instanced) + "\"");
    ShapeGroup group;
    group.instanced = &instanced;
    group.to_world = properties.transform("to_world");
    group.location = properties.location_of("to_world");
    return group;
}

} // namespace gradus
