#include "runtime/trace/opacity.h"

#include "kernels/lib/primitive.h"
#include "kernels/lib/random.h"
#include "runtime/scene/transform.h"

#include <bit>

namespace gradus {

using namespace lib_float;

namespace {
Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
vec3 to_vec3(Vector3 v) { return v3(v.x, v.y, v.z); }
} // namespace

bool is_passable(const Scene &scene, const Shape &shape) {
    const Number &opacity = scene.materials[shape.material].opacity;
    return shape.emitter < 0 && (opacity.texture != no_texture || opacity.value < 1);
}

void Opacity::add(const Scene &scene, const Shape &shape, std::size_t triangle, std::uint32_t primitive) {
    const Number &opacity = scene.materials[shape.material].opacity;
    primitives_.push_back({primitive, opacity.value, -1, Sphere::Side::both});
    if (shape.kind == Shape::Kind::sphere)
        primitives_.back().side = scene.spheres[shape.geometry].side;
    if (opacity.texture == no_texture || shape.kind != Shape::Kind::mesh)
        return;
    const auto [known, is_new] = known_.emplace(opacity.texture, std::uint32_t(textures_.size()));
    if (is_new)
        textures_.push_back(scene.textures[std::size_t(opacity.texture)]);
    const Mesh &mesh = scene.meshes[shape.geometry];
    const auto &corners = mesh.triangles[triangle];
    TexturedTriangle textured{known->second, mesh.positions[corners[0]], {}, {}, {{{0, 0}, {1, 0}, {0, 1}}}, {}};
    textured.e1 = mesh.positions[corners[1]] - textured.p0;
    textured.e2 = mesh.positions[corners[2]] - textured.p0;
    if (!mesh.texcoords.empty())
        for (std::size_t corner = 0; corner < 3; ++corner)
            textured.texcoords[corner] = mesh.texcoords[corners[corner]];
    if (const MeshAttribute *attribute = find_attribute(mesh, textures_[known->second].attribute))
        for (std::size_t corner = 0; corner < 3; ++corner)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t element = is_by_face(attribute->name) ? triangle : corners[corner];
                textured.attribute[corner][c] =
                    attribute->values[element * attribute->channels + (attribute->channels > 1 ? c : 0)];
            }
    primitives_.back().textured = std::int64_t(triangles_.size());
    triangles_.push_back(textured);
}

/// At the hit as kernels compute it: the tracer's own (u, v) depend on how rays were packed.
float Opacity::opacity_of(const TexturedTriangle &triangle, const Vector3 &origin, const Vector3 &direction) const {
    const primitive_hit hit = triangle_hit(to_vec3(triangle.p0), to_vec3(triangle.e1), to_vec3(triangle.e2),
                                           to_vec3(origin), to_vec3(direction));
    const float weights[] = {1 - hit.u - hit.v, hit.u, hit.v};
    double at[2] = {0, 0};
    for (std::size_t corner = 0; corner < 3; ++corner)
        for (std::size_t axis = 0; axis < 2; ++axis)
            at[axis] += double(weights[corner]) * triangle.texcoords[corner][axis];
    const Texture &texture = textures_[triangle.texture];
    std::array<double, 3> value{};
    if (texture.kind == Texture::Kind::mesh_attribute) {
        for (std::size_t corner = 0; corner < 3; ++corner)
            for (std::size_t c = 0; c < 3; ++c)
                value[c] += double(weights[corner]) * triangle.attribute[corner][c];
        value = texture_finished(texture, value);
    } else {
        value = texture_value(texture, at[0], at[1]);
    }
    return float(0.2126 * value[0] + 0.7152 * value[1] + 0.0722 * value[2]);
}

bool Opacity::is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction) const {
    const Primitive &primitive = primitives_[i];
    const float opacity = primitive.textured < 0
                              ? primitive.opacity
                              : opacity_of(triangles_[std::size_t(primitive.textured)], origin, direction);
    return decide(primitive, opacity, origin, direction, 0);
}

bool Opacity::is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction, std::uint32_t instance,
                     const Matrix4 &to_world) const {
    const Primitive &primitive = primitives_[i];
    float opacity = primitive.opacity;
    if (primitive.textured >= 0) {
        TexturedTriangle placed = triangles_[std::size_t(primitive.textured)];
        placed.p0 = to_float(transform_point(to_world, to_double(placed.p0)));
        placed.e1 = to_float(transform_vector(to_world, to_double(placed.e1)));
        placed.e2 = to_float(transform_vector(to_world, to_double(placed.e2)));
        opacity = opacity_of(placed, origin, direction);
    }
    return decide(primitive, opacity, origin, direction, instance);
}

bool Opacity::decide(const Primitive &primitive, float opacity, const Vector3 &origin, const Vector3 &direction,
                     std::uint32_t instance) const {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    const random_bits first = random_hash(bits(origin.x), bits(origin.y), bits(origin.z), primitive.number);
    const random_bits both = random_hash(first.x ^ bits(direction.x), first.y ^ bits(direction.y),
                                         first.z ^ bits(direction.z), first.w ^ instance);
    return random_unit(both.x) < opacity;
}

} // namespace gradus
