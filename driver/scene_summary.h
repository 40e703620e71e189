// What a scene holds, counted.
#pragma once

#include "runtime/scene/scene.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace gradus {

struct SceneSummary {
    std::uint64_t meshes = 0, spheres = 0, triangles = 0, vertices = 0; ///< meshes and spheres as shapes
    std::map<std::string, std::uint64_t> materials; ///< by kind; "twosided KIND" for both sides alike, "mask KIND"
    std::map<std::string, std::uint64_t> textures;  ///< by kind
    std::map<std::string, std::uint64_t> emitters;  ///< by kind
    std::array<double, 3> lower{}, upper{};         ///< of all shapes, world space; 0 without any
    std::uint64_t geometry_bytes = 0;               ///< vertices and indices
    std::uint64_t table_bytes = 0;                  ///< what of triangles and spheres is laid out for kernels
    std::uint64_t group_triangles = 0;              ///< of those, what instances share
    std::uint64_t seen_triangles = 0;               ///< as often as they are seen
    std::uint64_t instance_bytes = 0;               ///< what instances take beside records among the tables
    std::uint64_t texture_bytes = 0;                ///< pictures, each once, and the environment's map
    std::uint64_t tree_bytes = 0;                   ///< the ray tracer's tree and vertices, estimated
};

/// The names that Mitsuba files have for them.
const char *name_of(Emitter::Kind kind);
const char *name_of(Texture::Kind kind);
const char *name_of(FilmSettings::Filter filter);
const char *name_of(Camera::Kind kind);
const char *name_of(Camera::FovAxis axis);

SceneSummary summarize(const Scene &scene);

} // namespace gradus
