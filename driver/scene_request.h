// A scene as the command line asks for it: the file, its parameters, and what replaces the file's settings.
#pragma once

#include "driver/services.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace gradus {

struct SceneRequest {
    std::string path;
    std::vector<std::string> definitions; ///< "name=value"
    bool strict = false;
    bool confined = false;
    bool ignore_media = false;
    InstanceChoice instances = InstanceChoice::automatic;
    std::vector<std::string> allowed_folders;
    std::uint64_t limits = 1; ///< all limits of what a scene's files may take are so many times as high
    std::optional<std::array<std::uint32_t, 2>> size; ///< width, height
    std::optional<std::array<std::uint32_t, 4>> crop; ///< x, y, width, height
    std::optional<std::uint64_t> samples_per_pixel;
    std::optional<int> max_depth, rr_depth;
};

/// "WxH" with both from 1 to 65536. Throws Error(ExitCode::usage).
std::array<std::uint32_t, 2> parse_size(const std::string &text);
/// "X,Y,W,H" with W and H at least 1. Throws Error(ExitCode::usage).
std::array<std::uint32_t, 4> parse_crop(const std::string &text);
/// "name=value"; the value may be empty and may hold '='. Throws Error(ExitCode::usage).
std::pair<std::string, std::string> parse_definition(const std::string &text);

/// Adds SCENE and the options that fill `request` to a command.
void add_scene_options(CLI::App &command, SceneRequest &request);

/// Replaces the scene's settings by those asked for. A size drops the file's crop, which was for another size.
/// Throws Error(ExitCode::usage) for a crop that is not inside the film.
void apply_request(const SceneRequest &request, Scene &scene);

/// As asked for, but for a method that renders no instances: that has copies of them where the user leaves it open.
SceneRequest for_method(SceneRequest request, const std::string &method);

/// Loads the scene, hands each warning to `warn`, and applies the request. `files`: takes the names of all files that
/// were read. `phases`: where loading counts its time.
Scene load_requested_scene(const SceneRequest &request, const Services &services,
                           const std::function<void(const std::string &)> &warn,
                           std::vector<std::string> *files = nullptr, Phases *phases = nullptr);

} // namespace gradus
