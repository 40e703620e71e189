// The scene's tables on the device.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/program.h"
#include "runtime/scene/scene_tables.h"

#include <vector>

namespace gradus {

struct SceneBuffers {
    SceneBuffers(Device &device, const SceneTables &tables, Precision precision);

    /// Gives a kernel every scene buffer and number that it asks for by name.
    void bind(Kernel &kernel) const;

  private:
    std::vector<Buffer> buffers_;
    std::uint32_t triangle_count_, light_count_, environment_light_;
    float scene_diameter_;
};

} // namespace gradus
