// The lights of a scene, one after the other, as kernels read them.
#pragma once

#include "kernels/shared/scene_records.h"
#include "runtime/scene/light_table.h"
#include "runtime/scene/light_tree.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/scene_tables.h"

#include <cstdint>
#include <map>
#include <vector>

namespace gradus {

/// Grows the tables of lights and, with them, the weights by which they are chosen.
class LightBuilder {
  public:
    /// has_textures: lights have.
    LightBuilder(const Scene &scene, SceneTables &tables, bool has_textures);

    /// A new light; returns its number and its record, which is there until the next one is added.
    std::uint32_t add(lib_float::light_kind kind, Rgb value, LightPower power, float *&record);
    /// Of a light that is one: its number among the triangles, or the spheres, of the scene.
    void set_triangle(std::uint32_t light, std::uint32_t triangle);
    void set_sphere(std::uint32_t light, std::uint32_t sphere);
    /// Of a light that is a part of its emitter: what the emitter's value is in the mean over all of it.
    void set_mean(std::uint32_t light, const Rgb &mean);
    /// The newest light is what rays find that leave the scene; light paths begin there with that power.
    void set_environment(double emitted);
    /// What an emitter's value is in the mean over its texture.
    Rgb mean_of(const Emitter &emitter);
    /// After the last: how often each is chosen.
    void finish(const LightTreeFrom &tree_from);

  private:
    void add_texture(const Emitter &emitter);
    TreeLight tree_light(std::uint32_t light);
    bool wants_tree(const LightTreeFrom &from) const;
    void grow_tree(const std::vector<double> &weights);

    const Scene &scene_;
    SceneTables &tables_;
    const bool has_textures_;
    std::vector<LightPower> powers_;
    std::vector<LightPower> emitted_; ///< what light paths begin with, which is known of lights at infinity too
    bool has_environment_ = false;
    std::map<std::int32_t, Rgb> means_; ///< by texture
    std::uint32_t stand_in_ = 0;        ///< a texture of lights, which those without one look up
};

} // namespace gradus
