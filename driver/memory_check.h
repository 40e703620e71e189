// Whether a render fits into memory, before it begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace gradus {

struct RenderOptions;
struct Scene;

/// What a method holds for each pixel at one time: its films, and what it reconstructs with. `auto`: the least of those
/// that it picks from.
std::uint64_t bytes_of_pixel(const std::string &method, const RenderOptions &options, std::uint64_t samples_per_pixel);
/// What it holds more where the pixel filter reaches beyond its pixel: samples around the image, and those of a frame.
std::uint64_t bytes_around(const Scene &scene, const std::string &method, const RenderOptions &options);

/// Bytes of memory that rendering this scene takes at the least: its geometry and the ray tracer's tree, the film and
/// the reconstruction, or the image and the file that it is written as. Batches and what the OpenCL implementation
/// needs come to that. On other devices than the host's processor a part of it lies there.
std::uint64_t least_render_bytes(const Scene &scene, const std::string &method, const RenderOptions &options);

/// Bytes that the control groups of this process let it still take: its own and those that this is in, of either
/// version. The largest number where nothing limits them. `groups`: the process's; `trees`: the folder that they are
/// found in.
std::uint64_t container_bytes(const std::filesystem::path &groups = "/proc/self/cgroup",
                              const std::filesystem::path &trees = "/sys/fs/cgroup");

/// Bytes that the machine, a container's limit and the address space of a process of so many threads (0: one for each
/// core) have left.
std::uint64_t bytes_left(int threads);

/// Throws Error(ExitCode::device) where rendering takes more than is left.
void check_memory(const Scene &scene, const std::string &method, const RenderOptions &options, std::uint64_t left);

/// The same for the method that `auto` chose, of which nothing was known before. `left`: before it was prepared.
void check_memory_of_choice(const Scene &scene, const std::string &method, const RenderOptions &options,
                            std::uint64_t left);

/// Before threads start: where the address space is limited none of them reserves a part of it for its own use.
void spare_address_space();

} // namespace gradus
