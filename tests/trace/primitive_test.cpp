// Where kernels place the hit of a ray with the primitive that the tracer named: against double precision, and against
// where Embree itself meets it; near and far, tiny, thin and grazed, from within and beside edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <vector>

#include "runtime/scene/transform.h"
#include "runtime/trace/embree.h"
#include "runtime/trace/ray_packets.h"
#include "runtime/trace/sphere_geometry.h"

#include "kernels/lib/primitive.h"
#include "tests/support/worse.h"

namespace gradus::testing {
namespace {

using namespace lib_float;

constexpr double rounding = 0x1p-24; // half a unit in the last place of 1

class Dice {
  public:
    explicit Dice(std::uint64_t seed) : bits_(seed) {}
    double uniform() { return std::uniform_real_distribution<double>(0, 1)(bits_); }
    /// From 10^low to 10^high.
    double magnitude(double low, double high) { return std::pow(10, low + (high - low) * uniform()); }
    Double3 direction() {
        std::normal_distribution<double> normal;
        return normalize({normal(bits_), normal(bits_), normal(bits_)});
    }

  private:
    std::mt19937_64 bits_;
};

vec3 single(const Double3 &v) { return v3(float(v[0]), float(v[1]), float(v[2])); }
Double3 exact(vec3 v) { return {v.x, v.y, v.z}; }
Double3 at(const Double3 &from, double t, const Double3 &way) { return add(from, scale(way, t)); }

/// A device that traces as the renderer does.
class Embree {
  public:
    Embree() : device_(rtcNewDevice("threads=1,set_affinity=0")) {}
    ~Embree() { rtcReleaseDevice(device_); }
    RTCDevice device() const { return device_; }

  private:
    RTCDevice device_;
};

/// One geometry in a scene of its own, which takes it over.
class Traced {
  public:
    Traced(RTCDevice device, RTCGeometry geometry) : scene_(rtcNewScene(device)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~Traced() { rtcReleaseScene(scene_); }
    Traced(const Traced &) = delete;
    Traced &operator=(const Traced &) = delete;

    /// tfar is infinite where nothing is met.
    RTCRayHit meet(vec3 origin, vec3 direction) const {
        RTCRayHit hit{};
        hit.ray = {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0, INFINITY, ~0u, 0, 0};
        hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        RayQuery query(false);
        intersect(scene_, query, hit);
        return hit;
    }
    /// Of sixteen rays.
    template <class Ray>
    RTCRayHit16 meet(const std::vector<Ray> &rays) const {
        RTCRayHit16 hit{};
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const vec3 o = rays[i].origin, d = rays[i].direction;
            hit.ray.org_x[i] = o.x, hit.ray.org_y[i] = o.y, hit.ray.org_z[i] = o.z;
            hit.ray.dir_x[i] = d.x, hit.ray.dir_y[i] = d.y, hit.ray.dir_z[i] = d.z;
            hit.ray.tfar[i] = INFINITY;
            hit.ray.mask[i] = ~0u;
            hit.hit.geomID[i] = hit.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        const ValidLanes valid = first_lanes(int(rays.size()));
        RayQuery query(false);
        intersect(valid.lane, scene_, query, hit);
        return hit;
    }

  private:
    RTCScene scene_;
};

struct Triangle {
    vec3 p0, e1, e2;
    /// Its corners are where the edges lead, exactly.
    bool is_exact() const {
        for (const vec3 edge : {e1, e2})
            if (exact(v3_sub(v3_add(p0, edge), p0)) != exact(edge) ||
                exact(v3_add(p0, edge)) != add(exact(p0), exact(edge)))
                return false;
        return true;
    }
    Double3 across() const { return cross(exact(e1), exact(e2)); }
};

/// Of any size and place, wide or up to 30 times longer than high; corners that float holds.
Triangle random_triangle(Dice &dice) {
    for (;;) {
        const double size = dice.magnitude(-4, 3), far = dice.uniform() < 0.3 ? 0 : size * dice.magnitude(-1, 4);
        const Double3 first = dice.direction(), other = dice.direction();
        const double aspect = dice.uniform() < 0.5 ? 1 : dice.magnitude(-1.5, 0);
        const Double3 second = dice.uniform() < 0.5 ? scale(other, aspect) : at(first, aspect, other);
        const vec3 p0 = single(scale(dice.direction(), far));
        const vec3 p1 = single(at(exact(p0), size, first)), p2 = single(at(exact(p0), size, second));
        const Triangle triangle{p0, v3_sub(p1, p0), v3_sub(p2, p0)};
        if (triangle.is_exact() && length(triangle.across()) > 1e-3 * size * size)
            return triangle;
    }
}

/// How far off the numbers (u, v) of a hit may be. Each is a quotient of triple products of eight roundings, by
/// |to| |edge| above and |e1| |e2| below, over the double area times the cosine.
double uv_error(const Triangle &t, const Double3 &to_origin, double cosine) {
    const double first = length(exact(t.e1)), second = length(exact(t.e2));
    return 8 * rounding * std::max(first, second) * (length(to_origin) + std::min(first, second)) /
           (length(t.across()) * cosine);
}

/// (u, v) of a ray's hit with the plane, without rounding.
std::array<double, 2> exact_uv(const Triangle &t, vec3 origin, vec3 direction) {
    const Double3 to_origin = subtract(exact(origin), exact(t.p0)), way = exact(direction);
    const double determinant = dot(exact(t.e1), cross(way, exact(t.e2)));
    return {dot(to_origin, cross(way, exact(t.e2))) / determinant,
            dot(way, cross(to_origin, exact(t.e1))) / determinant};
}

/// Of a ray that meets the plane at (u, v) from `away`, with that cosine: its origin.
vec3 origin_towards(const Triangle &t, double u, double v, double away, const Double3 &direction) {
    return single(at(at(at(exact(t.p0), u, exact(t.e1)), v, exact(t.e2)), -away, direction));
}

vec3 grazing(Dice &dice, const Triangle &t, double cosine) {
    const Double3 normal = normalize(t.across());
    const Double3 along = normalize(cross(normal, dice.direction()));
    return single(
        add(scale(normal, dice.uniform() < 0.5 ? cosine : -cosine), scale(along, std::sqrt(1 - cosine * cosine))));
}

TEST(TriangleHit, IsThatOfDoublePrecision) {
    Dice dice(1);
    double worst_place = 0, worst_plane = 0, worst_normal = 0;
    for (int i = 0; i < 50'000; ++i) {
        const Triangle t = random_triangle(dice);
        double u = dice.uniform(), v = dice.uniform();
        if (u + v > 1)
            u = 1 - u, v = 1 - v;
        if (i % 4 == 0) // on an edge, or a corner
            (i % 8 == 0 ? u : v) = 0;
        const double cosine = i % 2 == 0 ? std::max(dice.uniform(), 0.1) : dice.magnitude(-3, 0);
        const vec3 direction = grazing(dice, t, cosine);
        const double size = length(exact(t.e1));
        const vec3 origin = origin_towards(t, u, v, size * dice.magnitude(-3, 3), exact(direction));
        const primitive_hit hit = triangle_hit(t.p0, t.e1, t.e2, origin, direction);

        // Of the same ray, whose numbers have been rounded.
        const Double3 across = t.across();
        const auto [exact_u, exact_v] = exact_uv(t, origin, direction);
        const double allowed =
            uv_error(t, subtract(exact(origin), exact(t.p0)), std::fabs(dot(normalize(across), exact(direction))));
        // A hit lies in the triangle: what is beyond an edge by rounding is brought back.
        const double inside_u = std::clamp(exact_u, 0.0, 1.0);
        const double off =
            std::max(std::fabs(hit.u - inside_u), std::fabs(hit.v - std::clamp(exact_v, 0.0, 1 - inside_u)));
        worst_place = worse(worst_place, off / allowed);
        ASSERT_GE(std::min(hit.u, hit.v), 0);
        ASSERT_LE(double(hit.u) + hit.v, 1 + rounding);

        // Off the plane by no more than two sums of three roundings each: what rays start off is made for that
        // (kernels/lib/ray_start.h).
        const Double3 normal = normalize(across);
        double bound = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double edges = std::fabs(exact(t.e1)[axis]) + std::fabs(exact(t.e2)[axis]);
            bound += std::fabs(normal[axis]) * (std::fabs(exact(hit.position)[axis]) + edges);
        }
        worst_plane = worse(worst_plane, std::fabs(dot(normal, subtract(exact(hit.position), exact(t.p0)))) /
                                             (4 * rounding * bound));

        // Of a cross product of edges: its error over its length.
        const double slant = length(exact(t.e1)) * length(exact(t.e2)) / length(across);
        worst_normal = worse(worst_normal, length(subtract(exact(hit.normal), normal)) / (8 * rounding * slant));
    }
    std::printf("over what is allowed: %.2f (u, v), %.2f off the plane, %.2f the normal\n", worst_place, worst_plane,
                worst_normal);
    EXPECT_LE(worst_place, 1);
    EXPECT_LE(worst_plane, 1);
    EXPECT_LE(worst_normal, 1);
}

// Embree tells a distance, barycentric numbers and a normal; kernels, which do without, find the same.
TEST(TriangleHit, IsWhereEmbreeMeetsIt) {
    const Embree embree;
    Dice dice(2);
    double worst_place = 0, worst_uv = 0, worst_normal = 0;
    std::size_t met = 0;
    constexpr int triangles = 4000, rays = 16;
    for (int i = 0; i < triangles; ++i) {
        const Triangle t = random_triangle(dice);
        RTCGeometry geometry = rtcNewGeometry(embree.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto *corners = static_cast<float *>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3));
        for (const vec3 p : {t.p0, v3_add(t.p0, t.e1), v3_add(t.p0, t.e2)}) {
            *corners++ = p.x;
            *corners++ = p.y;
            *corners++ = p.z;
        }
        auto *indices = static_cast<unsigned *>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 1));
        std::iota(indices, indices + 3, 0u);
        const Traced traced(embree.device(), geometry);
        for (int ray = 0; ray < rays; ++ray) {
            const double u = 0.8 * dice.uniform() + 0.05, v = (0.9 - u) * dice.uniform() + 0.05;
            const vec3 direction = grazing(dice, t, ray % 2 == 0 ? 0.9 : dice.magnitude(-2, 0));
            const vec3 origin = origin_towards(t, u, v, length(exact(t.e1)) * dice.magnitude(-2, 2), exact(direction));
            const Double3 to_origin = subtract(exact(origin), exact(t.p0));
            const double allowed = uv_error(t, to_origin, std::fabs(dot(normalize(t.across()), exact(direction))));
            const auto [exact_u, exact_v] = exact_uv(t, origin, direction);
            if (std::min({exact_u, exact_v, 1 - exact_u - exact_v}) < 2 * allowed)
                continue; // it may miss
            const RTCRayHit hit = traced.meet(origin, direction);
            ASSERT_EQ(hit.hit.geomID, 0u) << i;
            ++met;
            const primitive_hit found = triangle_hit(t.p0, t.e1, t.e2, origin, direction);
            worst_uv = std::max({worst_uv, std::fabs(double(hit.hit.u) - found.u) / (2 * allowed),
                                 std::fabs(double(hit.hit.v) - found.v) / (2 * allowed)});
            const Double3 place = at(exact(origin), hit.ray.tfar, exact(direction));
            const double moved = allowed * (length(exact(t.e1)) + length(exact(t.e2))) +
                                 8 * rounding * (length(exact(origin)) + double(hit.ray.tfar));
            worst_place = worse(worst_place, length(subtract(place, exact(found.position))) / (2 * moved));
            const Double3 normal{hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z};
            // Embree's edges are those of corners as seen from the ray's origin, each rounded there.
            const double longest = std::max(length(exact(t.e1)), length(exact(t.e2)));
            const double slant = longest * (longest + length(to_origin)) / length(t.across());
            worst_normal = std::max(worst_normal,
                                    length(subtract(normalize(normal), exact(found.normal))) / (16 * rounding * slant));
        }
    }
    std::printf("%zu met; over what is allowed: %.2f the place, %.2f (u, v), %.2f the normal\n", met, worst_place,
                worst_uv, worst_normal);
    EXPECT_GT(met, triangles * rays * 9 / 10);
    EXPECT_LE(worst_place, 1);
    EXPECT_LE(worst_uv, 1);
    EXPECT_LE(worst_normal, 1);
}

// Along the plane, where nothing is met, whatever is found is a place of the triangle.
TEST(TriangleHit, OfARayInItsPlaneIsFinite) {
    Dice dice(5);
    for (int i = 0; i < 10'000; ++i) {
        const Triangle t = random_triangle(dice);
        const vec3 direction = single(normalize(exact(i % 2 == 0 ? t.e1 : t.e2)));
        const vec3 origin = i % 3 == 0 ? t.p0 : v3_mad(t.p0, float(-dice.magnitude(-2, 2)), direction);
        const primitive_hit hit = triangle_hit(t.p0, t.e1, t.e2, origin, direction);
        ASSERT_TRUE(hit.u >= 0 && hit.v >= 0 && double(hit.u) + hit.v <= 1 + rounding) << hit.u << ' ' << hit.v;
    }
}

/// A ray and a sphere in double precision.
struct SphereCase {
    vec3 center, origin, direction;
    float radius;

    Double3 from() const { return subtract(exact(origin), exact(center)); }
    double square_of_closest() const {
        const Double3 f = from(), d = normalize(exact(direction));
        const Double3 closest = at(f, -dot(f, d), d);
        return dot(closest, closest);
    }
    double discriminant() const { return double(radius) * radius - square_of_closest(); }
    /// What roundings do to it: the vector to the line errs by some of |f|.
    double blur() const {
        const double size = length(from());
        const double moved = 16 * rounding * size;
        return moved * (2 * std::sqrt(square_of_closest()) + moved) + 8 * rounding * double(radius) * radius;
    }
    /// How far a point may be off along the ray.
    double error() const {
        const double half = std::sqrt(std::max(discriminant(), 0.0));
        return 16 * rounding * (length(from()) + radius) + std::min(blur() / std::max(half, 1e-300), std::sqrt(blur()));
    }
    /// The nearest point ahead.
    double distance() const {
        const Double3 f = from(), d = normalize(exact(direction));
        const double half = std::sqrt(std::max(discriminant(), 0.0)), middle = -dot(f, d);
        return middle - half > 0 ? middle - half : middle + half;
    }
    /// No root lies so near the origin that rounding decides on which side.
    bool is_clear() const {
        const Double3 f = from();
        return std::fabs(length(f) - radius) > 64 * rounding * (length(f) + radius);
    }
};

/// Tiny and huge, near and far.
SphereCase random_sphere(Dice &dice) {
    SphereCase s;
    s.radius = float(dice.magnitude(-5, 4));
    s.center = single(scale(dice.direction(), dice.uniform() < 0.3 ? 0 : s.radius * dice.magnitude(-1, 4)));
    return s;
}

/// A ray that meets it beyond doubt: from outside at any distance, also grazing, and from within.
SphereCase with_ray(SphereCase s, Dice &dice) {
    do {
        const double chance = dice.uniform();
        const double away = s.radius * (chance < 0.2 ? dice.uniform() : 1 + dice.magnitude(-3, 3));
        const Double3 to_origin = dice.direction();
        s.origin = single(at(exact(s.center), away, to_origin));
        const double rim = chance > 0.7 ? 1 - dice.magnitude(-5, -1) : std::sqrt(dice.uniform());
        const Double3 beside = normalize(cross(to_origin, dice.direction()));
        const Double3 target = at(exact(s.center), rim * s.radius, beside);
        s.direction = chance < 0.2 ? single(dice.direction()) : single(normalize(subtract(target, exact(s.origin))));
    } while (!s.is_clear() || s.discriminant() <= 2 * s.blur() || s.distance() <= 0);
    return s;
}

TEST(SphereHit, IsThatOfDoublePrecision) {
    Dice dice(3);
    double worst_place = 0, worst_off = 0, worst_normal = 0;
    for (int i = 0; i < 50'000; ++i) {
        const SphereCase s = with_ray(random_sphere(dice), dice);
        const primitive_hit hit = sphere_hit(s.center, s.radius, i % 2 == 0 ? 1 : -1, s.origin, s.direction);
        const Double3 place = at(s.from(), s.distance(), normalize(exact(s.direction))); // from the center
        const Double3 found = subtract(exact(hit.position), exact(s.center));
        const double stored = 4 * rounding * (length(exact(s.center)) + s.radius);
        // It is put back on the sphere, which moves it across by no more than it was off.
        worst_place = worse(worst_place, length(subtract(found, place)) / (2 * s.error() + stored));
        worst_off = worse(worst_off, std::fabs(length(found) - s.radius) / stored);
        const Double3 outward = scale(exact(hit.normal), i % 2 == 0 ? 1 : -1);
        worst_normal = worse(worst_normal, length(subtract(scale(outward, s.radius), found)) / stored);
    }
    std::printf("over what is allowed: %.2f the place, %.2f off the sphere, %.2f the normal\n", worst_place, worst_off,
                worst_normal);
    EXPECT_LE(worst_place, 1);
    EXPECT_LE(worst_off, 1);
    EXPECT_LE(worst_normal, 1);
}

// Our own test of sixteen rays at once, with directions of any length, beside Embree's of one.
TEST(SphereHit, OfPacketsIsWhereEmbreeMeetsIt) {
    const Embree embree;
    Dice dice(4);
    double worst = 0, worst_of_embree = 0;
    std::size_t missed_by_embree = 0;
    constexpr int spheres = 3000;
    for (int i = 0; i < spheres; ++i) {
        const SphereCase s = random_sphere(dice);
        const TracedSphere sphere{{s.center.x, s.center.y, s.center.z}, s.radius};
        const Traced ours(embree.device(), new_sphere_geometry(embree.device(), &sphere, 1));
        RTCGeometry geometry = rtcNewGeometry(embree.device(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
        auto *point = static_cast<float *>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
        std::copy_n(sphere.center, 3, point);
        point[3] = sphere.radius;
        const Traced theirs(embree.device(), geometry);
        std::vector<SphereCase> rays;
        for (int ray = 0; ray < packet_width; ++ray) {
            rays.push_back(with_ray(s, dice));
            rays.back().direction = v3_scale(rays.back().direction, ray % 2 == 0 ? 1 : float(dice.magnitude(-2, 2)));
        }
        const RTCRayHit16 packet = ours.meet(rays);
        for (std::size_t ray = 0; ray < rays.size(); ++ray) {
            const SphereCase &one = rays[ray];
            const double step = length(exact(one.direction)), allowed = 2 * one.error();
            ASSERT_EQ(packet.hit.geomID[ray], 0u) << i << ": it is met in double precision, beyond rounding";
            worst = worse(worst, std::fabs(packet.ray.tfar[ray] * step - one.distance()) / allowed);
            const RTCRayHit other = theirs.meet(one.origin, one.direction);
            if (other.hit.geomID != 0)
                ++missed_by_embree;
            else
                worst_of_embree = std::max(worst_of_embree,
                                           std::fabs(double(other.ray.tfar) - packet.ray.tfar[ray]) * step / allowed);
        }
    }
    std::printf("over what is allowed: %.2f; Embree's own %.2f from ours, %zu of %d missed\n", worst, worst_of_embree,
                missed_by_embree, spheres * packet_width);
    EXPECT_LE(worst, 1);
    EXPECT_LE(worst_of_embree, 2);
    EXPECT_LE(missed_by_embree, spheres * packet_width / 100);
}

} // namespace
} // namespace gradus::testing
