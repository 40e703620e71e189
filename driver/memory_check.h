// Whether a render fits into memory, before it begins.
#pragma once

#include <cstdint>

namespace gradus {

struct RenderOptions;
struct Scene;

/// Bytes of host memory that rendering this scene takes at the least: its geometry and the ray tracer's tree, the film,
/// the image and the file that it is written as. What the method and the OpenCL implementation need comes to that.
std::uint64_t least_render_bytes(const Scene &scene, const RenderOptions &options);

/// Throws Error(ExitCode::device) where the machine, a container's limit or the process's address space have not as
/// much left.
void check_memory(const Scene &scene, const RenderOptions &options);

/// Before threads start: where the address space is limited none of them reserves a part of it for its own use.
void spare_address_space();

} // namespace gradus
