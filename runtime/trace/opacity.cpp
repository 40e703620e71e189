#include "runtime/trace/opacity.h"

#include "kernels/lib/primitive.h"
#include "kernels/lib/random.h"
#include "kernels/lib/surface_uv.h"
#include "runtime/scene/transform.h"

#include <algorithm>
#include <bit>

namespace gradus {

using namespace lib_float;

namespace {
Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
vec3 to_vec3(Vector3 v) { return v3(v.x, v.y, v.z); }
float luminance_of(const std::array<double, 3> &color) { return float(luminance(color[0], color[1], color[2])); }
} // namespace

bool is_passable(const Scene &scene, const Shape &shape) {
    const Number &opacity = scene.materials[shape.material].opacity;
    return shape.emitter < 0 && (opacity.texture != no_texture || opacity.value < 1);
}

bool has_passable_shapes(const Scene &scene) {
    return std::any_of(scene.shapes.begin(), scene.shapes.end(),
                       [&](const Shape &shape) { return is_passable(scene, shape); });
}

bool is_asked_about(const Scene &scene, const Shape &shape) {
    return is_passable(scene, shape) || (scene.settings.hide_emitters && shape.bears_emitter());
}

std::uint32_t Opacity::own_texture(const Scene &scene, std::int32_t texture) {
    const auto [known, is_new] = known_.emplace(texture, std::uint32_t(textures_.size()));
    if (is_new)
        textures_.push_back(scene.textures[std::size_t(texture)]);
    return known->second;
}

void Opacity::add(const Scene &scene, const Shape &shape, std::size_t triangle, std::uint32_t primitive) {
    const Number &opacity = scene.materials[shape.material].opacity;
    const bool is_sphere = shape.kind == Shape::Kind::sphere;
    const bool emits = shape.emitter >= 0;
    primitives_.push_back(
        {primitive, emits ? 1 : opacity.value, -1, Sphere::Side::both, is_sphere, shape.bears_emitter()});
    if (is_sphere)
        primitives_.back().side = scene.spheres[shape.geometry].side;
    if (opacity.texture == no_texture || emits)
        return;
    const std::uint32_t texture = own_texture(scene, opacity.texture);
    if (is_sphere) {
        const Sphere &sphere = scene.spheres[shape.geometry];
        const auto &[x, y, z] = sphere.axes;
        const TexturedSphere textured{
            texture, sphere.center, sphere.signed_radius(), {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}};
        primitives_.back().textured = std::int64_t(spheres_.size());
        spheres_.push_back(textured);
        return;
    }
    const Mesh &mesh = scene.meshes[shape.geometry];
    const auto &corners = mesh.triangles[triangle];
    TexturedTriangle textured{texture, mesh.positions[corners[0]], {}, {}, {{{0, 0}, {1, 0}, {0, 1}}}, {}};
    textured.e1 = mesh.positions[corners[1]] - textured.p0;
    textured.e2 = mesh.positions[corners[2]] - textured.p0;
    if (!mesh.texcoords.empty())
        for (std::size_t corner = 0; corner < 3; ++corner)
            textured.texcoords[corner] = mesh.texcoords[corners[corner]];
    if (const MeshAttribute *attribute = find_attribute(mesh, textures_[texture].attribute))
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
    return luminance_of(value);
}

float Opacity::opacity_of(const TexturedSphere &sphere, const Vector3 &origin, const Vector3 &direction) const {
    // Shadow rays are as long as their way.
    const vec3 unit_direction = v3_normalize(to_vec3(direction));
    const primitive_hit hit = sphere_hit(to_vec3(sphere.center), sphere.radius, 1, to_vec3(origin), unit_direction);
    const texture_point at = point_of_sphere(sphere_place(sphere.axes.data(), 1, 0, hit.normal));
    return luminance_of(texture_value(textures_[sphere.texture], at.u, at.v));
}

float Opacity::at(std::size_t i, const Vector3 &origin, const Vector3 &direction) const {
    const Primitive &primitive = primitives_[i];
    if (primitive.textured < 0)
        return primitive.opacity;
    const auto place = std::size_t(primitive.textured);
    return primitive.is_sphere ? opacity_of(spheres_[place], origin, direction)
                               : opacity_of(triangles_[place], origin, direction);
}

float Opacity::at(std::size_t i, const Vector3 &origin, const Vector3 &direction, const Matrix4 &to_world) const {
    const Primitive &primitive = primitives_[i];
    if (primitive.textured < 0)
        return primitive.opacity;
    TexturedTriangle placed = triangles_[std::size_t(primitive.textured)];
    placed.p0 = to_float(transform_point(to_world, to_double(placed.p0)));
    placed.e1 = to_float(transform_vector(to_world, to_double(placed.e1)));
    placed.e2 = to_float(transform_vector(to_world, to_double(placed.e2)));
    return opacity_of(placed, origin, direction);
}

bool Opacity::is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction, bool without_chance) const {
    const float opacity = at(i, origin, direction);
    return without_chance ? opacity > 0 : decide(primitives_[i], opacity, origin, direction, 0);
}

bool Opacity::is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction, bool without_chance,
                     std::uint32_t instance, const Matrix4 &to_world) const {
    const float opacity = at(i, origin, direction, to_world);
    return without_chance ? opacity > 0 : decide(primitives_[i], opacity, origin, direction, instance);
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
