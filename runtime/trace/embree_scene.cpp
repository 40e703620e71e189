#include "runtime/trace/embree_scene.h"

#include "runtime/error.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/long_triangles.h"
#include "runtime/trace/flush_denormals.h"
#include "runtime/trace/ray_packets.h"
#include "runtime/trace/sphere_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/tables.h"

namespace gradus {

namespace {

/// Up to here sixteen rays are tested against a sphere at once: in a scene of 4 spheres tracing takes 0.4 of the time
/// of Embree's own ones, of 32 0.47, of 256 0.96, of 4096 1.3, where packets come apart.
constexpr std::size_t most_spheres_by_packet = 256;

/// Embree's filter of hits with what rays may pass.
void drop_passed(const RTCFilterFunctionNArguments *hits) {
    const auto &opacity = *static_cast<const Opacity *>(hits->geometryUserPtr);
    const auto &context = *reinterpret_cast<const TraceContext *>(hits->context);
    RTCRayN *rays = hits->ray;
    for (unsigned lane = 0; lane < hits->N; ++lane) {
        if (hits->valid[lane] == 0)
            continue;
        const Vector3 origin{RTCRayN_org_x(rays, hits->N, lane), RTCRayN_org_y(rays, hits->N, lane),
                             RTCRayN_org_z(rays, hits->N, lane)};
        const Vector3 direction{RTCRayN_dir_x(rays, hits->N, lane), RTCRayN_dir_y(rays, hits->N, lane),
                                RTCRayN_dir_z(rays, hits->N, lane)};
        const unsigned number = RTCHitN_primID(hits->hit, hits->N, lane);
        const float outward = direction.x * RTCHitN_Ng_x(hits->hit, hits->N, lane) +
                              direction.y * RTCHitN_Ng_y(hits->hit, hits->N, lane) +
                              direction.z * RTCHitN_Ng_z(hits->hit, hits->N, lane);
        if (!opacity.has_side(number, outward) || (context.passes_emitters && opacity.emits(number)) ||
            !opacity.is_met(number, origin, direction, context.without_chance))
            hits->valid[lane] = 0;
    }
}

/// Calls visit(shape, number of its first primitive) for the shapes of that kind that are passable, or those that
/// aren't.
template <class Visit>
void for_each_shape(const Scene &s, Shape::Kind kind, std::uint32_t first, bool are_passable, Visit visit) {
    for (const Shape &shape : s.shapes) {
        if (shape.kind != kind)
            continue;
        if (shape.group == no_group && is_asked_about(s, shape) == are_passable)
            visit(shape, first);
        first += kind == Shape::Kind::sphere ? 1u : std::uint32_t(s.meshes[shape.geometry].triangles.size());
    }
}

} // namespace

EmbreeScene::EmbreeScene(const Scene &s, int threads, tbb::task_arena &arena, const SceneTables *tables) {
    flush_denormals();
    device_.reset(rtcNewDevice(threads > 0 ? fmt::format("threads={},set_affinity=0", threads).c_str() : nullptr));
    if (!device_)
        throw rtcGetDeviceError(nullptr) == RTC_ERROR_UNSUPPORTED_CPU
            ? Error(ExitCode::failure, "Embree does not start on this processor")
            : Error(ExitCode::device,
                    "Embree does not start: there is not enough memory, or there are too many threads");
    rtcSetDeviceMemoryMonitorFunction(
        device_.get(),
        [](void *user, ssize_t bytes, bool) {
            static_cast<std::atomic<long long> *>(user)->fetch_add(bytes);
            return true;
        },
        &bytes_);
    arena.execute([&] {
        // Robust tests cost a tenth of tracing and more.
        flags_ = has_long_triangles(s) ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE;
        scene_ = new_scene();
        add_geometry(s, tables);
        rtcCommitScene(scene_.get());
    });
    check("building the acceleration structure");
    RTCBounds bounds;
    rtcGetSceneBounds(scene_.get(), &bounds);
    low_ = {bounds.lower_x, bounds.lower_y, bounds.lower_z};
    high_ = {bounds.upper_x, bounds.upper_y, bounds.upper_z};
}

std::unique_ptr<RTCSceneTy, EmbreeScene::Release> EmbreeScene::new_scene() const {
    std::unique_ptr<RTCSceneTy, Release> scene(rtcNewScene(device_.get()));
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene.get(), flags_);
    return scene;
}

float EmbreeScene::opacity_of(unsigned instance, unsigned geometry, unsigned number, const Vector3 &origin,
                              const Vector3 &direction) const {
    if (instance == RTC_INVALID_GEOMETRY_ID)
        return geometry < passable_triangles ? 1
                                             : passable_[geometry - passable_triangles].at(number, origin, direction);
    const std::size_t placed = instance - first_instance;
    const PassableShape *shape = groups_[group_of_[placed]].passable[geometry].get();
    return shape ? shape->opacity.at(number, origin, direction, matrix_of(instances_[placed])) : 1;
}

void EmbreeScene::check(const char *doing) {
    const RTCError error = rtcGetDeviceError(device_.get());
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw Error(ExitCode::device, fmt::format("{}: out of memory", doing));
    if (error != RTC_ERROR_NONE)
        throw Error(ExitCode::failure, fmt::format("{}: Embree error {}", doing, static_cast<int>(error)));
}

template <class Element>
Element *EmbreeScene::new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count) {
    // Embree reads 16 bytes at each vertex, so it wants padding after the last.
    void *data = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Element), count);
    check("allocating geometry");
    return static_cast<Element *>(data);
}

void EmbreeScene::attach(RTCGeometry geometry, Geometry place) {
    rtcSetGeometryMask(geometry, 0xFFFFFFFFu);
    if (place >= passable_triangles) {
        rtcSetGeometryUserData(geometry, &passable_[place - passable_triangles]);
        rtcSetGeometryIntersectFilterFunction(geometry, drop_passed);
        rtcSetGeometryOccludedFilterFunction(geometry, drop_passed);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, place);
    rtcReleaseGeometry(geometry);
    check("building geometry");
}

void EmbreeScene::name(const Scene &s, const Shape &shape, std::size_t triangle, std::uint32_t number, Geometry place) {
    if (place >= passable_triangles)
        passable_[place - passable_triangles].add(s, shape, triangle, number);
    else if (some_are_passable_ || !groups_.empty())
        numbers_[place].push_back(number);
}

void EmbreeScene::add_triangles(const Scene &s, Geometry place) {
    const auto for_each_mesh = [&](auto visit) {
        for_each_shape(s, Shape::Kind::mesh, 0, place == passable_triangles,
                       [&](const Shape &shape, std::uint32_t first) { visit(shape, s.meshes[shape.geometry], first); });
    };
    std::size_t vertex_count = 0, triangle_count = 0;
    for_each_mesh([&](const Shape &, const Mesh &mesh, std::uint32_t) {
        vertex_count += mesh.positions.size();
        triangle_count += mesh.triangles.size();
    });
    if (triangle_count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *vertices = new_buffer<Vector3>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertex_count);
    auto *indices =
        new_buffer<std::array<std::uint32_t, 3>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangle_count);
    std::uint32_t first_vertex = 0;
    for_each_mesh([&](const Shape &shape, const Mesh &mesh, std::uint32_t number) {
        vertices = std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto &t = mesh.triangles[i];
            *indices++ = {first_vertex + t[0], first_vertex + t[1], first_vertex + t[2]};
            name(s, shape, i, number + std::uint32_t(i), place);
        }
        first_vertex += static_cast<std::uint32_t>(mesh.positions.size());
    });
    attach(geometry, place);
}

void EmbreeScene::add_shared_triangles(const Scene &s, const SceneTables &tables, Geometry place) {
    const auto for_each_mesh = [&](auto visit) {
        for_each_shape(s, Shape::Kind::mesh, 0, place == passable_triangles,
                       [&](const Shape &shape, std::uint32_t first) {
                           visit(shape, s.meshes[shape.geometry].triangles.size(), first);
                       });
    };
    std::size_t triangle_count = 0;
    for_each_mesh([&](const Shape &, std::size_t count, std::uint32_t) { triangle_count += count; });
    if (triangle_count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t numbers = tables.vertex_numbers;
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, tables.triangles.data(), 0,
                               numbers * sizeof(float), tables.end_vertex);
    using Corners = std::array<std::uint32_t, 3>;
    if (triangle_count == triangles_) {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, tables.triangles.data(), 0,
                                   sizeof(Corners), triangle_count);
    } else {
        auto *indices = new_buffer<Corners>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangle_count);
        for_each_mesh([&](const Shape &, std::size_t count, std::uint32_t first) {
            std::memcpy(indices, &tables.triangles[std::size_t(first) * 3], count * sizeof(Corners));
            indices += count;
        });
    }
    check("sharing geometry");
    if (some_are_passable_ || !groups_.empty())
        for_each_mesh([&](const Shape &shape, std::size_t count, std::uint32_t first) {
            for (std::size_t i = 0; i < count; ++i)
                name(s, shape, i, first + std::uint32_t(i), place);
        });
    attach(geometry, place);
}

void EmbreeScene::add_spheres(const Scene &s, Geometry place) {
    const auto for_each_sphere = [&](auto visit) {
        for_each_shape(s, Shape::Kind::sphere, triangles_, place == passable_spheres, visit);
    };
    std::size_t count = 0;
    for_each_sphere([&](const Shape &, std::uint32_t) { ++count; });
    if (count == 0)
        return;
    const bool by_packet = place == opaque_spheres && count <= most_spheres_by_packet;
    RTCGeometry geometry = nullptr;
    TracedSphere *records = nullptr;
    if (by_packet) {
        traced_spheres_.resize(count);
        records = traced_spheres_.data();
        geometry = new_sphere_geometry(device_.get(), records, unsigned(count));
    } else {
        geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
        records = new_buffer<TracedSphere>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, count);
    }
    for_each_sphere([&](const Shape &shape, std::uint32_t number) {
        const Sphere &sphere = s.spheres[shape.geometry];
        *records++ = {{sphere.center.x, sphere.center.y, sphere.center.z}, sphere.radius};
        name(s, shape, 0, number, place);
    });
    attach(geometry, place);
}

RTCGeometry EmbreeScene::new_triangles(const Mesh &mesh, std::uint32_t first, const SceneTables *tables) {
    using Corners = std::array<std::uint32_t, 3>;
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    if (tables && tables->is_indexed()) {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, tables->triangles.data(), 0,
                                   tables->vertex_numbers * sizeof(float), tables->end_vertex);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, tables->triangles.data(),
                                   first * sizeof(Corners), sizeof(Corners), mesh.triangles.size());
        check("sharing geometry");
        return geometry;
    }
    auto *vertices = new_buffer<Vector3>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions.size());
    std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
    auto *indices = new_buffer<Corners>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles.size());
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    return geometry;
}

/// As drop_passed, of shapes in groups.
void EmbreeScene::drop_passed_in_instance(const RTCFilterFunctionNArguments *hits) {
    const auto &shape = *static_cast<const PassableShape *>(hits->geometryUserPtr);
    const auto &context = *reinterpret_cast<const TraceContext *>(hits->context);
    for (unsigned lane = 0; lane < hits->N; ++lane) {
        if (hits->valid[lane] == 0)
            continue;
        const unsigned ray = RTCRayN_id(hits->ray, hits->N, lane);
        const std::size_t row = context.rows ? context.rows[ray] : ray;
        const unsigned instance = RTCHitN_instID(hits->hit, hits->N, lane, 0) - first_instance;
        if (!shape.opacity.is_met(RTCHitN_primID(hits->hit, hits->N, lane), axis_values(context.origin, row),
                                  axis_values(context.direction, row), context.without_chance, instance + 1,
                                  matrix_of(shape.scene->instances_[instance])))
            hits->valid[lane] = 0;
    }
}

/// Acceleration structures of groups, in their own frames.
void EmbreeScene::add_groups(const Scene &s, const SceneTables *tables) {
    std::uint32_t first = 0;
    for (Group &group : groups_)
        group.scene = new_scene();
    for (const Shape &shape : s.shapes) {
        if (shape.kind != Shape::Kind::mesh)
            continue;
        const Mesh &mesh = s.meshes[shape.geometry];
        if (shape.group != no_group) {
            Group &group = groups_[std::size_t(shape.group)];
            RTCGeometry geometry = new_triangles(mesh, first, tables);
            rtcSetGeometryMask(geometry, 0xFFFFFFFFu);
            group.passable.emplace_back();
            if (is_passable(s, shape)) {
                group.passable.back() = std::make_unique<PassableShape>(PassableShape{this, {}});
                for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
                    group.passable.back()->opacity.add(s, shape, i, first + std::uint32_t(i));
                rtcSetGeometryUserData(geometry, group.passable.back().get());
                rtcSetGeometryIntersectFilterFunction(geometry, drop_passed_in_instance);
                rtcSetGeometryOccludedFilterFunction(geometry, drop_passed_in_instance);
            }
            rtcCommitGeometry(geometry);
            rtcAttachGeometryByID(group.scene.get(), geometry, unsigned(group.first.size()));
            rtcReleaseGeometry(geometry);
            check("building geometry");
            group.first.push_back(first);
        }
        first += std::uint32_t(mesh.triangles.size());
    }
    for (Group &group : groups_) {
        rtcCommitScene(group.scene.get());
        check("building the acceleration structure of a group");
    }
}

void EmbreeScene::add_instances(const Scene &s) {
    group_of_.reserve(s.instances.size());
    for (const Instance &instance : s.instances) {
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, groups_[instance.group].scene.get());
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance.to_world.data());
        rtcSetGeometryMask(geometry, 0xFFFFFFFFu);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_.get(), geometry, first_instance + unsigned(group_of_.size()));
        rtcReleaseGeometry(geometry);
        group_of_.push_back(instance.group);
    }
    check("adding instances");
}

void EmbreeScene::add_geometry(const Scene &s, const SceneTables *tables) {
    groups_.resize(s.groups);
    hides_emitters_ = s.settings.hide_emitters;
    bool some_are_passable_in_groups = false;
    std::size_t vertex_count = 0, triangle_count = 0;
    for (const Shape &shape : s.shapes) {
        some_are_passable_ |= is_asked_about(s, shape);
        some_are_passable_in_groups |= shape.group != no_group && is_passable(s, shape);
        if (shape.kind == Shape::Kind::mesh) {
            vertex_count += s.meshes[shape.geometry].positions.size();
            triangle_count += s.meshes[shape.geometry].triangles.size();
        }
    }
    if (triangle_count + s.spheres.size() >= ray_first_special || vertex_count >= 0xFFFFFFFFu)
        throw Error(ExitCode::scene, "the scene has more primitives than 32-bit indices can name");
    triangles_ = static_cast<std::uint32_t>(triangle_count);
    spheres_ = static_cast<std::uint32_t>(s.spheres.size());
    const auto add_meshes = [&](Geometry place) {
        if (tables && tables->is_indexed())
            add_shared_triangles(s, *tables, place);
        else
            add_triangles(s, place);
    };
    add_meshes(opaque_triangles);
    add_spheres(s, opaque_spheres);
    add_meshes(passable_triangles);
    add_spheres(s, passable_spheres);
    if (s.instances.empty())
        return;
    no_instance_ = tables ? tables->no_instance : 0;
    if (some_are_passable_in_groups)
        instances_ = s.instances;
    add_groups(s, tables);
    add_instances(s);
}

} // namespace gradus
