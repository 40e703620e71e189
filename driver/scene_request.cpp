#include "driver/scene_request.h"

#include "driver/limits_option.h"
#include "driver/number_checks.h"
#include "driver/word_option.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>

namespace gradus {
namespace {

constexpr std::uint32_t largest_side = 65536;

/// Splits at `separator` into exactly `count` whole numbers; empty where the text is anything else.
std::vector<std::uint32_t> split_numbers(const std::string &text, char separator, std::size_t count) {
    std::vector<std::uint32_t> numbers;
    const char *at = text.data(), *end = at + text.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (i > 0) {
            if (at == end || *at != separator)
                return {};
            ++at;
        }
        std::uint32_t number = 0;
        const auto [stop, failure] = std::from_chars(at, end, number);
        if (failure != std::errc{})
            return {};
        numbers.push_back(number);
        at = stop;
    }
    return at == end ? numbers : std::vector<std::uint32_t>{};
}

[[noreturn]] void fail(const std::string &message) { throw Error(ExitCode::usage, message); }

/// Makes an option's parser report as CLI11 does, with the option's name.
template <typename Parse>
auto validated(Parse parse) {
    return [parse](const std::string &text) {
        try {
            parse(text);
            return std::string();
        } catch (const Error &error) {
            return std::string(error.what());
        }
    };
}

} // namespace

std::array<std::uint32_t, 2> parse_size(const std::string &text) {
    const auto numbers = split_numbers(text, 'x', 2);
    if (numbers.empty() || numbers[0] < 1 || numbers[1] < 1 || numbers[0] > largest_side || numbers[1] > largest_side)
        fail(fmt::format("'{}' is not a size: write WIDTHxHEIGHT, as in 640x480, at most {} each", text, largest_side));
    return {numbers[0], numbers[1]};
}

std::array<std::uint32_t, 4> parse_crop(const std::string &text) {
    const auto numbers = split_numbers(text, ',', 4);
    if (numbers.empty() || numbers[2] < 1 || numbers[3] < 1)
        fail(fmt::format("'{}' is not a crop: write X,Y,WIDTH,HEIGHT in pixels, as in 100,50,64,64", text));
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::pair<std::string, std::string> parse_definition(const std::string &text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        fail(fmt::format("'{}' is not a scene parameter: write NAME=VALUE", text));
    return {text.substr(0, equals), text.substr(equals + 1)};
}

void add_scene_options(CLI::App &command, SceneRequest &request) {
    command.add_option("SCENE", request.path, "Scene file, Mitsuba XML")->required();
    const char *group = "Scene";
    command
        .add_option("-D,--define", request.definitions, "Set a parameter of the scene file ($NAME there); repeatable")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false)
        ->check(validated(parse_definition))
        ->group(group);
    command.add_flag("--strict", request.strict, "Parameters that are not known are errors, not warnings")
        ->group(group);
    command
        .add_flag("--ignore-media", request.ignore_media,
                  "Render a scene with participating media as if these were empty")
        ->group(group);
    add_word_option<InstanceChoice>(
        command, "--instances",
        {{"auto", InstanceChoice::automatic}, {"copies", InstanceChoice::copies}, {"kept", InstanceChoice::kept}},
        request.instances, [&request](InstanceChoice choice) { request.instances = choice; },
        "Instances of groups: as shapes of their own where that is small, always (copies; so does gpm by default), "
        "never (kept)")
        ->group(group);
    CLI::Option *const confined =
        command
            .add_flag("--confined", request.confined,
                      "For scenes by strangers: read only files in the scene's folder and those of --allow")
            ->group(group);
    command
        .add_option("--allow", request.allowed_folders,
                    "With --confined: files in this folder may be read, too; repeatable")
        ->type_name("FOLDER")
        ->allow_extra_args(false)
        ->needs(confined)
        ->group(group);
    add_limits_option(command, request.limits, group);
    command
        .add_option_function<std::string>(
            "--size", [&request](const std::string &text) { request.size = parse_size(text); },
            "Size of the film; the field of view stays along its axis, the file's crop is dropped")
        ->type_name("WxH")
        ->check(validated(parse_size))
        ->group(group);
    command
        .add_option_function<std::string>(
            "--crop", [&request](const std::string &text) { request.crop = parse_crop(text); },
            "Render only this part of the film, in pixels from its top left")
        ->type_name("X,Y,W,H")
        ->check(validated(parse_crop))
        ->group(group);
    command
        .add_option("--max-depth", request.max_depth, "Edges of a path at most; 1: lights seen directly; -1: no limit")
        ->transform(whole_number_between(-1, 1 << 30))
        ->group(group);
    command.add_option("--rr-depth", request.rr_depth, "Russian roulette from this depth on")
        ->transform(whole_number_between(1, 1 << 30))
        ->group(group);
    command.add_option("--spp", request.samples_per_pixel, "Samples a pixel; without it what the file says")
        ->transform(whole_number_between(1, 1 << 30))
        ->group(group);
}

void apply_request(const SceneRequest &request, Scene &scene) {
    FilmSettings &film = scene.film;
    if (request.size) {
        film.width = (*request.size)[0];
        film.height = (*request.size)[1];
        film.crop_x = film.crop_y = film.crop_width = film.crop_height = 0;
    }
    if (request.crop) {
        const auto [x, y, width, height] = *request.crop;
        if (std::uint64_t(x) + width > film.width || std::uint64_t(y) + height > film.height)
            fail(fmt::format("the crop {},{},{},{} is not inside the film of {}x{}", x, y, width, height, film.width,
                             film.height));
        film.crop_x = x;
        film.crop_y = y;
        film.crop_width = width;
        film.crop_height = height;
    }
    if (request.samples_per_pixel)
        scene.settings.samples_per_pixel = *request.samples_per_pixel;
    if (request.max_depth) {
        if (*request.max_depth == 0)
            fail("--max-depth 0 would leave no path: write at least 1, or -1 for no limit");
        scene.settings.max_depth = *request.max_depth;
    }
    if (request.rr_depth)
        scene.settings.rr_depth = *request.rr_depth;
}

SceneRequest for_method(SceneRequest request, const std::string &method) {
    if (method == "gpm" && request.instances == InstanceChoice::automatic)
        request.instances = InstanceChoice::copies;
    return request;
}

Scene load_requested_scene(const SceneRequest &request, const Services &services,
                           const std::function<void(const std::string &)> &warn, std::vector<std::string> *files,
                           Phases *phases) {
    LoadOptions options;
    options.phases = phases;
    options.strict = request.strict;
    options.confined = request.confined;
    options.ignore_media = request.ignore_media;
    options.instances = request.instances;
    options.allowed_folders.assign(request.allowed_folders.begin(), request.allowed_folders.end());
    options.limits = LoadLimits().times(request.limits);
    for (const std::string &definition : request.definitions) {
        auto [name, value] = parse_definition(definition);
        options.parameters[name] = value;
    }
    LoadedScene loaded = services.load_scene(request.path, options);
    for (const std::string &warning : loaded.warnings)
        warn(warning);
    if (files)
        *files = loaded.files;
    apply_request(request, loaded.scene);
    return std::move(loaded.scene);
}

} // namespace gradus
