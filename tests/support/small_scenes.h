// Small scenes built in code, for tests of scenes, stages and methods.
#pragma once

#include "runtime/scene/environment_map.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"
#include "tests/support/materials.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace gradus::testing {

/// A ball of some facets, with the ball's normals where `smooth`.
inline Mesh coarse_ball(const Vector3 &center, double radius, bool smooth, std::uint32_t stacks = 6,
                        std::uint32_t slices = 9) {
    Mesh mesh;
    for (std::uint32_t i = 0; i <= stacks; ++i)
        for (std::uint32_t j = 0; j < slices; ++j) {
            const double polar = std::numbers::pi * i / stacks, around = 2 * std::numbers::pi * j / slices;
            const Vector3 normal{float(std::sin(polar) * std::cos(around)), float(std::cos(polar)),
                                 float(std::sin(polar) * std::sin(around))};
            mesh.positions.push_back({float(center.x + radius * normal.x), float(center.y + radius * normal.y),
                                      float(center.z + radius * normal.z)});
            if (smooth)
                mesh.normals.push_back(normal);
        }
    for (std::uint32_t i = 0; i < stacks; ++i)
        for (std::uint32_t j = 0; j < slices; ++j) {
            const std::uint32_t next = (j + 1) % slices, a = i * slices + j, b = i * slices + next;
            const std::uint32_t c = a + slices, d = b + slices;
            if (i > 0)
                mesh.triangles.push_back({a, b, c});
            if (i + 1 < stacks)
                mesh.triangles.push_back({b, d, c});
        }
    return mesh;
}

/// Grows a scene. The functions return the index of what they add.
struct SceneMaker {
    Scene scene;

    /// A square film with the box filter, nothing cropped; no limit to the depth, no Russian roulette.
    SceneMaker(std::uint32_t size, std::uint64_t samples_per_pixel) {
        scene.film.width = scene.film.height = size;
        scene.film.filter = FilmSettings::Filter::box;
        scene.film.filter_radius = 0.5f;
        scene.settings.max_depth = -1;
        scene.settings.rr_depth = -1;
        scene.settings.samples_per_pixel = samples_per_pixel;
    }

    void look(const Double3 &from, const Double3 &at, double fov, const Double3 &up = {0, 1, 0}) {
        scene.camera.to_world = look_at(from, at, up);
        scene.camera.fov = fov;
    }
    std::uint32_t material(const Material &material) {
        scene.materials.push_back(material);
        return std::uint32_t(scene.materials.size() - 1);
    }
    std::uint32_t material(const Bsdf &bsdf) { return material(material_of(bsdf)); }
    std::int32_t emitter(Emitter::Kind kind, Rgb value) {
        Emitter emitter;
        emitter.kind = kind;
        emitter.value = value;
        scene.emitters.push_back(emitter);
        return std::int32_t(scene.emitters.size() - 1);
    }
    void environment(double radiance) {
        emitter(Emitter::Kind::constant, {float(radiance), float(radiance), float(radiance)});
    }
    void point_light(Rgb intensity, Vector3 position) {
        scene.emitters[std::size_t(emitter(Emitter::Kind::point, intensity))].position = position;
    }
    /// `direction`, of any length: the way that light travels.
    void directional_light(Rgb irradiance, Vector3 direction) {
        const float length =
            std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
        scene.emitters[std::size_t(emitter(Emitter::Kind::directional, irradiance))].direction = {
            direction.x / length, direction.y / length, direction.z / length};
    }
    /// An environment map of grey texels, by `radiance(column, row)`.
    template <class Radiance>
    void environment_map(std::uint32_t columns, std::uint32_t rows, const Radiance &radiance) {
        std::vector<float> texels;
        for (std::uint32_t row = 0; row < rows; ++row)
            for (std::uint32_t column = 0; column < columns; ++column)
                texels.push_back(float(radiance(column, row)));
        scene.emitters[std::size_t(emitter(Emitter::Kind::environment, {1, 1, 1}))].map =
            std::make_shared<const EnvironmentMap>(make_environment_map(columns, rows, texels, texels, texels));
    }
    /// Angles in degrees.
    void spot(Rgb intensity, Vector3 position, Vector3 direction, double beam, double cutoff) {
        Emitter &spot = scene.emitters[std::size_t(emitter(Emitter::Kind::spot, intensity))];
        spot.position = position;
        spot.direction = direction;
        spot.beam = float(beam * std::numbers::pi / 180);
        spot.cutoff = float(cutoff * std::numbers::pi / 180);
    }
    /// A spot or a projector that throws a texture straight down, so wide and high at distance 1.
    Emitter &picture(Emitter::Kind kind, Rgb value, std::size_t texture, Vector3 position, float width, float height) {
        Emitter &thrower = scene.emitters[std::size_t(emitter(kind, value))];
        thrower.texture = std::int32_t(texture);
        thrower.position = position;
        thrower.axes = {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}};
        thrower.direction = thrower.axes[2];
        thrower.picture = {width, height};
        return thrower;
    }
    void shape(Shape::Kind kind, std::size_t geometry, std::uint32_t material, std::int32_t emitter) {
        Shape shape;
        shape.kind = kind;
        shape.geometry = std::uint32_t(geometry);
        shape.material = material;
        shape.emitter = emitter;
        shape.name = "shape " + std::to_string(scene.shapes.size());
        scene.shapes.push_back(shape);
    }
    void sphere(Vector3 center, float radius, std::uint32_t material, std::int32_t emitter = -1, bool flip = false) {
        scene.spheres.push_back({center, radius, flip});
        shape(Shape::Kind::sphere, scene.spheres.size() - 1, material, emitter);
    }
    /// A parallelogram with corners p, p + u, p + u + v, p + v; its front is where u x v points.
    void parallelogram(Vector3 p, Vector3 u, Vector3 v, std::uint32_t material, std::int32_t emitter = -1) {
        Mesh mesh;
        add_parallelogram(mesh, p, u, v);
        scene.meshes.push_back(mesh);
        shape(Shape::Kind::mesh, scene.meshes.size() - 1, material, emitter);
    }
    /// A floor with its front upwards: x from x0 to x1, z from -extent to extent.
    void floor(float x0, float x1, float extent, std::uint32_t material, float y = 0) {
        parallelogram({x0, y, -extent}, {0, 0, 2 * extent}, {x1 - x0, 0, 0}, material);
    }
    /// A rectangle that shines downwards: x over the width, z over the depth.
    void lamp(Vector3 center, float width, float depth, float radiance, std::uint32_t material) {
        parallelogram({center.x - width / 2, center.y, center.z - depth / 2}, {width, 0, 0}, {0, 0, depth}, material,
                      emitter(Emitter::Kind::area, {radiance, radiance, radiance}));
    }
    /// The cube [-1, 1]^3, its front inside where `inward`. Its sides have texture coordinates, so that anisotropic
    /// roughness has a direction.
    void cube(std::uint32_t material, std::int32_t emitter = -1, bool inward = false) {
        Mesh mesh;
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {-1.0f, 1.0f}) {
                std::array<float, 3> corner{-1, -1, -1}, u{}, v{};
                corner[axis] = side;
                u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2; // u x v is the positive axis
                const bool along_axis = (side > 0) != inward;
                const auto &first = along_axis ? u : v, &second = along_axis ? v : u;
                add_parallelogram(mesh, {corner[0], corner[1], corner[2]}, {first[0], first[1], first[2]},
                                  {second[0], second[1], second[2]});
            }
        scene.meshes.push_back(mesh);
        shape(Shape::Kind::mesh, scene.meshes.size() - 1, material, emitter);
    }

  private:
    static void add_parallelogram(Mesh &mesh, Vector3 p, Vector3 u, Vector3 v) {
        const auto first = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {p,
                                                     {p.x + u.x, p.y + u.y, p.z + u.z},
                                                     {p.x + u.x + v.x, p.y + u.y + v.y, p.z + u.z + v.z},
                                                     {p.x + v.x, p.y + v.y, p.z + v.z}});
        const std::array<float, 2> corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        mesh.texcoords.insert(mesh.texcoords.end(), std::begin(corners), std::end(corners));
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
};

} // namespace gradus::testing
