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

#define GRADUS_KIND_NAME(name, is_dirac) #name,
constexpr const char *kind_names[] = {GRADUS_BSDF_KINDS(GRADUS_KIND_NAME)};
#undef GRADUS_KIND_NAME

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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
    for (const std::string &kind : scene_tables_.kinds)
        for (std::uint32_t number = 0; number < std::size(kind_names); ++number)
            if (kind == kind_names[number])
                kind_numbers_.push_back(number);
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
    for (const char *name : kind_names)
        any[std::string("HAS_") + name] = std::find(kinds.begin(), kinds.end(), name) != kinds.end() ? "1" : "0";
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
        KindKernels lights;
        lights.is_dirac = bsdf_kind_is_dirac(kinds[k]);
        if (samples_lights(lights)) {
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

void GradientPathTracer::run(Kernel &kernel, std::uint32_t first, std::uint32_t items) {
    if (items == 0 || !kernel.valid())
        return;
    kernel.set("first", first);
    kernel.set("count", items);
    kernel.launch(items);
}

GradientPathTracer::Vertices GradientPathTracer::ranges_of(const std::vector<std::uint32_t> &range) const {
    Vertices vertices;
    const std::uint32_t escaped = range[phases];
    const std::size_t kinds = kinds_.size();
    vertices.count = range.back() - escaped;
    for (std::uint32_t phase = 0; phase < phases; ++phase)
        for (std::size_t k = 0; k < kinds; ++k) {
            const std::size_t bin = phases + 2 * (phase * kinds + k);
            vertices.ranges[phase].push_back({range[bin] - escaped, range[bin + 2] - range[bin]});
        }
    vertices.first_count = range[phases + 2 * kinds] - escaped;
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
        classify_.bind("vertex_old", tables_->vertex[0]);
        run(classify_, 0, rows);
        const std::vector<std::uint32_t> &range = partition_->run(rows);
        const Vertices vertices = ranges_of(range);
        surface_.bind("vertex_old", tables_->vertex[0]);
        surface_.bind("vertex", tables_->vertex[1]);
        run(surface_, range[phases], vertices.count);
        primary_surface_.bind("vertex", tables_->vertex[1]);
        primary_surface_.set("escaped", range[phases]);
        for (std::size_t k = 0; k < kinds_.size(); ++k) {
            primary_surface_.set("kind", kind_numbers_[k]);
            run(primary_surface_, vertices.ranges[0][k].first, vertices.ranges[0][k].count);
        }
    }
}

/// Adds the light samples of the newest vertices.
void GradientPathTracer::connect(const Vertices &vertices, const Buffer &vertex) {
    if (vertices.count == 0)
        return;
    for (Kernel *kernel : {&connect_first_, &connect_second_, &connect_})
        kernel->bind("vertex", vertex);
    connect_first_.set("link_stride", vertices.first_count);
    for (std::size_t k = 0; k < kinds_.size(); ++k)
        if (gradient_kinds_[k].light_first.valid()) {
            run(connect_first_, vertices.ranges[0][k].first, vertices.ranges[0][k].count);
            run(connect_second_, vertices.ranges[1][k].first, vertices.ranges[1][k].count);
        }
    const std::uint32_t later = vertices.ranges[2].front().first;
    run(connect_, later, vertices.count - later);
}

/// Adds the light that paths have met. The links of second vertices start at `link_first`: those of surfaces, then
/// those of escaped paths.
void GradientPathTracer::emit(const std::vector<std::uint32_t> &range, std::uint32_t link_first) {
    const std::size_t kinds = kinds_.size();
    const auto bin = [&](std::uint32_t phase, std::size_t kind) { return phases + 2 * (phase * kinds + kind); };
    const std::uint32_t escaped = range[phases], hits = range.back() - escaped;
    const std::uint32_t seconds = range[bin(2, 0)] - range[bin(1, 0)], second_escaped = range[2] - range[1];

    for (const std::uint32_t phase : {0u, 2u}) {
        for (Kernel *kernel : {&escape_, &emission_})
            if (kernel->valid())
                kernel->bind("radiance", phase == 0 ? direct_ : tables_->radiance);
        run(escape_, range[phase], range[phase + 1] - range[phase]);
        for (std::size_t k = 0; k < kinds; ++k)
            run(emission_, range[bin(phase, k) + 1], range[bin(phase, k) + 2] - range[bin(phase, k) + 1]);
    }
    if (escape_second_.valid()) {
        escape_second_.set("to", hits);
        escape_second_.set("link_first", link_first + 4 * seconds);
        escape_second_.set("link_stride", second_escaped);
        run(escape_second_, range[1], second_escaped);
    }
    if (emission_second_.valid())
        for (std::size_t k = 0; k < kinds; ++k) {
            const std::uint32_t first = range[bin(1, k) + 1];
            emission_second_.set("to", first - escaped);
            emission_second_.set("link_first", link_first + (first - range[bin(1, 0)]));
            emission_second_.set("link_stride", seconds);
            run(emission_second_, first, range[bin(1, k) + 2] - first);
        }
}

bool GradientPathTracer::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t paths = static_cast<std::uint32_t>(std::min<std::uint64_t>(tables_->slots, total_ - done_));
    const std::uint64_t first_sample = done_ / film_->pixels();
    camera_.set("first_pixel", 0);
    camera_.set("first_sample_low", static_cast<std::uint32_t>(first_sample));
    camera_.set("first_sample_high", static_cast<std::uint32_t>(first_sample >> 32));
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
        classify_.bind("vertex_old", old_vertex);
        run(classify_, 0, rays);
        const std::vector<std::uint32_t> &range = partition_->run(rays);
        const Vertices next = ranges_of(range);
        for (Kernel *kernel :
             {&surface_, &escape_, &emission_, &shift_, &shift_escaped_, &emission_second_, &escape_second_}) {
            if (!kernel->valid())
                continue;
            kernel->bind("vertex_old", old_vertex);
            kernel->bind("vertex", new_vertex);
        }
        // Links: of the light samples of first vertices, then those that second vertices ask for.
        const std::uint32_t second_first = phases + 2 * static_cast<std::uint32_t>(kinds);
        const std::uint32_t link_first = 4 * vertices.first_count;
        const std::uint32_t seconds = range[second_first + 2 * kinds] - range[second_first];
        const std::uint32_t second_escaped = range[2] - range[1];
        shift_.set("to", next.first_count);
        shift_.set("link_first", link_first);
        shift_.set("link_stride", seconds);
        run(shift_, range[second_first], seconds);
        if (shift_escaped_.valid()) {
            shift_escaped_.set("to", next.count);
            shift_escaped_.set("link_first", link_first + 4 * seconds);
            shift_escaped_.set("link_stride", second_escaped);
            run(shift_escaped_, range[1], second_escaped);
        }
        statistics_.rays["offset"] += run_link_stage(tracer_, link_, tables_->capacity,
                                                     link_first + 4 * (seconds + second_escaped), trace_seconds_);
        connect(vertices, old_vertex);
        emit(range, link_first);
        settle_.set("link_stride", seconds);
        for (std::size_t k = 0; k < kinds; ++k) {
            const Range &second = next.ranges[1][k];
            settle_.set("is_dirac", kinds_[k].is_dirac);
            settle_.set("link_first", link_first + (second.first - next.first_count));
            run(settle_, second.first, second.count);
        }
        run(surface_, range[phases], next.count);
        newest = 1 - newest;
        vertices = next;

        for (std::size_t k = 0; k < kinds; ++k) {
            KindKernels &kind = kinds_[k];
            GradientKernels &gradient = gradient_kinds_[k];
            for (Kernel *kernel : {&kind.feature, &kind.light_sample, &kind.scatter, &gradient.light_first,
                                   &gradient.light_second, &gradient.scatter_first, &gradient.scatter_second})
                if (kernel->valid())
                    kernel->bind("vertex", tables_->vertex[newest]);
            const Range &first = vertices.ranges[0][k], &second = vertices.ranges[1][k], &later = vertices.ranges[2][k];
            run(kind.feature, first.first, first.count);
            if (gradient.light_first.valid()) {
                gradient.light_first.set("link_stride", vertices.first_count);
                run(gradient.light_first, first.first, first.count);
            } else {
                close_links_.set("link_stride", vertices.first_count);
                run(close_links_, first.first, first.count);
            }
            run(gradient.scatter_first, first.first, first.count);
            run(gradient.light_second, second.first, second.count);
            run(gradient.scatter_second, second.first, second.count);
            run(kind.light_sample, later.first, later.count);
            run(kind.scatter, later.first, later.count);
        }
    }
    run(combine_, 0, paths);
    film_->accumulate(paths, 0);
    for (std::uint32_t slot = 0; slot < paths; slot += film_->pixels()) {
        gradient_accumulate_.set("first_slot", slot);
        run(gradient_accumulate_, 0, film_->pixels());
    }
    finish(device_);
    done_ += paths;
    statistics_.samples += paths;
    statistics_.render_seconds += seconds_since(start);
    return done_ < total_;
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
