// Groups of shapes that a scene has at several places: which maps will do, and what lies where.
#pragma once

#include "runtime/scene/bounds.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

#include <cstddef>
#include <vector>

namespace gradus {

struct SceneTables;

/// The map of an instance, or nothing it may be: whether it can be undone in single precision. Others are for copies.
bool can_be_instance(const Matrix4 &to_world);
/// Whether the map can be undone at all.
bool is_invertible(const Matrix4 &to_world);

Matrix4 matrix_of(const Instance &instance);
Instance make_instance(std::uint32_t group, const Matrix4 &to_world);

/// By group, in its frame.
std::vector<Bounds> group_bounds(const Scene &scene);
/// Around what the map makes of a box.
Bounds placed_bounds(const Bounds &box, const Matrix4 &to_world);
/// Around all that can be hit, in the world.
Bounds world_bounds(const Scene &scene);

/// Records of kernels/shared/scene_records.h, that of no instance before them.
void put_instances(const Scene &scene, float *records);

} // namespace gradus
