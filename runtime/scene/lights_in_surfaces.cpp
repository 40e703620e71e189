#include "runtime/scene/lights_in_surfaces.h"

#include "runtime/scene/bounds.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <utility>

// After all others: their short macro names are not for library headers.
#include "kernels/lib/ray_start.h"
#include "kernels/lib/scene_triangle.h"

namespace gradus {

using namespace lib_float;

namespace {

/// What the tracer errs by, as a share of a primitive's size, and how many times that at triangles of the worst shape;
/// and what rounding does, as a share of coordinates.
constexpr double share_of_size = GRADUS_TRACER_ERROR, worst_shape = GRADUS_MOST_SLANT / GRADUS_LEAST_SLANT,
                 share_of_place = GRADUS_ROUNDING;

/// A ray that grazes a surface passes near it over a way so many times longer than the tracer errs by across it.
constexpr double longest_graze = 64;

struct Place {
    Double3 at;
    std::size_t emitter;
};

bool holds(const Bounds &box, const Double3 &at, double reach) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(at[axis] >= box.lower[axis] - reach && at[axis] <= box.upper[axis] + reach))
            return false;
    return true;
}

/// By how much rounding moves a point so far from the origin, and the tracer a primitive of that size.
double reach_of(const Bounds &box, double of_primitive) {
    double farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::fabs(box.lower[axis]), std::fabs(box.upper[axis])});
    return of_primitive + share_of_place * farthest;
}

/// Of triangles in the box, however they are shaped.
double most_reach_of(const Bounds &box) { return reach_of(box, share_of_size * worst_shape * box.extent()); }

class Gaps {
  public:
    explicit Gaps(const std::vector<Emitter> &emitters) : gaps_(emitters.size()) {
        for (std::size_t i = 0; i < emitters.size(); ++i)
            if (emitters[i].shines_from_a_point())
                places_.push_back({to_double(emitters[i].position), i});
        std::ranges::sort(places_, {}, [](const Place &place) { return place.at[0]; });
    }

    bool has_places() const { return !places_.empty(); }
    bool may_lie_in_some_of(const Bounds &box) const {
        const double reach = most_reach_of(box);
        const auto past = [&](const Place &place) { return place.at[0] > box.upper[0] + reach; };
        for (auto place = first_from(box.lower[0] - reach); place != places_.end() && !past(*place); ++place)
            if (holds(box, place->at, reach))
                return true;
        return false;
    }

    void add_triangle(const std::array<Double3, 3> &corners) {
        Bounds box;
        for (const Double3 &corner : corners)
            box.add(Bounds{corner, corner});
        // Of most, at once: nothing is near.
        const double most = most_reach_of(box);
        const auto first = first_from(box.lower[0] - most);
        if (first == places_.end() || first->at[0] > box.upper[0] + most)
            return;
        const Double3 e1 = subtract(corners[1], corners[0]), e2 = subtract(corners[2], corners[0]);
        const Double3 across = cross(e1, e2);
        const double area = length(across);
        if (!(area > 0))
            return;
        const auto edge = [](const Double3 &e) { return v3(float(e[0]), float(e[1]), float(e[2])); };
        add(box, reach_of(box, triangle_offset_of(edge(e1), edge(e2))),
            [&](const Double3 &at) { return std::fabs(dot(across, subtract(at, corners[0]))) / area; });
    }
    void add_sphere(const Sphere &sphere) {
        Bounds box;
        box.add(sphere.center, sphere.radius);
        add(box, reach_of(box, share_of_size * sphere.radius), [&](const Double3 &at) {
            return std::fabs(length(subtract(at, to_double(sphere.center))) - sphere.radius);
        });
    }
    std::vector<float> take() { return std::move(gaps_); }

  private:
    std::vector<Place>::const_iterator first_from(double x) const {
        return std::ranges::lower_bound(places_, x, {}, [](const Place &place) { return place.at[0]; });
    }
    template <class Distance>
    void add(const Bounds &box, double reach, const Distance &distance) {
        for (auto place = first_from(box.lower[0] - reach);
             place != places_.end() && place->at[0] <= box.upper[0] + reach; ++place)
            if (holds(box, place->at, reach) && distance(place->at) <= reach) {
                const std::lock_guard lock(mutex_);
                float &gap = gaps_[place->emitter];
                gap = std::max(gap, float(longest_graze * reach));
            }
    }

    std::vector<Place> places_; ///< in the order of x
    std::mutex mutex_;
    std::vector<float> gaps_; ///< by emitter
};

void add_mesh(const Mesh &mesh, const Matrix4 *to_world, Gaps &gaps) {
    for_each_in_parallel(mesh.triangles.size(), [&](std::size_t number) {
        std::array<Double3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i) {
            corners[i] = to_double(mesh.positions[mesh.triangles[number][i]]);
            if (to_world)
                corners[i] = transform_point(*to_world, corners[i]);
        }
        gaps.add_triangle(corners);
    });
}

} // namespace

std::vector<float> gaps_in_surfaces(const Scene &scene) {
    Gaps gaps(scene.emitters);
    if (!gaps.has_places())
        return gaps.take();
    for (const Shape &shape : scene.shapes) {
        if (shape.group != no_group)
            continue;
        if (shape.kind == Shape::Kind::mesh)
            add_mesh(scene.meshes[shape.geometry], nullptr, gaps);
        else
            gaps.add_sphere(scene.spheres[shape.geometry]);
    }
    const std::vector<Bounds> of_groups = group_bounds(scene);
    const auto add_instance = [&](std::size_t number) {
        const Instance &instance = scene.instances[number];
        const Matrix4 to_world = matrix_of(instance);
        if (!gaps.may_lie_in_some_of(placed_bounds(of_groups[instance.group], to_world)))
            return;
        for (const Shape &shape : scene.shapes)
            if (shape.group == std::int32_t(instance.group) && shape.kind == Shape::Kind::mesh)
                add_mesh(scene.meshes[shape.geometry], &to_world, gaps);
    };
    for_each_in_parallel(scene.instances.size(), add_instance, 1 << 8);
    return gaps.take();
}

} // namespace gradus
