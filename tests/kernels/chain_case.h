// Chains of mirrors and glasses, smooth and glossy, flat and curved, followed by the functions of kernels/lib.
#pragma once

#include "tests/kernels/precision.h"

#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#define TRAIT_SHADING_NORMALS 1
#define TRAIT_TWO_SIDED 0
#define TRAIT_TWO_FACED 0
#define TRAIT_ANISOTROPIC 0
#include "kernels/lib/chain_event.h"
#include "kernels/lib/chain_hit.h"
#include "kernels/lib/chain_spread.h"

#include <random>
#include <vector>

namespace gradus::testing {

/// A vertex of a chain: which primitive it is on and what it does.
struct ChainVertex {
    uint primitive;
    bool is_glossy, reflects, behind;
    double half_x, half_y, ior;
};

/// What following a chain gives.
struct FollowedChain {
    bool is_valid = true;
    std::vector<lib::vec3> positions, directions_out, normals, geometric;
    std::vector<lib::vec3> step_s, step_t; ///< of the positions
    std::vector<lib::normal_change> changes;
    std::vector<lib::vertex_event> events;
    lib::vec3 end, end_s, end_t;
    double turn = 1;
};

/// The chain's scene is made as it is: each primitive stands where the ray is that comes to it.
struct ChainCase {
    std::vector<real> triangles, normals, spheres;
    std::vector<ChainVertex> vertices;
    lib::vec3 start = lib::v3(0, 0, 0), first_direction, plane, plane_point;
    uint triangle_count = 8; ///< room for so many

    /// The surface at a vertex, met from `from`.
    void surface(const ChainVertex &vertex, lib::vec3 from, lib::vec3 direction, FollowedChain &chain) const {
        const uint unit = 1;
        const lib::primitive_hit hit = lib::chain_hit_of(triangles.data(), spheres.data(), unit, triangle_count,
                                                         vertex.primitive, from, from, direction);
        lib::vec3 n = hit.normal;
        if (vertex.primitive < triangle_count) {
            const real *record = &normals[std::size_t(vertex.primitive) * lib::normals_stride];
            const auto corner = [&](int c) { return lib::v3(record[3 * c], record[3 * c + 1], record[3 * c + 2]); };
            n = lib::v3_normalize(lib::v3_mad(
                lib::v3_mad(lib::v3_scale(corner(0), 1 - hit.u - hit.v), hit.u, corner(1)), hit.v, corner(2)));
        }
        chain.positions.push_back(hit.position);
        chain.geometric.push_back(hit.normal);
        chain.normals.push_back(n);
        chain.changes.push_back(lib::normal_change_of(triangles.data(), normals.data(), spheres.data(), unit,
                                                      triangle_count, vertex.primitive, hit, n, hit.normal));
    }

    /// Follows the first `count` vertices by their half vectors, to the plane where these are all. With `out`,
    /// directions after glossy vertices are those instead.
    FollowedChain follow(lib::vec3 direction, std::size_t count, const std::vector<lib::vec3> *out = nullptr) const {
        FollowedChain chain;
        lib::vec3 from = start;
        lib::ray_differential beam = lib::ray_differential_begin(direction);
        std::size_t glossy = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const ChainVertex &v = vertices[k];
            surface(v, from, direction, chain);
            const lib::vec3 n = chain.normals.back(), position = chain.positions.back();
            const real distance = lib::v3_dot(lib::v3_sub(position, from), direction);
            const real cosine = lib::v3_dot(chain.geometric.back(), direction);
            const lib::vertex_event event = lib::vertex_event_of(lib::v3_neg(direction), n, real(v.half_x),
                                                                 real(v.half_y), v.reflects, v.behind, real(v.ior));
            chain.is_valid &= event.is_valid && distance > R(0.05) && std::fabs(cosine) > R(0.2);
            beam = lib::ray_differential_at(beam, direction, distance, chain.geometric.back(), 1 / cosine);
            chain.step_s.push_back(beam.position_s);
            chain.step_t.push_back(beam.position_t);
            const auto change = [&](lib::vec3 direction_step, lib::vec3 position_step) {
                return lib::vertex_event_change(event, n, real(v.half_x), real(v.half_y), direction_step,
                                                lib::normal_change_along(chain.changes.back(), position_step));
            };
            beam.direction_s = change(beam.direction_s, beam.position_s);
            beam.direction_t = change(beam.direction_t, beam.position_t);
            chain.turn *= v.is_glossy ? event.turn : real(1);
            from = position;
            direction = out && v.is_glossy ? (*out)[glossy++] : event.wo;
            chain.directions_out.push_back(direction);
            chain.events.push_back(event);
        }
        const real plane_cosine = lib::v3_dot(plane, direction);
        const real reach = lib::v3_dot(lib::v3_sub(plane_point, from), plane) / plane_cosine;
        chain.end = lib::v3_mad(from, reach, direction);
        chain.end_s = lib::ray_step_at(beam.position_s, beam.direction_s, direction, reach, plane, 1 / plane_cosine);
        chain.end_t = lib::ray_step_at(beam.position_t, beam.direction_t, direction, reach, plane, 1 / plane_cosine);
        return chain;
    }
    FollowedChain follow() const { return follow(first_direction, vertices.size()); }
};

/// Draws chains that can be followed, away from edges and grazing angles.
class ChainCases {
  public:
    explicit ChainCases(unsigned seed) : random_(seed) {}

    enum class Kinds { specular, glossy, mixed };
    ChainCase draw(std::size_t count, Kinds kinds) {
        for (;;)
            if (ChainCase c = attempt(count, kinds); c.vertices.size() == count)
                return c;
    }
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    lib::vec3 direction() {
        std::normal_distribution<double> normal;
        return lib::v3_normalize(lib::v3(real(normal(random_)), real(normal(random_)), real(normal(random_))));
    }
    /// A direction at most that far from another.
    lib::vec3 near(lib::vec3 to, double most) {
        return lib::v3_normalize(lib::v3_mad(to, real(uniform(0, most)), direction()));
    }

  private:
    ChainCase attempt(std::size_t count, Kinds kinds) {
        ChainCase c;
        c.triangles.resize(std::size_t(c.triangle_count) * lib::triangle_stride);
        c.normals.resize(std::size_t(c.triangle_count) * lib::normals_stride);
        c.spheres.resize(std::size_t(c.triangle_count) * lib::sphere_stride);
        lib::vec3 from = c.start, towards = c.first_direction = direction();
        for (std::size_t k = 0; k < count; ++k) {
            ChainVertex v{};
            const bool is_triangle = uniform(0, 1) < 0.5;
            v.primitive = uint(k) + (is_triangle ? 0 : c.triangle_count);
            const double side = uniform(0, 1) < 0.5 ? 1 : -1;
            const lib::vec3 at = lib::v3_mad(from, real(uniform(0.5, 2)), towards);
            const lib::vec3 normal = near(lib::v3_scale(towards, real(side)), 0.8);
            is_triangle ? add_triangle(c, k, at, normal) : add_sphere(c, k, at, normal);
            v.is_glossy = kinds == Kinds::glossy || (kinds == Kinds::mixed && uniform(0, 1) < 0.5);
            v.reflects = uniform(0, 1) < 0.5;
            v.ior = uniform(0, 1) < 0.5 ? uniform(1.2, 2) : 1 / uniform(1.2, 2);
            if (v.is_glossy)
                v.half_x = uniform(-0.3, 0.3), v.half_y = uniform(-0.3, 0.3);
            FollowedChain found;
            c.surface(v, from, towards, found);
            v.behind = lib::v3_dot(found.normals[0], towards) > 0;
            c.vertices.push_back(v);
            c.plane = towards, c.plane_point = at; // any
            found = c.follow(c.first_direction, k + 1);
            const lib::vec3 miss = lib::v3_sub(found.positions[k], at);
            if (!found.is_valid || found.events[k].turn < 1e-2 || lib::v3_dot(miss, miss) > 1e-6)
                return {};
            from = found.positions[k];
            towards = found.directions_out[k];
        }
        c.plane = near(towards, 0.8);
        c.plane_point = lib::v3_mad(from, real(uniform(0.5, 2)), towards);
        if (std::fabs(lib::v3_dot(c.plane, towards)) < 0.2)
            return {};
        return c;
    }
    void put(real *to, lib::vec3 v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }
    void add_triangle(ChainCase &c, std::size_t k, lib::vec3 at, lib::vec3 normal) {
        const lib::frame f = lib::frame_from_normal(normal);
        real *record = &c.triangles[k * lib::triangle_stride];
        put(record, lib::v3_sub(at, lib::v3_add(f.s, f.t)));
        put(record + lib::triangle_e1_x, lib::v3_mad(lib::v3_scale(f.s, 4), real(uniform(-1, 1)), f.t));
        put(record + lib::triangle_e2_x, lib::v3_mad(lib::v3_scale(f.t, 4), real(uniform(-1, 1)), f.s));
        for (int corner = 0; corner < 3; ++corner)
            put(&c.normals[k * lib::normals_stride + 3 * std::size_t(corner)], near(normal, 0.3));
    }
    void add_sphere(ChainCase &c, std::size_t k, lib::vec3 at, lib::vec3 normal) {
        // Met from outside, or from within where the normal of its outside is along the ray.
        const real radius = real(uniform(0.5, 3));
        real *record = &c.spheres[k * lib::sphere_stride];
        put(record, lib::v3_mad(at, -radius, normal));
        record[lib::sphere_radius] = radius;
        record[lib::sphere_facing] = real(uniform(0, 1) < 0.5 ? 1 : -1);
    }
    std::mt19937_64 random_;
};

} // namespace gradus::testing
