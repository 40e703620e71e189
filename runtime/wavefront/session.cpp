#include "runtime/wavefront/session.h"

#include "kernels/shared/tables.h"
#include "kernels/shared/texture.h"
#include "runtime/error.h"
#include "runtime/phases.h"
#include "runtime/scene/environment_map.h"
#include "runtime/scene/vertex_table.h"
#include "runtime/wavefront/invariant_division.h"
#include "runtime/wavefront/sample_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace gradus {

namespace {

constexpr std::size_t most_material_classes = 8;
constexpr std::size_t most_few_textures = 8;      // kernels/lib/texture_lookup.h
constexpr std::uint32_t most_few_lights = 4;      // kernels/lib/light_sampling.h chooses among so many
constexpr std::uint32_t least_many_lights = 4097; // 24 bits choose among fewer with an error of 2e-4 at most
// bench/render/lights.py: lamps that are scattered gain from few of them on, and no scene of so many lights loses much.
constexpr LightTreeFrom usual_light_tree{.lights = 4096, .emitters = 16};
constexpr std::uint32_t deepest = 1u << 16; // where a file asks for paths without end

TraitMap traits_for(const Scene &scene, const SessionOptions &options, const TraitMap &of_method) {
    TraitMap traits = scene_traits(scene);
    traits["TRAIT_AOV"] = options.aov;
    if (options.all_traits)
        traits = with_all_traits(traits);
    if (options.by_index)
        traits["TRAIT_INDEXED"] = indexed_trait(traits, std::numeric_limits<std::size_t>::max());
    // Settings of a method, which no scene has.
    traits["TRAIT_SHARED_START"] = 0;
    traits["TRAIT_STRATIFIED"] = options.sampler == SessionOptions::Sampler::sobol;
    traits["TRAIT_LOBE_LEVELS"] = 0;
    traits["TRAIT_OPACITY"] = 0;
    traits["TRAIT_PART_BITS"] = part_bits(options, false);
    traits["TRAIT_GRADIENT"] = 0;
    traits["TRAIT_LIGHT_VERTICES"] = 0;
    traits["TRAIT_LIGHT_STARTS"] = 0;
    traits["STRATEGY"] = static_cast<int>(options.strategy);
    traits["KINDS_BY_CLASS"] = 0;
    for (const auto &[name, value] : of_method)
        traits[name] = value;
    // Where paths start alike, and where samples serve the pixels around (runtime/scene/filter_table.h).
    traits["TRAIT_SHARED_JITTER"] = traits["TRAIT_SHARED_START"] || traits["TRAIT_FILTER"];
    if (options.all_traits || traits["TRAIT_MATERIAL"] == 0)
        traits["KINDS_BY_CLASS"] = 0;
    // Features are seen through mirrors and glass (kernels/lib/seen_features.h).
    if (traits["TRAIT_AOV"] != 0)
        traits["TRAIT_AOV"] = options.all_traits || has_dirac_bsdf(scene) ? 2 : 1;
    return traits;
}

LightTreeFrom tree_from(SessionOptions::Lights lights) {
    return lights == SessionOptions::Lights::power  ? LightTreeFrom{}
           : lights == SessionOptions::Lights::tree ? LightTreeFrom{.lights = 1}
                                                    : usual_light_tree;
}

FilmSettings with_crop(FilmSettings film) {
    if (film.crop_width == 0 || film.crop_height == 0) {
        film.crop_x = film.crop_y = 0;
        film.crop_width = film.width;
        film.crop_height = film.height;
    }
    if (film.width == 0 || film.height == 0 || std::uint64_t(film.crop_x) + film.crop_width > film.width ||
        std::uint64_t(film.crop_y) + film.crop_height > film.height)
        throw Error(ExitCode::usage,
                    fmt::format("the crop {}x{} at {},{} does not lie in the film of {}x{}", film.crop_width,
                                film.crop_height, film.crop_x, film.crop_y, film.width, film.height));
    const std::uint64_t around = 2 * std::uint64_t(filter_reach(film));
    if ((film.width + around) * (film.height + around) >= std::numeric_limits<std::int32_t>::max())
        throw Error(ExitCode::usage, fmt::format("a film of {}x{} has too many pixels", film.width, film.height));
    return film;
}

/// What is of triangles and primitives, with TRAIT_INDEXED (kernels/shared/scene_records.h).
void add_vertex_buffers(Device &device, const SceneTables &t, Precision precision, std::vector<Buffer> &buffers) {
    if (precision == Precision::double_) {
        // Indices are as they were, before vertices at twice the place.
        std::vector<double> wide(t.triangles.size());
        const std::size_t first = std::size_t(t.first_vertex) * t.vertex_numbers;
        std::memcpy(wide.data(), t.triangles.data(), first * sizeof(float));
        std::copy(t.triangles.begin() + std::ptrdiff_t(first), t.triangles.end(), wide.begin() + std::ptrdiff_t(first));
        buffers.emplace_back(device, "triangles", wide.data(), wide.size() * sizeof(double));
    } else {
        buffers.push_back(Buffer::over(device, "triangles", t.triangles.data(), t.triangles.size() * sizeof(float)));
    }
    const Buffer triangles = buffers.back();
    for (const char *name : {"triangle_normals", "triangle_tangents", "triangle_texcoords"})
        buffers.push_back(triangles.named(name));
    const std::vector<std::uint32_t> &surfaces = t.primitive_surface;
    buffers.push_back(
        Buffer::over(device, "primitive_material", surfaces.data(), surfaces.size() * sizeof(surfaces[0])));
    const Buffer primitives = buffers.back();
    for (const char *name : {"primitive_light", "primitive_bin", "primitive_back_bin"})
        buffers.push_back(primitives.named(name));
}

/// The tables must outlive them.
std::vector<Buffer> make_scene_buffers(Device &device, const SceneTables &t, Precision precision) {
    std::vector<Buffer> buffers;
    const auto check = [](const char *name, std::size_t elements) {
        if (elements > std::size_t(std::numeric_limits<std::int32_t>::max())) // FIELD_OF in scene_records.h
            throw Error(ExitCode::device,
                        fmt::format("the scene's table of {} is larger than kernels can address", name));
    };
    const auto reals = [&](const char *name, const std::vector<float> &values) {
        check(name, values.size());
        if (precision == Precision::double_) {
            const std::vector<double> wide(values.begin(), values.end());
            buffers.emplace_back(device, name, wide.data(), wide.size() * sizeof(double));
        } else {
            buffers.push_back(Buffer::over(device, name, values.data(), values.size() * sizeof(float)));
        }
    };
    const auto numbers = [&](const char *name, const std::vector<std::uint32_t> &values) {
        buffers.push_back(Buffer::over(device, name, values.data(), values.size() * sizeof(std::uint32_t)));
    };
    if (t.is_indexed()) {
        add_vertex_buffers(device, t, precision, buffers);
    } else {
        reals("triangles", t.triangles);
        reals("triangle_normals", t.triangle_normals);
        reals("triangle_tangents", t.triangle_tangents);
        numbers("primitive_material", t.primitive_material);
        numbers("primitive_light", t.primitive_light);
        numbers("primitive_bin", t.primitive_bin);
        numbers("primitive_back_bin", t.primitive_back_bin);
    }
    reals("spheres", t.spheres);
    reals("materials", t.materials);
    reals("lights", t.lights);
    reals("camera", t.camera);
    if (!t.filter.offsets.empty()) {
        reals("filter_offsets", t.filter.offsets);
        reals("filter_taps", t.filter.taps);
    }
    numbers("material_back", t.material_back);
    numbers("light_kinds", t.light_kinds);
    numbers("light_alias", t.light_alias);
    reals("emissions", t.emissions);
    numbers("emission_alias", t.emission_alias);
    if (t.light_tree.levels > 0) {
        numbers("light_nodes", t.light_tree.nodes);
        numbers("light_leaves", t.light_tree.leaves);
        numbers("light_slots", t.light_tree.slots);
        numbers("light_leaf", t.light_tree.leaf);
    }
    if (t.environment) {
        numbers("environment_texels", t.environment->texels);
        numbers("environment_cells", t.environment->cells);
        numbers("environment_strips", t.environment->strips);
    }
    if (!t.texture_reals.empty()) {
        if (!t.is_indexed())
            reals("triangle_texcoords", t.triangle_texcoords);
        reals("sphere_axes", t.sphere_axes);
        reals("texture_reals", t.texture_reals);
        numbers("textures", t.textures);
        numbers("texels", t.texels);
        numbers("material_textures", t.material_textures);
        numbers("material_lookups", t.material_lookups);
        numbers("normal_maps", t.normal_maps);
        reals("bump_scales", t.bump_scales);
        numbers("blends", t.blends);
        numbers("record_kind", t.record_kind);
        reals("blend_weights", t.blend_weights);
    }
    if (!t.light_textures.empty()) {
        numbers("light_textures", t.light_textures);
        reals("light_pictures", t.light_pictures);
    }
    return buffers;
}

/// Where materials have textures, blends or maps.
MaterialClasses material_classes_for(const Scene &scene, const SessionOptions &options, const TraitMap &traits) {
    if (traits.at("TRAIT_MATERIAL") == 0)
        return {};
    MaterialClasses found = material_classes(scene, options.all_traits ? 1 : most_material_classes);
    if (options.all_traits)
        found.classes[0].on_triangles = found.classes[0].on_spheres = found.classes[0].two_faced = true;
    return found;
}

/// By material, as the stage `material` groups them: those that it does not read are of none.
void add_class_numbers(Session &session) {
    std::vector<std::uint32_t> numbers = session.material_classes.of_material;
    for (std::uint32_t &number : numbers)
        if (!session.is_left_to_material(session.material_classes.classes[number]))
            number = bin_none;
    session.add_scene_buffer("material_class", numbers);
}

} // namespace

Session::Session(Device &session_device, const Scene &s, const SessionOptions &session_options,
                 const TraitMap &method_traits)
    : device(session_device), options(session_options), settings(s.settings), film(with_crop(s.film)),
      border(filter_reach(film)), traits(traits_for(s, session_options, method_traits)),
      material_classes(material_classes_for(s, session_options, traits)),
      scene(in_phase(options.phases, phase_names::tables,
                     [&] {
                         return make_scene_tables(s, traits, tree_from(session_options.lights),
                                                  has("KINDS_BY_CLASS") ? &material_classes : nullptr);
                     })),
      scene_buffers(in_phase(options.phases, phase_names::tables,
                             [&] { return make_scene_buffers(session_device, scene, session_options.precision); })),
      tracer(in_phase(options.phases, phase_names::tree, [&] { return Tracer(s, session_options.threads, &scene); })),
      segments(device, tracer, options.precision) {
    traits["SAMPLES_LIGHTS"] = scene.light_count > 0 && options.strategy != SessionOptions::Strategy::bsdf;
    traits["TRAIT_LIGHT_TREE"] = traits["SAMPLES_LIGHTS"] ? static_cast<int>(scene.light_tree.levels) : 0;
    const bool has_few = scene.light_count <= most_few_lights && !options.all_traits && !traits["TRAIT_LIGHT_TREE"];
    traits["FEW_LIGHTS"] = has_few ? static_cast<int>(scene.light_count) : 0;
    const std::size_t textures = s.textures.size();
    const int few_textures = textures <= most_few_textures && !options.all_traits ? static_cast<int>(textures) : 0;
    if (traits["TRAIT_LIGHT_TEXTURES"] != 0)
        traits["TRAIT_LIGHT_TEXTURES"] = textures_with_count(traits["TRAIT_LIGHT_TEXTURES"], few_textures);
    traits["MANY_LIGHTS"] = scene.light_count >= least_many_lights && !traits["TRAIT_LIGHT_TREE"];
    if (traits["TRAIT_MATERIAL"] != 0)
        add_class_numbers(*this);
    numbers = {{"unit", 1},
               {"triangle_count", scene.triangle_count},
               {"light_count", scene.light_count},
               {"environment_light", scene.environment_light},
               {"max_depth", max_depth()},
               // Mitsuba's rr_depth; a negative one means none.
               {"roulette_depth", settings.rr_depth < 0 ? 0xFFFFFFFFu : std::uint32_t(settings.rr_depth)},
               {"crop_x", film.crop_x},
               {"crop_y", film.crop_y},
               {"crop_height", height()},
               {"film_width", film.width + 2 * border},
               {"seed_low", static_cast<std::uint32_t>(options.seed)},
               {"seed_high", static_cast<std::uint32_t>(options.seed >> 32)},
               {"blend_bin", static_cast<std::uint32_t>(1 + 2 * scene.kinds.size())}};
    if (scene.environment) {
        numbers["environment_columns"] = scene.environment->columns;
        numbers["environment_rows"] = scene.environment->rows;
        numbers["environment_strip_count"] = static_cast<std::uint32_t>(scene.environment->strips.size() / 2);
    }
    set_divisor(*this, "pixels", "pixels", pixels());
    set_divisor(*this, "width", "crop_width", width());
    if (traits["TRAIT_LIGHT_TREE"]) {
        reals["light_tree_x"] = scene.light_tree.origin[0];
        reals["light_tree_y"] = scene.light_tree.origin[1];
        reals["light_tree_z"] = scene.light_tree.origin[2];
        reals["light_tree_scale"] = scene.light_tree.scale;
        reals["light_share_at_infinity"] = scene.light_share_at_infinity;
    }
    reals["scene_diameter"] = scene.scene_diameter;
    reals["scene_center_x"] = scene.scene_center[0];
    reals["scene_center_y"] = scene.scene_center[1];
    reals["scene_center_z"] = scene.scene_center[2];
}

std::uint32_t Session::max_depth() const {
    return settings.max_depth < 0 ? deepest : static_cast<std::uint32_t>(settings.max_depth);
}

void set_divisor(Session &session, const std::string &name, const std::string &number, std::uint32_t divisor) {
    const InvariantDivision division = invariant_division(divisor);
    session.numbers[number] = divisor;
    session.numbers[name + "_multiplier"] = division.multiplier;
    session.numbers[name + "_shift"] = division.shift;
}

} // namespace gradus
