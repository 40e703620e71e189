// What everything that renders one scene on one device shares: the scene laid out for kernels, the tracer, what the
// kernels are compiled for, and what was counted.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/program.h"
#include "runtime/scene/material_class.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/traits.h"
#include "runtime/trace/tracer.h"
#include "runtime/wavefront/sampled_area.h"
#include "runtime/wavefront/segments.h"
#include "runtime/wavefront/session_options.h"
#include "runtime/wavefront/statistics.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gradus {

struct Session {
    /// `method_traits` are added to the scene's, or replace them. Throws Error for a crop or a film that cannot be.
    Session(Device &device, const Scene &scene, const SessionOptions &options, const TraitMap &method_traits);

    Device &device;
    SessionOptions options;
    RenderSettings settings;
    FilmSettings film;    ///< with its crop set: the image
    std::uint32_t border; ///< pixels around the image that are sampled too, as far as the filter reaches
    TraitMap traits;
    MaterialClasses material_classes; ///< where materials have textures, blends or maps
    SceneTables scene;
    std::vector<Buffer> scene_buffers; ///< by the names of kernels' arguments
    Tracer tracer;
    SegmentTracer segments; ///< of that tracer

    /// What kernels may ask for by name, the same for all launches.
    std::map<std::string, std::uint32_t> numbers;
    std::map<std::string, double> reals;

    std::map<std::string, double> compile_seconds; ///< by kernel
    std::map<std::string, std::uint64_t> rays;     ///< traced, by kind

    /// To be called before each longer piece of work. Throws Stopped where the caller wants no more.
    void ask_to_go_on() const {
        if (options.stop && options.stop())
            throw Stopped();
    }

    /// One more scene buffer.
    void add_scene_buffer(const std::string &name, const std::vector<std::uint32_t> &values) {
        scene_buffers.emplace_back(device, name, values.data(), values.size() * sizeof(values[0]));
    }
    bool has(const char *trait) const { return traits.at(trait) != 0; }
    SampledArea area() const { return {film.crop_width, film.crop_height, border}; }
    /// Of all that is sampled: tables of pixels have rows for these.
    std::uint32_t width() const { return film.crop_width + 2 * border; }
    std::uint32_t height() const { return film.crop_height + 2 * border; }
    std::uint32_t pixels() const { return width() * height(); }
    std::size_t image_pixels() const { return area().pixels(); }
    /// Whether samples count for the pixels around: then they are kept until those are there.
    bool has_frame() const { return border > 0; }
    /// How many samples of a frame come after that of a pixel until all are there that count for it.
    std::uint32_t filter_lag() const { return border * (width() + 1); }
    /// After `samples` samples, frame by frame, how many pixels have had all that count for them: so many, frame by
    /// frame, but for those of the border.
    std::uint64_t filtered_samples(std::uint64_t samples) const {
        const std::uint64_t more = samples % pixels();
        return samples - std::min<std::uint64_t>(more, filter_lag());
    }
    /// Of a pixel of the image the number among those that are sampled.
    std::size_t sampled_pixel(std::size_t pixel) const { return area().number_of(pixel); }
    std::uint32_t max_depth() const;
    /// Whether surfaces emit, and whether light is sampled at vertices.
    bool has_emission() const { return has("TRAIT_LIGHT_TRIANGLE") || has("TRAIT_LIGHT_SPHERE"); }
    bool samples_lights() const { return traits.at("SAMPLES_LIGHTS") != 0; }
    /// Columns of tables of surface vertices that the scene does not need; they are the last.
    std::uint32_t vertex_columns_not_needed() const {
        return has("TRAIT_ANISOTROPIC") ? 0 : has("TRAIT_SHADING_NORMALS") ? 3 : 6;
    }
    /// Columns that tables of surface vertices have behind those: textured parameters, and normals from textures.
    std::uint32_t textured_columns() const {
        return textured_column_count(traits.at("TRAIT_TEXTURED")) + (has("TRAIT_TEXTURED_NORMALS") ? 4 : 0);
    }
    /// Columns of `surface`: those, and the record that a blend has come to. None where nobody leaves any.
    std::uint32_t surface_columns() const {
        return is_left_to_material() ? textured_columns() + (has("TRAIT_BLENDS") ? 1 : 0) : 0;
    }
    /// Whether the stage `material` reads the materials of a class: all of them, unless kinds are kept apart by class.
    bool is_left_to_material(const MaterialClass &one) const {
        return !has("KINDS_BY_CLASS") || one.is_of_blends_or_maps();
    }
    /// Whether there are such classes.
    bool is_left_to_material() const {
        return std::ranges::any_of(material_classes.classes,
                                   [&](const MaterialClass &one) { return is_left_to_material(one); });
    }
    /// Of so many columns of a table of surface vertices those that are allocated.
    std::uint32_t vertex_columns(std::uint32_t all) const {
        return all - vertex_columns_not_needed() + textured_columns();
    }
};

/// Sets `<name>`, `<name>_multiplier` and `<name>_shift`, by which kernels divide by it (kernels/lib/division.h).
void set_divisor(Session &session, const std::string &name, const std::string &number, std::uint32_t divisor);

} // namespace gradus
