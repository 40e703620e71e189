// Whether a render fits into memory, before it begins.
#pragma once

#include <cstdint>
#include <string>

namespace gradus {

struct RenderOptions;
struct Scene;

/// What a method holds for each pixel at one time: its films, and what it reconstructs with. `auto`: the least of those
/// that it picks from.
std::uint64_t bytes_of_pixel(const std::string &method, const RenderOptions &options, std::uint64_t samples_per_pixel);

/// Bytes of memory that rendering this scene takes at the least: its geometry and the ray tracer's tree, the film and
/// the reconstruction, or the image and the file that it is written as. Batches and what the OpenCL implementation
/// needs come to that. On other devices than the host's processor a part of it lies there.
std::uint64_t least_render_bytes(const Scene &scene, const std::string &method, const RenderOptions &options);

/// Throws Error(ExitCode::device) where the machine, a container's limit or the process's address space have not as
/// much left.
void check_memory(const Scene &scene, const std::string &method, const RenderOptions &options);

/// Before threads start: where the address space is limited none of them reserves a part of it for its own use.
void spare_address_space();

} // namespace gradus
