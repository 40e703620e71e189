// Chains through a scene, sampled on the host in double precision, for walks to move.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/trace/tracer.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

namespace gradus::testing {

using Point = std::array<double, 3>;

/// Where a chain starts or ends.
struct ChainEnd {
    Point position{}, normal{}; ///< normal zero: on no surface
    double offset = 0;
    /// A start at infinity (kernels/shared/walk_tables.h): `normal` is the direction of its rays.
    bool is_far() const { return offset < 0; }
};

struct WalkVertex {
    Point position{};
    std::uint32_t primitive = 0;
};

/// A row of `chain`, and its rows of `chain_vertex`.
struct WalkChain {
    ChainEnd start, end, target;
    std::vector<WalkVertex> vertices;
};

/// What is told of each sampled vertex.
struct VertexTruth {
    Point normal{};         ///< shading normal
    double ior = 1;         ///< 1 for null
    std::uint32_t kind = 0; ///< with kind_is_rough, kind_is_dirac
};

class ChainSampler {
  public:
    ChainSampler(const Scene &scene, const std::vector<std::uint32_t> &material_kinds, Tracer &tracer);
    ~ChainSampler();

    /// From a point in a direction, mirrored or refracted at random by smooth and glossy vertices (these at half
    /// vectors at most `slope` off the normal), until a rough one, where it ends. None where there is no vertex
    /// between, or more than `most`, or it leaves the scene. `only_reflects`: never refracted where it can be mirrored.
    std::optional<WalkChain> sample(const ChainEnd &start, const Point &direction, std::size_t most, double slope,
                                    std::mt19937_64 &random);
    /// What a ray meets.
    std::optional<ChainEnd> first_hit(const Point &origin, const Point &direction);
    /// The surface at a vertex that is come to from `before`.
    VertexTruth truth(const Point &before, const WalkVertex &vertex) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace gradus::testing
