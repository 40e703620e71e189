#define GRADUS_DOUBLE
#include "tests/wavefront/chain_sampler.h"

#include "runtime/scene/scene_tables.h"
#include "runtime/scene/traits.h"

#include <cmath>

#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#define TRAIT_SHADING_NORMALS 1
#define TRAIT_TWO_SIDED 1
#define TRAIT_TWO_FACED 1
#define TRAIT_ANISOTROPIC 1
#include "kernels/lib/chain_event.h"
#include "kernels/lib/chain_hit.h"
#include "kernels/shared/material.h"
#include "kernels/shared/tables.h"

namespace gradus::testing {

using namespace lib_double;

namespace {

vec3 of(const Point &p) { return v3(p[0], p[1], p[2]); }
Point point(vec3 v) { return {v.x, v.y, v.z}; }
std::vector<double> wide(const std::vector<float> &values) { return {values.begin(), values.end()}; }

} // namespace

struct ChainSampler::Implementation {
    SceneTables tables;
    std::vector<double> triangles, normals, tangents, spheres, materials;
    std::vector<std::uint32_t> kinds;
    Tracer &tracer;

    /// With all traits there is an array of each.
    Implementation(const Scene &scene, const std::vector<std::uint32_t> &material_kinds, Tracer &t)
        : tables(make_scene_tables(scene, with_all_traits(scene_traits(scene)))), triangles(wide(tables.triangles)),
          normals(wide(tables.triangle_normals)), tangents(wide(tables.triangle_tangents)),
          spheres(wide(tables.spheres)), materials(wide(tables.materials)), kinds(material_kinds), tracer(t) {
        normals.resize(std::max<std::size_t>(normals.size(), normals_stride));
        tangents.resize(std::max<std::size_t>(tangents.size(), triangle_tangent_stride));
    }
    std::uint32_t trace(vec3 origin, vec3 direction) {
        float o[3] = {float(origin.x), float(origin.y), float(origin.z)};
        float d[3] = {float(direction.x), float(direction.y), float(direction.z)};
        std::uint32_t primitive = ray_pending;
        RayColumns ray{};
        for (int axis = 0; axis < 3; ++axis)
            ray.origin[axis] = &o[axis], ray.direction[axis] = &d[axis];
        ray.primitive = &primitive;
        tracer.trace(ray, 1, {}, 0);
        return primitive;
    }
    surface_point surface(std::uint32_t primitive, vec3 origin, vec3 from, vec3 direction) const {
        const primitive_hit hit = chain_hit_of(triangles.data(), spheres.data(), 1, tables.triangle_count, primitive,
                                               origin, from, direction);
        return surface_point_at(triangles.data(), normals.data(), tangents.data(), spheres.data(), 1,
                                tables.triangle_count, tables.primitive_material.data(), tables.material_back.data(),
                                primitive, hit, direction);
    }
    double ior(const surface_point &p) const {
        return kind_number(kinds[p.material]) == bsdf_kind_null
                   ? 1
                   : materials[p.material * material_stride + material_ior];
    }
};

ChainSampler::ChainSampler(const Scene &scene, const std::vector<std::uint32_t> &material_kinds, Tracer &tracer)
    : implementation_(std::make_unique<Implementation>(scene, material_kinds, tracer)) {}
ChainSampler::~ChainSampler() = default;

std::optional<ChainEnd> ChainSampler::first_hit(const Point &origin, const Point &direction) {
    const std::uint32_t primitive = implementation_->trace(of(origin), of(direction));
    if (primitive >= ray_first_special)
        return std::nullopt;
    const surface_point p = implementation_->surface(primitive, of(origin), of(origin), of(direction));
    return ChainEnd{point(p.position), point(p.geometric), p.offset};
}

std::optional<WalkChain> ChainSampler::sample(const ChainEnd &start, const Point &first, std::size_t most, double slope,
                                              std::mt19937_64 &random) {
    const Implementation &scene = *implementation_;
    const auto uniform = [&] { return std::uniform_real_distribution<double>()(random); };
    WalkChain chain;
    chain.start = start;
    vec3 from = of(start.position), direction = v3_normalize(of(first));
    vec3 origin = start.is_far() ? from : ray_origin(from, of(start.normal), start.offset, direction);
    for (;;) {
        const std::uint32_t primitive = implementation_->trace(origin, direction);
        if (primitive >= ray_first_special)
            return std::nullopt;
        const surface_point p = scene.surface(primitive, origin, from, direction);
        const std::uint32_t kind = scene.kinds[p.material];
        if ((kind & kind_is_rough) != 0u) {
            chain.end = chain.target = {point(p.position), point(p.geometric), p.offset};
            return chain.vertices.empty() ? std::nullopt : std::optional(chain);
        }
        if (chain.vertices.size() == most)
            return std::nullopt;
        chain.vertices.push_back({point(p.position), primitive});
        const BsdfKindTraits &traits = bsdf_kind_traits(BsdfKind(kind_number(kind)));
        const bool is_dirac = (kind & kind_is_dirac) != 0u,
                   reflects = !traits.transmits || (traits.refracts && uniform() < 0.4);
        const double radius = is_dirac ? 0 : slope * std::sqrt(uniform()), angle = 2 * M_PI * uniform();
        const vertex_event event =
            vertex_event_of(v3_neg(direction), p.shading, radius * std::cos(angle), radius * std::sin(angle), reflects,
                            v3_dot(direction, p.shading) > 0, scene.ior(p));
        if (!event.is_valid)
            return std::nullopt;
        from = p.position;
        direction = v3_normalize(event.wo);
        origin = ray_origin(from, p.geometric, p.offset, direction);
    }
}

VertexTruth ChainSampler::truth(const Point &before, const WalkVertex &vertex) const {
    const Implementation &scene = *implementation_;
    const vec3 from = of(before), way = v3_sub(of(vertex.position), from);
    const surface_point p = scene.surface(vertex.primitive, v3_mad(from, 0.5, way), from, v3_normalize(way));
    return {point(p.shading), scene.ior(p), scene.kinds[p.material]};
}

} // namespace gradus::testing
