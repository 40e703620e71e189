// Surfaces that only some rays meet.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/scene/texture.h"

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace gradus {

/// Whether the tracer must ask, hit by hit, if a ray meets the shape: its material's opacity is below 1. Shapes that
/// emit are met by all rays.
bool is_passable(const Scene &scene, const Shape &shape);

bool has_passable_shapes(const Scene &scene);
/// The same, or it is a lamp, a black one too, and rays of the camera pass it.
bool is_asked_about(const Scene &scene, const Shape &shape);

/// Decides whether rays meet the surfaces that are passable. A ray meets one with the probability of its opacity there
/// and passes it else, as if nothing were there: light samples and sampled directions find a light behind it alike, and
/// their weights stay those without it. The number that decides is a hash of ray and primitive, so the answer depends
/// on nothing else: not on the order in which the tracer finds hits, nor on packets, threads or batches.
class Opacity {
  public:
    /// Adds a primitive of the scene's numbering, of a mesh the triangle of that index. In the order of the geometry
    /// that holds them.
    void add(const Scene &scene, const Shape &shape, std::size_t triangle, std::uint32_t primitive);
    bool empty() const { return primitives_.empty(); }
    /// Whether the i-th primitive is of a lamp, a black one too.
    bool emits(std::size_t i) const { return primitives_[i].emits; }
    /// In the scene's numbering.
    std::uint32_t primitive(std::size_t i) const { return primitives_[i].number; }
    /// Whether a hit is on a side of the i-th primitive that is of it: all but a sphere's have both. `outward`: the
    /// product of the ray's direction and the normal away from the center.
    bool has_side(std::size_t i, float outward) const {
        const Sphere::Side side = primitives_[i].side;
        return side == Sphere::Side::both || (side == Sphere::Side::left) == (outward > 0);
    }
    /// The opacity of the i-th primitive where the ray comes to it; with `to_world`, of an instance of its group.
    float at(std::size_t i, const Vector3 &origin, const Vector3 &direction) const;
    float at(std::size_t i, const Vector3 &origin, const Vector3 &direction, const Matrix4 &to_world) const;
    /// Whether the ray meets the i-th primitive, which lies in its way; `without_chance`: it meets what is not open.
    bool is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction, bool without_chance) const;
    /// The same of an instance of the group that the primitive is of, by its number from 1 on and where it stands. Each
    /// instance decides anew.
    bool is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction, bool without_chance,
                std::uint32_t instance, const Matrix4 &to_world) const;

  private:
    /// Where the opacity is a texture: what tells (u, v).
    struct TexturedTriangle {
        std::uint32_t texture;
        Vector3 p0, e1, e2;
        std::array<std::array<float, 2>, 3> texcoords;
        std::array<std::array<float, 3>, 3> attribute; ///< colours at the corners, of a mesh attribute
    };
    struct TexturedSphere {
        std::uint32_t texture;
        Vector3 center;
        float radius; ///< below 0 where rays leave it, as kernels have it
        std::array<float, 9> axes;
    };
    struct Primitive {
        std::uint32_t number;
        float opacity;
        std::int64_t textured; ///< index into triangles_, or of a sphere into spheres_; -1: one opacity all over
        Sphere::Side side;
        bool is_sphere, emits;
    };
    float opacity_of(const TexturedTriangle &triangle, const Vector3 &origin, const Vector3 &direction) const;
    float opacity_of(const TexturedSphere &sphere, const Vector3 &origin, const Vector3 &direction) const;
    std::uint32_t own_texture(const Scene &scene, std::int32_t texture);
    bool decide(const Primitive &primitive, float opacity, const Vector3 &origin, const Vector3 &direction,
                std::uint32_t instance) const;

    std::vector<Primitive> primitives_;
    std::vector<TexturedTriangle> triangles_;
    std::vector<TexturedSphere> spheres_;
    std::vector<Texture> textures_;               ///< those that are asked for
    std::map<std::int32_t, std::uint32_t> known_; ///< their places, by those in the scene
};

} // namespace gradus
