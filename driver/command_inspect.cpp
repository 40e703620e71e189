#include "driver/commands.h"
#include "driver/memory_check.h"
#include "driver/number_checks.h"
#include "driver/output_files.h"
#include "driver/phase_watch.h"
#include "driver/scene_request.h"
#include "driver/scene_summary.h"
#include "driver/standard_streams.h"
#include "methods/method.h"
#include "runtime/error.h"
#include "runtime/scene/roughness.h"

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

/// Where photon methods gather photons with --gather-roughness.
std::string gathering_text(const GatheringSurfaces &surfaces, double roughness) {
    return fmt::format("photons     gathered at {}; camera and light paths go on at {} (roughness {} or more)\n",
                       counts(surfaces.gathered), counts(surfaces.passed), roughness);
}

std::string camera_text(const Camera &camera) {
    std::string text = name_of(camera.kind);
    if (camera.kind != Camera::Kind::orthographic)
        text += fmt::format(", {:.6g} degrees along {}", camera.fov, name_of(camera.fov_axis));
    if (camera.kind == Camera::Kind::thin_lens)
        text += fmt::format(", aperture radius {:.6g}, focus at {:.6g}", camera.aperture_radius, camera.focus_distance);
    if (camera.principal_x != 0 || camera.principal_y != 0)
        text += fmt::format(", principal point off by ({:.6g}, {:.6g})", camera.principal_x, camera.principal_y);
    return text;
}

nlohmann::json camera_json(const Camera &camera) {
    nlohmann::json json{{"kind", name_of(camera.kind)}};
    if (camera.kind != Camera::Kind::orthographic) {
        json["fov"] = camera.fov;
        json["fov_axis"] = name_of(camera.fov_axis);
        json["principal_point_offset"] = {camera.principal_x, camera.principal_y};
    }
    if (camera.kind == Camera::Kind::thin_lens) {
        json["aperture_radius"] = camera.aperture_radius;
        json["focus_distance"] = camera.focus_distance;
    }
    return json;
}

/// What the method holds for all pixels, with its own reconstruction.
std::uint64_t image_bytes(const Scene &scene, const std::string &method) {
    const auto [width, height] = image_size(scene.film);
    return std::uint64_t(width) * height * bytes_of_pixel(method, {}, scene.settings.samples_per_pixel) +
           bytes_around(scene, method, {});
}

std::string summary_text(const Scene &scene, const SceneSummary &summary, const Traits &traits, double roughness) {
    std::string text;
    const FilmSettings &film = scene.film;
    const auto [width, height] = image_size(film);
    const auto &low = summary.lower, &high = summary.upper;
    text += fmt::format("scene       {}\n", scene.path);
    text += fmt::format("shapes      {} meshes, {} spheres; {} triangles, {} vertices\n", summary.meshes,
                        summary.spheres, summary.triangles, summary.vertices);
    if (!scene.instances.empty())
        text += fmt::format(
            "instances   {} of {} groups, which have {} triangles; {} triangles as often as they are seen\n",
            scene.instances.size(), scene.groups, summary.group_triangles, summary.seen_triangles);
    if (scene.copied_instances > 0)
        text += fmt::format("copies      {} instances, which are among the shapes\n", scene.copied_instances);
    text += fmt::format("bounds      ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", low[0], low[1], low[2],
                        high[0], high[1], high[2]);
    text += fmt::format("materials   {}\n", counts(summary.materials));
    if (!summary.textures.empty())
        text += fmt::format("textures    {}\n", counts(summary.textures));
    text += gathering_text(gathering_surfaces(scene, roughness), roughness);
    text += fmt::format("emitters    {}\n", counts(summary.emitters));
    text += fmt::format("camera      {}\n", camera_text(scene.camera));
    text += fmt::format("film        {}x{}, {} filter", film.width, film.height, name_of(film.filter));
    if (film.crop_width > 0)
        text += fmt::format(", crop {}x{} at {},{}", width, height, film.crop_x, film.crop_y);
    text += fmt::format("\n");
    text += fmt::format("settings    {} samples a pixel, max depth {}, Russian roulette from {}{}{}\n",
                        scene.settings.samples_per_pixel,
                        scene.settings.max_depth < 0 ? "unlimited" : std::to_string(scene.settings.max_depth),
                        scene.settings.rr_depth, scene.settings.hide_emitters ? ", emitters hidden" : "",
                        scene.settings.integrator.empty() ? "" : ", integrator " + scene.settings.integrator);
    text += fmt::format("memory      geometry {}, its tables {}, ", mebibytes(summary.geometry_bytes),
                        mebibytes(summary.table_bytes));
    if (summary.instance_bytes > 0)
        text += fmt::format("instances {}, ", mebibytes(summary.instance_bytes));
    if (summary.texture_bytes > 0)
        text += fmt::format("textures and maps {}, ", mebibytes(summary.texture_bytes));
    text +=
        fmt::format("ray tracing about {}; an image by pt {}, by gpt {}, and a batch\n", mebibytes(summary.tree_bytes),
                    mebibytes(image_bytes(scene, "pt")), mebibytes(image_bytes(scene, "gpt")));
    text += fmt::format("traits      (each kernel is compiled for those of them that it declares)\n");
    for (const auto &[name, value] : traits)
        text += fmt::format("  {} = {}\n", name, value);
    return text;
}

std::string summary_json(const Scene &scene, const SceneSummary &summary, const Traits &traits, double roughness) {
    const GatheringSurfaces surfaces = gathering_surfaces(scene, roughness);
    const FilmSettings &film = scene.film;
    const auto [width, height] = image_size(film);
    nlohmann::json trait_object = nlohmann::json::object();
    for (const auto &[name, value] : traits)
        trait_object[name] = value;
    const nlohmann::json json{
        {"scene", scene.path},
        {"meshes", summary.meshes},
        {"spheres", summary.spheres},
        {"instances", scene.instances.size() + scene.copied_instances},
        {"kept_instances", scene.instances.size()},
        {"groups", scene.groups},
        {"seen_triangles", summary.seen_triangles},
        {"triangles", summary.triangles},
        {"vertices", summary.vertices},
        {"bounds", {{"lower", summary.lower}, {"upper", summary.upper}}},
        {"materials", summary.materials},
        {"textures", summary.textures},
        {"gathering", {{"roughness", roughness}, {"gathered_at", surfaces.gathered}, {"passed_at", surfaces.passed}}},
        {"emitters", summary.emitters},
        {"camera", camera_json(scene.camera)},
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
          {"table_bytes", summary.table_bytes},
          {"instance_bytes", summary.instance_bytes},
          {"texture_bytes", summary.texture_bytes},
          {"tree_bytes_estimated", summary.tree_bytes},
          {"image_bytes", {{"pt", image_bytes(scene, "pt")}, {"gpt", image_bytes(scene, "gpt")}}}}},
        {"traits", trait_object}};
    return json_text(json);
}

} // namespace

void add_inspect_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command =
        *app.add_subcommand("inspect", "Print what a scene holds, the traits that its kernels get, and its memory");
    struct Arguments {
        SceneRequest scene;
        bool json = false;
        double gather_roughness = RenderOptions().gather_roughness;
    };
    const auto arguments = std::make_shared<Arguments>();
    command.footer("Examples:\n"
                   "  gradus inspect scene.xml                  shapes, materials, lights, camera, memory, traits\n"
                   "  gradus inspect scene.xml -D spp=16        with a parameter of the file set\n"
                   "  gradus inspect scene.xml --json           the same for programs");
    add_scene_options(command, arguments->scene);
    command.add_flag("--json", arguments->json, "Print JSON");
    command
        .add_option("--gather-roughness", arguments->gather_roughness,
                    "Roughness (alpha) from which on photon methods gather photons at a surface")
        ->check(number_between(0, 1))
        ->capture_default_str();
    command.callback([arguments, &services, &chosen] {
        chosen = [arguments, &services] {
            Progress progress(Progress::choose_mode(false, stderr));
            Phases phases;
            const Scene scene = [&] {
                const PhaseWatch watch(phases, progress);
                const auto warn = [&](const std::string &text) { progress.message("gradus: warning: " + text); };
                return load_requested_scene(arguments->scene, services, warn, nullptr, &phases);
            }();
            print_result((arguments->json ? summary_json : summary_text)(
                scene, summarize(scene), services.traits(scene), arguments->gather_roughness));
            return static_cast<int>(ExitCode::success);
        };
    });
}

} // namespace gradus
