// A scene as text, number by number, so that tests can tell whether two are alike.
#pragma once

#include "runtime/scene/environment_map.h"
#include "runtime/scene/scene.h"

#include <string>

namespace gradus {

class ScenePrint {
  public:
    explicit ScenePrint(const Scene &scene) {
        print(scene.camera);
        const FilmSettings &film = scene.film;
        numbers({double(film.width), double(film.height), double(film.crop_x), double(film.crop_y),
                 double(film.crop_width), double(film.crop_height), double(film.filter), film.filter_radius,
                 film.filter_stddev, film.mitchell_b, film.mitchell_c});
        const RenderSettings &settings = scene.settings;
        numbers({double(settings.max_depth), double(settings.rr_depth), double(settings.hide_emitters),
                 double(settings.samples_per_pixel)});
        for (const Material &material : scene.materials) {
            print(material.front);
            print(material.back);
            number(material.two_sided);
            value(material.opacity);
        }
        for (const Bsdf &bsdf : scene.blended)
            print(bsdf);
        for (const Blend &blend : scene.blends)
            value(blend.weight);
        for (const Texture &texture : scene.textures)
            print(texture);
        for (const Emitter &emitter : scene.emitters)
            print(emitter);
        for (const Sphere &sphere : scene.spheres) {
            vectors({sphere.center, sphere.axes[0], sphere.axes[1], sphere.axes[2]});
            numbers({sphere.radius, double(sphere.flip_normals)});
        }
        for (const Mesh &mesh : scene.meshes)
            print(mesh);
        for (const Shape &shape : scene.shapes)
            numbers({double(shape.kind), double(shape.geometry), double(shape.material), double(shape.emitter)});
    }
    const std::string &text() const { return text_; }

  private:
    void number(double value) { text_ += std::to_string(value) + " "; }
    template <typename List>
    void list(const List &values) {
        for (const auto value : values)
            number(double(value));
        text_ += "\n";
    }
    void numbers(std::initializer_list<double> values) { list(values); }
    void vectors(std::initializer_list<Vector3> values) {
        for (const Vector3 &v : values)
            numbers({v.x, v.y, v.z});
    }
    void value(const Color &color) { numbers({color.r, color.g, color.b, double(color.texture)}); }
    void value(const Number &one) { numbers({one.value, double(one.texture)}); }

    void print(const Camera &camera) {
        list(camera.to_world.m);
        numbers({camera.fov, double(camera.fov_axis), double(camera.kind), camera.principal_x, camera.principal_y,
                 camera.near_clip, camera.far_clip, camera.aperture_radius, camera.focus_distance});
    }
    void print(const Bsdf &bsdf) {
        numbers({double(bsdf.kind), double(bsdf.blend)});
#define GRADUS_PRINT(with, name, default_value, description) value(bsdf.name);
        GRADUS_MATERIAL_PARAMETERS(GRADUS_PRINT, GRADUS_PRINT, )
#undef GRADUS_PRINT
        const NormalTexture &map = bsdf.map;
        numbers({double(map.kind), double(map.texture), map.scale, double(map.turns_over), double(map.shadows)});
    }
    void print(const Texture &texture) {
        numbers({double(texture.kind), double(texture.is_nearest), double(texture.is_srgb), double(texture.wrap),
                 double(texture.wrap_along_v()), texture.lowest, texture.highest});
        list(texture.to_uv);
        list(texture.color_0);
        list(texture.color_1);
        list(texture.scale);
        text_ += texture.attribute + "\n";
        if (texture.bitmap) {
            numbers({double(texture.bitmap->width), double(texture.bitmap->height)});
            list(texture.bitmap->words);
        }
    }
    void print(const Emitter &emitter) {
        numbers({double(emitter.kind), emitter.value.r, emitter.value.g, emitter.value.b, double(emitter.texture),
                 emitter.cutoff, emitter.beam, emitter.picture[0], emitter.picture[1]});
        vectors({emitter.position, emitter.direction, emitter.axes[0], emitter.axes[1], emitter.axes[2]});
        if (emitter.map)
            numbers({emitter.map->integral.r, emitter.map->integral.g, emitter.map->integral.b});
    }
    void print(const Mesh &mesh) {
        for (const auto *places : {&mesh.positions, &mesh.normals})
            for (const Vector3 &v : *places)
                vectors({v});
        for (const auto &texcoord : mesh.texcoords)
            list(texcoord);
        for (const auto &triangle : mesh.triangles)
            list(triangle);
        for (const MeshAttribute &attribute : mesh.attributes) {
            text_ += attribute.name + "\n";
            list(attribute.values);
        }
    }

    std::string text_;
};

} // namespace gradus
