// Rays of the camera that the host traces by itself.
#pragma once

#include "kernels/lib/camera_ray.h"
#include "kernels/shared/tables.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/trace/tracer.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus {

class CameraRays {
  public:
    /// Traces `count` rays: ray i goes through the point place(i), x and y, of the full film in pixels. Returns how
    /// many were traced.
    template <class Place>
    std::uint64_t trace(const SceneTables &tables, Tracer &tracer, std::size_t count, const Place &place) {
        for (std::vector<float> &column : columns_)
            column.resize(count);
        primitive_.assign(count, ray_pending);
        tracer.in_parallel(count, [&](std::size_t begin, std::size_t end) {
            using namespace lib_float;
            const float *camera = tables.camera.data();
            for (std::size_t i = begin; i < end; ++i) {
                const auto film = place(i);
                const vec3 direction = camera_direction(camera, unit, film.x, film.y);
                const float values[] = {camera[camera_origin_x],
                                        camera[camera_origin_y],
                                        camera[camera_origin_z],
                                        direction.x,
                                        direction.y,
                                        direction.z};
                for (int column = 0; column < 6; ++column)
                    columns_[column][i] = values[column];
            }
        });
        RayColumns columns{};
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = columns_[axis].data();
            columns.direction[axis] = columns_[3 + axis].data();
        }
        columns.primitive = primitive_.data();
        return tracer.trace(columns, count, ShadowColumns{}, 0).extension;
    }

    std::uint32_t primitive(std::size_t ray) const { return primitive_[ray]; } ///< or ray_escaped
    lib_float::vec3 origin(std::size_t ray) const {
        return lib_float::v3(columns_[0][ray], columns_[1][ray], columns_[2][ray]);
    }
    lib_float::vec3 direction(std::size_t ray) const {
        return lib_float::v3(columns_[3][ray], columns_[4][ray], columns_[5][ray]);
    }

  private:
    static constexpr std::uint32_t unit = 1; // of FIELD_OF

    std::vector<float> columns_[6];
    std::vector<std::uint32_t> primitive_;
};

} // namespace gradus
