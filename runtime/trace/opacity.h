// Surfaces that only some rays meet.
#pragma once

#include "runtime/scene/scene.h"

#include <cstdint>
#include <vector>

namespace gradus {

/// Whether the tracer must ask, hit by hit, if a ray meets the shape: its material's opacity is below 1. Shapes that
/// emit are met by all rays.
bool is_passable(const Scene &scene, const Shape &shape);

/// Decides whether rays meet the surfaces that are passable. A ray meets one with the probability of its opacity there
/// and passes it else, as if nothing were there: light samples and sampled directions find a light behind it alike, and
/// their weights stay those without it. The number that decides is a hash of ray and primitive, so the answer depends
/// on nothing else: not on the order in which the tracer finds hits, nor on packets, threads or batches.
class Opacity {
  public:
    /// Adds a primitive of the scene's numbering. In the order of the geometry that holds them.
    void add(const Scene &scene, const Shape &shape, std::uint32_t primitive);
    bool empty() const { return primitives_.empty(); }
    /// In the scene's numbering.
    std::uint32_t primitive(std::size_t i) const { return primitives_[i].number; }
    /// Whether the ray meets the i-th primitive, which lies in its way.
    bool is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction) const;

  private:
    struct Primitive {
        std::uint32_t number;
        float opacity;
    };
    std::vector<Primitive> primitives_;
};

} // namespace gradus
