// What reading a scene may take. A file of a few megabytes could else ask for any amount of work and memory: by
// parameters that stand for each other, includes that branch, streams that unfold a thousandfold, meshes that are named
// again and again. What people and exporters write stays far below.
#pragma once

#include <cstdint>
#include <initializer_list>

namespace gradus {

struct LoadLimits {
    std::uint64_t xml_bytes = 512u << 20;     ///< of scene files; an included one counts as often as it is included
    std::uint64_t includes = 1000;            ///< <include> elements that are followed
    std::uint64_t elements = 8'000'000;       ///< of all scene files together
    std::uint64_t value_bytes = 1u << 20;     ///< of one attribute in which a $parameter stands
    std::uint64_t expanded_bytes = 64u << 20; ///< of all text that $parameters stand for
    std::uint64_t mesh_bytes = 4ull << 30;    ///< of mesh files, as often as shapes read them; compressed ones unfolded
    std::uint64_t geometry_bytes = 4ull << 30; ///< of vertices and triangles of all shapes
    std::uint64_t texture_bytes = 4ull << 30;  ///< of all textures' pixels, as they are kept
    std::uint64_t blend_parts = 1000;          ///< BSDFs in one blend, as often as it holds them
    std::uint64_t blended = 200'000;           ///< BSDFs in all blends together
    std::uint64_t unfolding = 64;              ///< how many times its size a compressed mesh may unfold to, ...
    std::uint64_t unfolded_bytes = 64u << 20;  ///< ... if that is more than this
    std::uint64_t images = 1;                  ///< times what read_image() takes

    LoadLimits times(std::uint64_t factor) const {
        LoadLimits more = *this;
        for (std::uint64_t *limit :
             {&more.xml_bytes, &more.includes, &more.elements, &more.value_bytes, &more.expanded_bytes,
              &more.mesh_bytes, &more.geometry_bytes, &more.texture_bytes, &more.blend_parts, &more.blended,
              &more.unfolding, &more.unfolded_bytes, &more.images})
            *limit *= factor;
        return more;
    }
};

/// Ends each message about a limit.
inline constexpr const char *limits_hint = "; --limits 10 allows ten times as much";

} // namespace gradus
