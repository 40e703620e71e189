// The primitives of a scene in Embree's acceleration structure.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/trace/embree.h"
#include "runtime/trace/opacity.h"
#include "runtime/trace/sphere_geometry.h"

#include <tbb/task_arena.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gradus {

/// A row of three columns.
inline Vector3 axis_values(const float *const (&columns)[3], std::size_t row) {
    return {columns[0][row], columns[1][row], columns[2][row]};
}

class EmbreeScene {
  public:
    /// As Tracer's. Builds on the threads of `arena`.
    EmbreeScene(const Scene &scene, int threads, tbb::task_arena &arena, const SceneTables *tables = nullptr);

    RTCScene handle() const { return scene_.get(); }
    /// Which primitive of the scene was hit, by the geometry and the number that Embree knows it by.
    std::uint32_t primitive_of(unsigned instance, unsigned geometry, unsigned number) const {
        if (instance != RTC_INVALID_GEOMETRY_ID)
            return groups_[group_of_[instance - first_instance]].first[geometry] + number;
        if (geometry >= passable_triangles)
            return passable_[geometry - passable_triangles].primitive(number);
        const std::vector<std::uint32_t> &named = numbers_[geometry];
        return !named.empty() ? named[number] : geometry == opaque_triangles ? number : triangles_ + number;
    }
    /// Of what a ray has hit. Groups have triangles alone.
    static bool is_triangle(unsigned instance, unsigned geometry) {
        return instance != RTC_INVALID_GEOMETRY_ID || geometry == opaque_triangles || geometry == passable_triangles;
    }
    /// Of what a ray has hit, as primitive_of(): the share of such rays that meet it there.
    float opacity_of(unsigned instance, unsigned geometry, unsigned number, const Vector3 &origin,
                     const Vector3 &direction) const;
    /// RayColumns::instance
    std::uint32_t instance_record(unsigned instance) const {
        return instance == RTC_INVALID_GEOMETRY_ID ? no_instance_ : no_instance_ + 1 + (instance - first_instance);
    }
    /// Instances counted as those of the scene.
    std::size_t primitives() const { return triangles_ + spheres_ + group_of_.size(); }
    bool has_instances() const { return !group_of_.empty(); }
    /// Whether rays may pass any of them.
    bool some_are_passable() const { return some_are_passable_; }
    /// Whether rays may ask to pass what emits.
    bool hides_emitters() const { return hides_emitters_; }
    /// Opposite corners of a box around all.
    const std::array<float, 3> &low() const { return low_; }
    const std::array<float, 3> &high() const { return high_; }
    std::size_t memory_bytes() const { return static_cast<std::size_t>(bytes_.load()); }

  private:
    /// Those that rays may pass have geometries of their own, so that hits with all others are not asked about.
    enum Geometry : unsigned { opaque_triangles, opaque_spheres, passable_triangles, passable_spheres, first_instance };
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };

    void check(const char *doing);
    std::unique_ptr<RTCSceneTy, Release> new_scene() const;
    template <class Element>
    Element *new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count);
    void add_geometry(const Scene &s, const SceneTables *tables);
    void add_triangles(const Scene &s, Geometry place);
    /// The same with the vertices of tables that have them by index, and with their indices where all triangles are
    /// here.
    void add_shared_triangles(const Scene &s, const SceneTables &tables, Geometry place);
    void add_spheres(const Scene &s, Geometry place);
    /// Says which primitive of the scene comes next in a geometry.
    void name(const Scene &s, const Shape &shape, std::size_t triangle, std::uint32_t number, Geometry place);
    void attach(RTCGeometry geometry, Geometry place);
    void add_groups(const Scene &s, const SceneTables *tables);
    RTCGeometry new_triangles(const Mesh &mesh, std::uint32_t first, const SceneTables *tables);
    void add_instances(const Scene &s);
    static void drop_passed_in_instance(const RTCFilterFunctionNArguments *hits);

    /// A shape of a group that rays may pass.
    struct PassableShape {
        const EmbreeScene *scene;
        Opacity opacity;
    };
    /// Shapes are geometries, with their numbers: the first primitive of each is known.
    struct Group {
        std::unique_ptr<RTCSceneTy, Release> scene;
        std::vector<std::uint32_t> first;
        std::vector<std::unique_ptr<PassableShape>> passable; ///< by shape; nullptr where all rays meet it
    };

    std::atomic<long long> bytes_{0}; ///< which Embree counts until it is released
    std::unique_ptr<RTCDeviceTy, Release> device_;
    RTCSceneFlags flags_ = RTC_SCENE_FLAG_NONE;
    std::unique_ptr<RTCSceneTy, Release> scene_;
    std::uint32_t triangles_ = 0, spheres_ = 0;
    std::array<std::vector<std::uint32_t>, 2> numbers_; ///< of the opaque ones; empty: in the scene's order
    std::array<Opacity, 2> passable_;
    std::vector<TracedSphere> traced_spheres_; ///< the opaque ones, where they are few
    bool some_are_passable_ = false, hides_emitters_ = false;
    std::vector<Group> groups_;
    std::vector<std::uint32_t> group_of_; ///< by instance
    std::vector<Instance> instances_;     ///< where groups have what rays may pass
    std::uint32_t no_instance_ = 0;
    std::array<float, 3> low_{}, high_{};
};

} // namespace gradus
