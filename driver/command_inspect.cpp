#include "driver/commands.h"
#include "driver/scene_request.h"
#include "driver/scene_summary.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace gradus {
namespace {

using Traits = std::vector<std::pair<std::string, int>>;

std::string counts(const std::map<std::string, std::uint64_t> &kinds) {
    std::string text;
    for (const auto &[kind, count] : kinds)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, kind);
    return text.empty() ? "none" : text;
}

std::string mebibytes(std::uint64_t bytes) { return fmt::format("{:.1f} MiB", double(bytes) / double(1 << 20)); }

void print_text(const Scene &scene, const SceneSummary &summary, const Traits &traits) {
    const FilmSettings &film = scene.film;
    const auto [width, height] = image_size(film);
    const auto &low = summary.lower, &high = summary.upper;
    fmt::print("scene       {}\n", scene.path);
    fmt::print("shapes      {} meshes, {} spheres; {} triangles, {} vertices\n", summary.meshes, summary.spheres,
               summary.triangles, summary.vertices);
    fmt::print("bounds      ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", low[0], low[1], low[2], high[0],
               high[1], high[2]);
    fmt::print("materials   {}\n", counts(summary.materials));
    fmt::print("emitters    {}\n", counts(summary.emitters));
    fmt::print("camera      perspective, {:.6g} degrees along {}\n", scene.camera.fov, name_of(scene.camera.fov_axis));
    fmt::print("film        {}x{}, {} filter", film.width, film.height, name_of(film.filter));
    if (film.crop_width > 0)
        fmt::print(", crop {}x{} at {},{}", width, height, film.crop_x, film.crop_y);
    fmt::print("\n");
    fmt::print("settings    {} samples a pixel, max depth {}, Russian roulette from {}{}{}\n",
               scene.settings.samples_per_pixel,
               scene.settings.max_depth < 0 ? "unlimited" : std::to_string(scene.settings.max_depth),
               scene.settings.rr_depth, scene.settings.hide_emitters ? ", emitters hidden" : "",
               scene.settings.integrator.empty() ? "" : ", integrator " + scene.settings.integrator);
    fmt::print("memory      geometry {}, ray tracing about {}, film {}; a render adds its batch\n",
               mebibytes(summary.geometry_bytes), mebibytes(summary.tree_bytes), mebibytes(summary.film_bytes));
    fmt::print("traits      (each kernel is compiled for those of them that it declares)\n");
    for (const auto &[name, value] : traits)
        fmt::print("  {} = {}\n", name, value);
}

void print_json(const Scene &scene, const SceneSummary &summary, const Traits &traits) {
    const FilmSettings &film = scene.film;
    const auto [width, height] = image_size(film);
    nlohmann::json trait_object = nlohmann::json::object();
    for (const auto &[name, value] : traits)
        trait_object[name] = value;
    const nlohmann::json json{
        {"scene", scene.path},
        {"meshes", summary.meshes},
        {"spheres", summary.spheres},
        {"triangles", summary.triangles},
        {"vertices", summary.vertices},
        {"bounds", {{"lower", summary.lower}, {"upper", summary.upper}}},
        {"materials", summary.materials},
        {"emitters", summary.emitters},
        {"camera", {{"kind", "perspective"}, {"fov", scene.camera.fov}, {"fov_axis", name_of(scene.camera.fov_axis)}}},
        {"film",
         {{"width", film.width},
          {"height", film.height},
          {"crop", {film.crop_x, film.crop_y, width, height}},
          {"filter", name_of(film.filter)}}},
        {"settings",
         {{"samples_per_pixel", scene.settings.samples_per_pixel},
          {"max_depth", scene.settings.max_depth},
          {"rr_depth", scene.settings.rr_depth},
          {"hide_emitters", scene.settings.hide_emitters},
          {"integrator", scene.settings.integrator}}},
        {"memory",
         {{"geometry_bytes", summary.geometry_bytes},
          {"tree_bytes_estimated", summary.tree_bytes},
          {"film_bytes", summary.film_bytes}}},
        {"traits", trait_object}};
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

} // namespace

void add_inspect_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command =
        *app.add_subcommand("inspect", "Print what a scene holds, the traits that its kernels get, and its memory");
    struct Arguments {
        SceneRequest scene;
        bool json = false;
    };
    const auto arguments = std::make_shared<Arguments>();
    add_scene_options(command, arguments->scene);
    command.add_flag("--json", arguments->json, "Print JSON");
    command.callback([arguments, &services, &chosen] {
        chosen = [arguments, &services] {
            const Scene scene = load_requested_scene(arguments->scene, services, [](const std::string &warning) {
                fmt::print(stderr, "gradus: warning: {}\n", warning);
            });
            (arguments->json ? print_json : print_text)(scene, summarize(scene), services.traits(scene));
            return static_cast<int>(ExitCode::success);
        };
    });
}

} // namespace gradus
