// Rays of the camera that the host traces by itself.
#pragma once

#define TRAIT_ORTHOGRAPHIC 1
#define TRAIT_THIN_LENS 1
#define TRAIT_NEAR_CLIP 1
#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#include "kernels/lib/camera_ray.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/tables.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/trace/tracer.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus {

/// Of the full film, in pixels from its top left; of the lens, by two numbers in [0, 1).
struct CameraPlace {
    float x = 0, y = 0, lens_1 = 0, lens_2 = 0;
};

class CameraRays {
  public:
    /// Traces `count` rays: ray i goes through place(i). Returns how many were traced.
    template <class Place>
    std::uint64_t trace(const SceneTables &tables, Tracer &tracer, std::size_t count, const Place &place) {
        for (std::vector<float> &column : columns_)
            column.resize(count);
        primitive_.assign(count, ray_pending);
        instance_.assign(count, tables.no_instance);
        tracer.in_parallel(count, [&](std::size_t begin, std::size_t end) {
            using namespace lib_float;
            const float *camera = tables.camera.data();
            for (std::size_t i = begin; i < end; ++i) {
                const auto film = place(i);
                const camera_sight sight = camera_sight_through(camera, unit, film.x, film.y, film.lens_1, film.lens_2);
                const float values[] = {sight.origin.x,    sight.origin.y,    sight.origin.z,
                                        sight.direction.x, sight.direction.y, sight.direction.z};
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
        columns.instance = instance_.data();
        const std::uint64_t traced = tracer.trace(columns, count, ShadowColumns{}, 0).extension;
        if (tables.camera_clips.far_clip)
            clip(tables, count);
        return traced;
    }

    std::uint32_t primitive(std::size_t ray) const { return primitive_[ray]; } ///< or ray_escaped
    lib_float::vec3 origin(std::size_t ray) const {
        return lib_float::v3(columns_[0][ray], columns_[1][ray], columns_[2][ray]);
    }
    lib_float::vec3 direction(std::size_t ray) const {
        return lib_float::v3(columns_[3][ray], columns_[4][ray], columns_[5][ray]);
    }
    /// How far from the camera a ray begins.
    float way_before(const SceneTables &tables, std::size_t ray) const {
        return lib_float::camera_way(tables.camera.data(), unit, direction(ray));
    }
    /// Where a ray met that primitive; not of one that escaped.
    lib_float::primitive_hit hit(const SceneTables &tables, std::size_t ray) const {
        using namespace lib_float;
        const std::uint32_t number = primitive_[ray];
        if (number < tables.triangle_count) {
            const TableTriangle t = tables.triangle(number, instance_[ray]);
            const auto vector = [](const std::array<float, 3> &a) { return v3(a[0], a[1], a[2]); };
            return triangle_hit(vector(t.p0), vector(t.e1), vector(t.e2), origin(ray), direction(ray));
        }
        const std::uint32_t sphere = number - tables.triangle_count;
        const float *spheres = tables.spheres.data();
        return sphere_hit(FIELD_V3(sphere, spheres, sphere, center), FIELD_OF(sphere, spheres, sphere, radius),
                          FIELD_OF(sphere, spheres, sphere, facing), origin(ray), direction(ray));
    }

  private:
    /// What was met beyond the far plane is not seen.
    void clip(const SceneTables &tables, std::size_t count) {
        using namespace lib_float;
        const float *camera = tables.camera.data();
        for (std::size_t i = 0; i < count; ++i) {
            if (primitive_[i] >= ray_first_special)
                continue;
            const float depth =
                v3_dot(v3_sub(hit(tables, i).position, origin(i)), FIELD_V3(camera, camera, 0, forward));
            if (depth + camera[camera_near_clip] > camera[camera_far_clip])
                primitive_[i] = ray_escaped;
        }
    }

    static constexpr std::uint32_t unit = 1; // of FIELD_OF

    std::vector<float> columns_[6];
    std::vector<std::uint32_t> primitive_, instance_;
};

} // namespace gradus
