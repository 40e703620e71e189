#include "driver/memory_check.h"

#include "driver/scene_request.h"
#include "driver/scene_summary.h"
#include "kernels/lib/filter_table.h"
#include "methods/method.h"
#include "runtime/error.h"
#include "runtime/scene/filter_table.h"
#include "runtime/wavefront/sample_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

namespace gradus {

namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// The number in a file that has one; `unlimited` for all others ("max").
std::uint64_t number_in(const std::filesystem::path &path) {
    std::uint64_t number = 0;
    return std::ifstream(path) >> number ? number : unlimited;
}

/// The number that follows a name at the beginning of a line; nothing where there is none.
std::optional<std::uint64_t> number_of(const std::filesystem::path &path, const std::string &wanted) {
    std::ifstream file(path);
    std::uint64_t number = 0;
    for (std::string name, line; file >> name >> number; std::getline(file, line))
        if (name == wanted)
            return number;
    return std::nullopt;
}

/// What the system says may be had without swapping, and its swap.
std::uint64_t system_bytes() {
    const std::optional<std::uint64_t> available = number_of("/proc/meminfo", "MemAvailable:"),
                                       swap = number_of("/proc/meminfo", "SwapFree:");
    return available || swap ? (available.value_or(0) + swap.value_or(0)) << 10 : unlimited;
}

/// Of version 2 of control groups (cgroups), which has one tree for all, and of version 1, which has one for memory.
struct GroupFiles {
    const char *controllers; ///< as the list of a process's groups names the tree
    const char *folder;      ///< of the tree, in that of all
    const char *most, *used, *inactive_files;
};
constexpr GroupFiles versions_of_groups[] = {
    {"", "", "memory.max", "memory.current", "inactive_file"},
    {"memory", "memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"},
};

/// The path of a process's group in a tree; empty where it has none there.
std::filesystem::path group_in(const std::filesystem::path &groups, const std::string &controllers) {
    std::ifstream file(groups);
    std::string number, named, path; // of a line 4:memory:/user.slice
    while (std::getline(file, number, ':') && std::getline(file, named, ':') && std::getline(file, path))
        if (named == controllers)
            return path;
    return {};
}

/// What one group has left, those below it counted in.
std::uint64_t group_bytes(const std::filesystem::path &group, const GroupFiles &files) {
    const std::uint64_t most = number_in(group / files.most), used = number_in(group / files.used);
    if (most == unlimited || used == unlimited)
        return unlimited;
    // Files that were read, those of the scene too, are kept as long as nobody needs the room.
    const std::uint64_t cached = number_of(group / "memory.stat", files.inactive_files).value_or(0);
    return most - std::min(most, used - std::min(used, cached));
}

/// Of the process; `unlimited` where there is none.
std::uint64_t address_space_limit() {
    struct rlimit limit = {};
    return getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ? unlimited : limit.rlim_cur;
}

std::uint64_t address_space_bytes(int threads) {
    const std::uint64_t limit = address_space_limit();
    if (limit == unlimited)
        return unlimited;
    const std::uint64_t pages = number_in("/proc/self/statm");
    const std::uint64_t used = pages == unlimited ? 0 : pages * std::uint64_t(::sysconf(_SC_PAGESIZE));
    // Threads, PoCL and the compiler in it take this much; they end the process, or wait for ever, where they do not
    // get it (found by trying with PoCL 3.1).
    constexpr std::uint64_t implementation = 900u << 20;
    // Beyond two; PoCL's, TBB's and Embree's have a stack each. With 8 threads 1560 MB in all are enough, with 32 of
    // them 2150.
    constexpr std::uint64_t a_thread = 3 * (8u << 20);
    const auto all = std::uint64_t(threads > 0 ? threads : int(std::max(1u, std::thread::hardware_concurrency())));
    return limit - std::min(limit, used + implementation + a_thread * (all - std::min<std::uint64_t>(all, 2)));
}

} // namespace

std::uint64_t bytes_of_pixel(const std::string &method, const RenderOptions &options, std::uint64_t samples_per_pixel) {
    // As renders of growing size allocate (tests/driver/memory_check_test.cpp): films, or, where images are
    // reconstructed, rather the solver. Films of replicates, which tell variances, are most of --aov.
    const bool is_guided = options.reconstruction == Reconstruction::guided, has_parts = has_replicates(options);
    if (method == "sppm")
        return tells_variance(options) ? 164 : options.aov ? 106 : 28;
    if (method == "gpt" || method == "gpm")
        return has_parts                                      ? 570
               : !keeps_halves(options)                       ? 185
               : !halves_have_variances(samples_per_pixel, 1) ? 240 // the films: there is none but L1
               : is_guided                                    ? 480
                                                              : 330;
    if (is_guided)
        return samples_per_pixel >= 2 ? 300 : 106; // of one sample it is the mean
    return has_parts ? 140 : options.aov ? 80 : options.error ? 56 : 28;
}

std::uint64_t bytes_around(const Scene &scene, const std::string &method, const RenderOptions &options) {
    const std::uint64_t reach = filter_reach(scene.film);
    if (reach == 0)
        return 0;
    const auto [width, height] = image_size(scene.film);
    const std::uint64_t pixels = std::uint64_t(width) * height, sampled = (width + 2 * reach) * (height + 2 * reach);
    const bool has_differences = method == "gpt" || method == "gpm";
    const std::uint64_t parts = has_replicates(options) ? 4 : options.error || has_differences ? 2 : 1;
    // Films have rows for what is around, too, and a frame is kept of all.
    const std::uint64_t film = parts * (has_differences ? 136 : 28);
    const std::uint64_t frame = (has_differences ? 48 : 12) + (needs_features(options) ? 28 : 0);
    const std::uint64_t table = (filter_cells + 1) * (2 * (2 * reach + 1) + 1) * sizeof(float);
    return (sampled - pixels) * film + sampled * frame + table;
}

std::uint64_t least_render_bytes(const Scene &scene, const std::string &method, const RenderOptions &options) {
    std::uint64_t channels = 3;
    if (needs_features(options))
        channels += 3 + 3 + 1 + 3; // albedo, normal, depth, variance
    if (options.error)
        channels += 3;
    if (options.layers)
        channels += 4 * 3; // primal, dx, dy, direct
    if (options.layers && keeps_halves(options))
        channels += 12 * 3; // primal, dx, dy of both halves, and their variances
    const auto [width, height] = image_size(scene.film);
    const SceneSummary summary = summarize(scene);
    // An image is planes, and once more the bytes of its file; films may be gone by then. Pictures lie in the scene and
    // in the kernels' tables.
    const std::uint64_t of_pixel =
        std::max(bytes_of_pixel(method, options, scene.settings.samples_per_pixel), channels * 2 * sizeof(float));
    return summary.geometry_bytes + summary.instance_bytes + 2 * summary.texture_bytes + summary.tree_bytes +
           std::uint64_t(width) * height * of_pixel + bytes_around(scene, method, options);
}

std::uint64_t container_bytes(const std::filesystem::path &groups, const std::filesystem::path &trees) {
    std::uint64_t left = unlimited;
    for (const GroupFiles &files : versions_of_groups) {
        std::filesystem::path group = group_in(groups, files.controllers).relative_path();
        // The root too: within a container it may be the container's own group, and the path the host's.
        for (bool is_root = false; !is_root; group = group.parent_path()) {
            is_root = group.empty();
            left = std::min(left, group_bytes(trees / files.folder / group, files));
        }
    }
    return left;
}

std::uint64_t bytes_left(int threads) {
    return std::min({system_bytes(), container_bytes(), address_space_bytes(threads)});
}

namespace {

void check_room(const Scene &scene, const std::string &method, const RenderOptions &options, std::uint64_t left,
                const std::string &by, const char *advice) {
    const std::uint64_t needed = least_render_bytes(scene, method, options);
    if (needed <= left)
        return;
    const auto [width, height] = image_size(scene.film);
    throw Error(ExitCode::device,
                fmt::format("not enough memory: rendering {}x{} pixels{} takes {} MB at the least, and {} MB are left; "
                            "try {}a smaller --size, or a --crop",
                            width, height, by, (needed + (1 << 20) - 1) >> 20, left >> 20, advice));
}

} // namespace

void check_memory(const Scene &scene, const std::string &method, const RenderOptions &options, std::uint64_t left) {
    check_room(scene, method, options, left, "", "");
}

void check_memory_of_choice(const Scene &scene, const std::string &method, const RenderOptions &options,
                            std::uint64_t left) {
    if (method != "pt") // as little as any
        check_room(scene, method, options, left, fmt::format(" by {}, which was chosen,", method), "--method pt, ");
}

void spare_address_space() {
    // glibc reserves 64 MB for each thread that allocates, and next to nothing of it is used.
    if (address_space_limit() != unlimited)
        mallopt(M_ARENA_MAX, 1);
}

} // namespace gradus
