#include "runtime/methods/gradient_path_tracer.h"

#include "kernels/shared/material.h"
#include "kernels/shared/tables.h"
#include "runtime/methods/gradient_image.h"
#include "runtime/stages/trace_stage.h"

#include <algorithm>
#include <chrono>

namespace gradus {

using namespace lib_float;

namespace {

/// A request for kernel `entry` of a stage file, for one side of an #if.
KernelRequest variant(KernelRequest request, const std::string &name, const std::string &entry,
                      const std::map<std::string, std::string> &definitions) {
    request.name = name;
    request.entry = entry;
    request.definitions.insert(definitions.begin(), definitions.end());
    return request;
}

} // namespace

GradientPathTracer::GradientPathTracer(Device &device, const Scene &scene, const RenderOptions &options)
    : PathTracer(device, scene, options, {{"TRAIT_SHARED_JITTER", 1}}) {
    gradient_kinds_.resize(scene_tables_.kinds.size());
    const std::vector<std::string> all = all_bsdf_kinds();
    for (const std::string &kind : scene_tables_.kinds)
        kind_numbers_.push_back(static_cast<std::uint32_t>(std::find(all.begin(), all.end(), kind) - all.begin()));
    Additions additions;
    additions.phases = phases;
    additions.whole_frames = true;
    additions.kernels = wanted_kernels();
    additions.bind = [this] {
        allocate();
        bind_kernels();
    };
    prepare(additions);
}

std::vector<PathTracer::Wanted> GradientPathTracer::wanted_kernels() {
    const std::vector<std::string> &kinds = scene_tables_.kinds;
    // Offset paths meet whichever kinds the scene has.
    std::map<std::string, std::string> any = {{"ONE_KIND", kinds.size() == 1 ? "1" : "0"}};
    for (const std::string &name : all_bsdf_kinds())
        any["HAS_" + name] = std::find(kinds.begin(), kinds.end(), name) != kinds.end() ? "1" : "0";
    const auto with = [&any](const char *name, const char *value) {
        std::map<std::string, std::string> definitions = any;
        definitions[name] = value;
        return definitions;
    };
    const KernelRequest primary = request_of("primary"), settle = request_of("settle");
    std::vector<Wanted> wanted = {
        {&primary_begin_, variant(primary, "primary begin", "primary_begin", {})},
        {&primary_surface_, variant(primary, "primary surface", "primary_surface", {})},
        {&begin_, request_of("gradient_begin")},
        {&shift_, variant(request_of("shift"), "shift", "shift", with("ESCAPED", "0"))},
        {&settle_, settle},
        {&close_links_, variant(settle, "close links", "close_links", {})},
        {&combine_, request_of("gradient_combine")},
        {&gradient_accumulate_, request_of("gradient_accumulate")},
    };
    if (escape_wanted()) {
        wanted.push_back(
            {&shift_escaped_, variant(request_of("shift"), "shift escaped", "shift", with("ESCAPED", "1"))});
        wanted.push_back({&escape_second_, variant(request_of("gradient_emission"), "gradient escape",
                                                   "gradient_emission", {{"ESCAPED", "1"}})});
    }
    if (emission_wanted())
        wanted.push_back({&emission_second_, variant(request_of("gradient_emission"), "gradient emission",
                                                     "gradient_emission", {{"ESCAPED", "0"}})});
    const KernelRequest connect = request_of("gradient_connect");
    wanted.push_back({&connect_first_, variant(connect, "gradient connect 1", "gradient_connect", {{"FIRST", "1"}})});
    wanted.push_back({&connect_second_, variant(connect, "gradient connect 2", "gradient_connect", {{"FIRST", "0"}})});
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        GradientKernels &kind = gradient_kinds_[k];
        if (samples_lights(bsdf_kind_is_dirac(kinds[k]))) {
            const KernelRequest light = request_of("gradient_light", kinds[k]);
            wanted.push_back({&kind.light_first,
                              variant(light, "gradient_light 1 " + kinds[k], "gradient_light", with("FIRST", "1"))});
            wanted.push_back({&kind.light_second,
                              variant(light, "gradient_light 2 " + kinds[k], "gradient_light", with("FIRST", "0"))});
        }
        wanted.push_back({&kind.scatter_first, variant(request_of("scatter", kinds[k]), "scatter 1 " + kinds[k],
                                                       "scatter", {{"KEEP_DARK", "1"}})});
        wanted.push_back({&kind.scatter_second, request_of("gradient_scatter", kinds[k])});
    }
    return wanted;
}

void GradientPathTracer::allocate() {
    const auto table = [&](const char *name, std::size_t columns, std::size_t rows) {
        return Buffer(device_, name, columns * rows * sizeof(float));
    };
    const std::size_t capacity = tables_->capacity, slots = tables_->slots;
    const std::size_t primary_needs = traits_.at("TRAIT_ANISOTROPIC")       ? primary_columns
                                      : traits_.at("TRAIT_SHADING_NORMALS") ? primary_along_x
                                                                            : primary_shading_x;
    primary_ = table("primary", primary_needs, slots);
    shifted_ = table("shifted", shifted_columns, 4 * capacity);
    gain_ = table("gain", gain_columns, 4 * capacity);
    link_ = table("link", link_columns, 8 * capacity);
    prefix_ = table("prefix", prefix_columns, slots);
    difference_ = table("difference", difference_columns, 4 * slots);
    direct_ = table("direct", radiance_columns, slots);
    gradient_film_ = table("gradient_film", gradient_film_columns, film_->pixels());
    gradient_film_.clear();
    primary_.clear(); // rows of escaped paths have no material, and are read all the same
}

void GradientPathTracer::bind_kernels() {
    for (Kernel *kernel : more_kernels_) {
        for (const Buffer *buffer :
             {&primary_, &shifted_, &gain_, &link_, &prefix_, &difference_, &direct_, &gradient_film_})
            kernel->bind(*buffer);
        bind_film_place(*kernel);
        for (const char *number : {"link_first", "link_stride", "to", "escaped", "kind", "is_dirac"})
            kernel->set(number, 0);
    }
}

GradientPathTracer::Vertices GradientPathTracer::partition(std::uint32_t rays, const Buffer &vertex) {
    classify_.bind("vertex_old", vertex);
    run(classify_, 0, rays);
    const std::vector<std::uint32_t> &range = partition_->run(rays);
    Vertices vertices;
    vertices.escaped_count = range[phases];
    vertices.count = range.back() - vertices.escaped_count;
    const auto rows = [&](std::size_t first_bin, std::size_t end_bin) {
        return Range{range[first_bin] - vertices.escaped_count, range[end_bin] - range[first_bin]};
    };
    const std::size_t kinds = kinds_.size();
    for (std::uint32_t phase = 0; phase < phases; ++phase) {
        const std::size_t bin = phases + 2 * phase * kinds;
        vertices.escaped[phase] = {range[phase], range[phase + 1] - range[phase]};
        vertices.rows[phase] = rows(bin, bin + 2 * kinds);
        for (std::size_t k = 0; k < kinds; ++k) {
            vertices.kinds[phase].push_back(rows(bin + 2 * k, bin + 2 * k + 2));
            vertices.emitting[phase].push_back(rows(bin + 2 * k + 1, bin + 2 * k + 2));
        }
    }
    return vertices;
}

/// What the camera sees of each slot, a batch at a time.
void GradientPathTracer::trace_primaries(std::uint32_t paths) {
    for (std::uint32_t slot = 0; slot < paths; slot += tables_->capacity) {
        const std::uint32_t rows = std::min(tables_->capacity, paths - slot);
        begin_paths(0, slot, rows, tables_->vertex[0]);
        primary_begin_.bind("vertex", tables_->vertex[0]);
        run(primary_begin_, 0, rows);
        trace(rows, 0);
        const Vertices vertices = partition(rows, tables_->vertex[0]);
        surface_.bind("vertex_old", tables_->vertex[0]);
        surface_.bind("vertex", tables_->vertex[1]);
        run(surface_, vertices.escaped_count, vertices.count);
        primary_surface_.bind("vertex", tables_->vertex[1]);
        primary_surface_.set("escaped", vertices.escaped_count);
        for (std::size_t k = 0; k < kinds_.size(); ++k) {
            primary_surface_.set("kind", kind_numbers_[k]);
            run(primary_surface_, vertices.kinds[0][k].first, vertices.kinds[0][k].count);
        }
    }
}

/// Adds the light samples of the newest vertices.
void GradientPathTracer::connect(const Vertices &vertices, const Buffer &vertex) {
    if (vertices.count == 0)
        return;
    for (Kernel *kernel : {&connect_first_, &connect_second_, &connect_})
        kernel->bind("vertex", vertex);
    connect_first_.set("link_stride", vertices.rows[0].count);
    for (std::size_t k = 0; k < kinds_.size(); ++k)
        if (gradient_kinds_[k].light_first.valid()) {
            run(connect_first_, vertices.kinds[0][k].first, vertices.kinds[0][k].count);
            run(connect_second_, vertices.kinds[1][k].first, vertices.kinds[1][k].count);
        }
    run(connect_, vertices.rows[2].first, vertices.rows[2].count);
}

/// Adds the light that paths have met. The links of second vertices start at `link_first`: those of surfaces, then
/// those of escaped paths.
void GradientPathTracer::emit(const Vertices &next, std::uint32_t link_first) {
    for (const std::uint32_t phase : {0u, 2u}) {
        for (Kernel *kernel : {&escape_, &emission_})
            if (kernel->valid())
                kernel->bind("radiance", phase == 0 ? direct_ : tables_->radiance);
        run(escape_, next.escaped[phase].first, next.escaped[phase].count);
        for (const Range &emitting : next.emitting[phase])
            run(emission_, next.escaped_count + emitting.first, emitting.count);
    }
    const Range &second = next.rows[1], &second_escaped = next.escaped[1];
    if (escape_second_.valid()) {
        escape_second_.set("to", next.count);
        escape_second_.set("link_first", link_first + 4 * second.count);
        escape_second_.set("link_stride", second_escaped.count);
        run(escape_second_, second_escaped.first, second_escaped.count);
    }
    if (emission_second_.valid())
        for (const Range &emitting : next.emitting[1]) {
            emission_second_.set("to", emitting.first);
            emission_second_.set("link_first", link_first + (emitting.first - second.first));
            emission_second_.set("link_stride", second.count);
            run(emission_second_, next.escaped_count + emitting.first, emitting.count);
        }
}

bool GradientPathTracer::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t paths = begin_pass();
    const std::size_t kinds = kinds_.size();
    if (settings_.max_depth == 0) {
        for (Buffer *buffer : {&tables_->radiance, &tables_->feature, &direct_, &prefix_, &difference_})
            buffer->clear();
    } else {
        trace_primaries(paths);
    }

    int newest = 0;
    std::uint32_t begun = 0;
    Vertices vertices;
    for (;;) {
        const std::uint32_t fresh =
            settings_.max_depth == 0 ? 0 : std::min(tables_->capacity - vertices.count, paths - begun);
        if (fresh > 0) {
            begin_.bind("vertex", tables_->vertex[newest]);
            begin_.set("first_row", vertices.count);
            begin_.set("first_slot", begun);
            run(begin_, 0, fresh);
            begun += fresh;
        }
        const std::uint32_t rays = vertices.count + fresh;
        if (rays == 0)
            break;
        trace(rays, vertices.count);

        const Buffer &old_vertex = tables_->vertex[newest], &new_vertex = tables_->vertex[1 - newest];
        const Vertices next = partition(rays, old_vertex);
        for (Kernel *kernel :
             {&surface_, &escape_, &emission_, &shift_, &shift_escaped_, &emission_second_, &escape_second_}) {
            if (!kernel->valid())
                continue;
            kernel->bind("vertex_old", old_vertex);
            kernel->bind("vertex", new_vertex);
        }
        // Links: of the light samples of first vertices, then those that second vertices ask for.
        const std::uint32_t link_first = 4 * vertices.rows[0].count;
        const Range &second = next.rows[1], &second_escaped = next.escaped[1];
        shift_.set("to", second.first);
        shift_.set("link_first", link_first);
        shift_.set("link_stride", second.count);
        run(shift_, next.escaped_count + second.first, second.count);
        if (shift_escaped_.valid()) {
            shift_escaped_.set("to", next.count);
            shift_escaped_.set("link_first", link_first + 4 * second.count);
            shift_escaped_.set("link_stride", second_escaped.count);
            run(shift_escaped_, second_escaped.first, second_escaped.count);
        }
        statistics_.rays["offset"] += run_link_stage(
            tracer_, link_, tables_->capacity, link_first + 4 * (second.count + second_escaped.count), trace_seconds_);
        connect(vertices, old_vertex);
        emit(next, link_first);
        settle_.set("link_stride", second.count);
        for (std::size_t k = 0; k < kinds; ++k) {
            const Range &of_kind = next.kinds[1][k];
            settle_.set("is_dirac", kinds_[k].is_dirac);
            settle_.set("link_first", link_first + (of_kind.first - second.first));
            run(settle_, of_kind.first, of_kind.count);
        }
        run(surface_, next.escaped_count, next.count);
        newest = 1 - newest;
        vertices = next;

        for (std::size_t k = 0; k < kinds; ++k) {
            KindKernels &kind = kinds_[k];
            GradientKernels &gradient = gradient_kinds_[k];
            for (Kernel *kernel : {&kind.feature, &kind.light_sample, &kind.scatter, &gradient.light_first,
                                   &gradient.light_second, &gradient.scatter_first, &gradient.scatter_second})
                if (kernel->valid())
                    kernel->bind("vertex", tables_->vertex[newest]);
            const Range &first_rows = vertices.kinds[0][k], &second_rows = vertices.kinds[1][k],
                        &later_rows = vertices.kinds[2][k];
            run(kind.feature, first_rows.first, first_rows.count);
            if (gradient.light_first.valid()) {
                gradient.light_first.set("link_stride", vertices.rows[0].count);
                run(gradient.light_first, first_rows.first, first_rows.count);
            } else {
                close_links_.set("link_stride", vertices.rows[0].count);
                run(close_links_, first_rows.first, first_rows.count);
            }
            run(gradient.scatter_first, first_rows.first, first_rows.count);
            run(gradient.light_second, second_rows.first, second_rows.count);
            run(gradient.scatter_second, second_rows.first, second_rows.count);
            run(kind.light_sample, later_rows.first, later_rows.count);
            run(kind.scatter, later_rows.first, later_rows.count);
        }
    }
    run(combine_, 0, paths);
    film_->accumulate(paths, 0);
    for (std::uint32_t slot = 0; slot < paths; slot += film_->pixels()) {
        gradient_accumulate_.set("first_slot", slot);
        run(gradient_accumulate_, 0, film_->pixels());
    }
    return end_pass(paths, start);
}

void GradientPathTracer::restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel) {
    PathTracer::restart(first_sample, samples_per_pixel);
    gradient_film_.clear();
}

Image GradientPathTracer::image() {
    statistics_.non_finite = 0;
    const Image whole = film_->image(done_, statistics_.non_finite);
    if (!solver_)
        solver_ = std::make_unique<PoissonSolver>(device_, film_settings_.crop_width, film_settings_.crop_height, 3);
    return reconstruct(*solver_, whole, read_gradient_film(gradient_film_, film_->pixels(), done_ / film_->pixels()),
                       options_);
}

} // namespace gradus
