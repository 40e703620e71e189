#include "runtime/stages/scene_buffers.h"

namespace gradus {

SceneBuffers::SceneBuffers(Device &device, const SceneTables &t, Precision precision)
    : triangle_count_(t.triangle_count), light_count_(t.light_count), environment_light_(t.environment_light),
      scene_diameter_(t.scene_diameter) {
    const auto reals = [&](const char *name, const std::vector<float> &values) {
        if (precision == Precision::double_) {
            const std::vector<double> wide(values.begin(), values.end());
            buffers_.emplace_back(device, name, wide.data(), wide.size() * sizeof(double));
        } else {
            buffers_.emplace_back(device, name, values.data(), values.size() * sizeof(float));
        }
    };
    const auto numbers = [&](const char *name, const std::vector<std::uint32_t> &values) {
        buffers_.emplace_back(device, name, values.data(), values.size() * sizeof(std::uint32_t));
    };
    reals("triangles", t.triangles);
    reals("triangle_normals", t.triangle_normals);
    reals("triangle_tangents", t.triangle_tangents);
    reals("spheres", t.spheres);
    reals("materials", t.materials);
    reals("lights", t.lights);
    reals("camera", t.camera);
    numbers("primitive_material", t.primitive_material);
    numbers("primitive_light", t.primitive_light);
    numbers("primitive_bin", t.primitive_bin);
    numbers("primitive_back_bin", t.primitive_back_bin);
    numbers("material_back", t.material_back);
    numbers("light_kinds", t.light_kinds);
    numbers("light_alias", t.light_alias);
}

void SceneBuffers::bind(Kernel &kernel) const {
    for (const Buffer &buffer : buffers_)
        kernel.bind(buffer);
    kernel.set("unit", 1);
    kernel.set("triangle_count", triangle_count_);
    kernel.set("light_count", light_count_);
    kernel.set("environment_light", environment_light_);
    kernel.set_real("scene_diameter", scene_diameter_);
}

} // namespace gradus
