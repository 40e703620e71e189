#include "runtime/methods/gradient_path_tracer.h"

#include "kernels/shared/material.h"
#include "kernels/shared/tables.h"
#include "runtime/methods/gradient_image.h"
#include "runtime/stages/trace_stage.h"

#include <fmt/format.h>

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

std::uint32_t chunks_of(std::uint32_t rows) { return (rows + partition_chunk - 1) / partition_chunk; }

/// Whether offset paths may reconnect there.
bool is_rough(const Bsdf &bsdf, double threshold) {
    const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
    return !kind.is_dirac && (!kind.has_roughness || std::min(bsdf.alpha_u, bsdf.alpha_v) >= threshold);
}

/// By material record, the kind with what `kind` in kernels/shared/tables.h says of it.
std::vector<std::uint32_t> shift_kinds(const Scene &scene, double threshold) {
    std::vector<std::uint32_t> kinds;
    for (const Bsdf &bsdf : material_records(scene))
        kinds.push_back(bsdf_kind_number(bsdf) | (is_rough(bsdf, threshold) ? kind_is_rough : 0) |
                        (bsdf_kind_is_dirac(bsdf_kind_name(bsdf)) ? kind_is_dirac : 0));
    return kinds;
}

TraitMap gradient_traits(const Scene &scene, const RenderOptions &options) {
    const bool distance = options.all_traits || options.shift_distance > 0;
    bool apart = distance;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { apart = apart || !is_rough(bsdf, options.shift_threshold); });
    return {{"TRAIT_SHARED_JITTER", 1}, {"TRAIT_APART", apart}, {"TRAIT_SHIFT_DISTANCE", distance}};
}

/// A request that relaxed arithmetic does not change.
KernelRequest strict(KernelRequest request) {
    request.strict = true;
    return request;
}

} // namespace

GradientPathTracer::GradientPathTracer(Device &device, const Scene &scene, const RenderOptions &options)
    : PathTracer(device, scene, options, gradient_traits(scene, options)) {
    gradient_kinds_.resize(scene_tables_.kinds.size());
    const std::vector<std::uint32_t> kinds = shift_kinds(scene, options.shift_threshold);
    material_kind_ = Buffer(device, "material_kind", kinds.data(), kinds.size() * sizeof(kinds[0]));
    Additions additions;
    additions.phases = keeps_apart() ? phases : phases - 1;
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
        any.emplace(fmt::format("HAS_{}", name),
                    std::find(kinds.begin(), kinds.end(), name) != kinds.end() ? "1" : "0");
    const auto with = [&any](std::map<std::string, std::string> definitions) {
        definitions.insert(any.begin(), any.end());
        return definitions;
    };
    const KernelRequest primary = request_of("primary"), settle = request_of("settle");
    std::vector<Wanted> wanted = {
        {&primary_begin_, variant(primary, "primary begin", "primary_begin", {})},
        {&primary_surface_, variant(primary, "primary surface", "primary_surface", {})},
        {&begin_, request_of("gradient_begin")},
        {&clear_, variant(request_of("gradient_begin"), "gradient clear", "gradient_clear", {})},
        {&settle_, settle},
        {&close_links_, variant(settle, "close links", "close_links", {})},
        {&combine_, strict(request_of("gradient_combine"))},
        {&gradient_accumulate_, strict(request_of("gradient_accumulate"))},
        {&count_, variant(request_of("shift_count"), "shift_count", "shift_count",
                          {{"PARTITION_CHUNK", std::to_string(partition_chunk)}})},
    };
    if (keeps_apart()) {
        const KernelRequest surface = request_of("offset_surface");
        wanted.push_back({&offset_begin_, variant(surface, "offset begin", "offset_begin", {})});
        wanted.push_back({&offset_surface_, variant(surface, "offset surface", "offset_surface", {})});
    }
    for (int apart = 0; apart <= int(keeps_apart()); ++apart) {
        const std::string suffix = apart ? " apart" : "", value = apart ? "1" : "0";
        // Relaxed, its like computations would be packed into short vectors again (kernels/lib/ordered.h), at a
        // third of the speed.
        const KernelRequest shift = strict(request_of("shift")), emission = request_of("gradient_emission");
        wanted.push_back({&shift_[apart], variant(shift, fmt::format("shift{}", suffix), "shift",
                                                  with({{"ESCAPED", "0"}, {"APART", value}}))});
        if (escape_wanted()) {
            wanted.push_back({&shift_escaped_[apart], variant(shift, fmt::format("shift escaped{}", suffix), "shift",
                                                              with({{"ESCAPED", "1"}, {"APART", value}}))});
            wanted.push_back(
                {&offset_escape_[apart], variant(emission, fmt::format("gradient escape{}", suffix),
                                                 "gradient_emission", {{"ESCAPED", "1"}, {"APART", value}})});
        }
        if (emission_wanted())
            wanted.push_back(
                {&offset_emission_[apart], variant(emission, fmt::format("gradient emission{}", suffix),
                                                   "gradient_emission", {{"ESCAPED", "0"}, {"APART", value}})});
    }
    // At the vertices where offset paths are apart, some may have reconnected.
    const std::string both = keeps_apart() ? "1" : "0";
    const std::map<std::string, std::string> at_first = {{"APART", "1"}, {"JOINED", "0"}},
                                             at_apart = {{"APART", "1"}, {"JOINED", both}},
                                             at_joined = {{"APART", "0"}, {"JOINED", "1"}};
    const KernelRequest connect = request_of("gradient_connect");
    const auto connect_at = [&](Kernel &kernel, const char *name, std::map<std::string, std::string> where,
                                const char *is_first) {
        where.emplace("FIRST", is_first);
        wanted.push_back({&kernel, variant(connect, name, "gradient_connect", where)});
    };
    connect_at(connect_first_, "gradient connect first", at_apart, "1");
    if (keeps_apart())
        connect_at(connect_apart_, "gradient connect apart", at_apart, "0");
    connect_at(connect_joined_, "gradient connect", at_joined, "0");
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        GradientKernels &kernels = gradient_kinds_[k];
        const std::string &kind = kinds[k];
        if (samples_lights(bsdf_kind_is_dirac(kind))) {
            const KernelRequest light = request_of("gradient_light", kind);
            wanted.push_back({&kernels.light_first, variant(light, fmt::format("gradient_light first {}", kind),
                                                            "gradient_light", with(at_first))});
            if (keeps_apart())
                wanted.push_back({&kernels.light_apart, variant(light, fmt::format("gradient_light apart {}", kind),
                                                                "gradient_light", with(at_apart))});
            wanted.push_back({&kernels.light_joined, variant(light, fmt::format("gradient_light {}", kind),
                                                             "gradient_light", with(at_joined))});
        }
        const KernelRequest scatter = request_of("gradient_scatter", kind);
        wanted.push_back({&kernels.scatter_joined, variant(scatter, fmt::format("gradient_scatter {}", kind),
                                                           "gradient_scatter", {{"APART", "0"}})});
        wanted.push_back({&kernels.scatter_apart,
                          keeps_apart() ? variant(scatter, fmt::format("gradient_scatter apart {}", kind),
                                                  "gradient_scatter", {{"APART", "1"}})
                                        : variant(request_of("scatter", kind), fmt::format("scatter apart {}", kind),
                                                  "scatter", {{"KEEP_DARK", "1"}})});
    }
    return wanted;
}

void GradientPathTracer::allocate() {
    const auto table = [&](const char *name, std::size_t columns, std::size_t rows) {
        return Buffer(device_, name, columns * rows * real_bytes(options_.precision));
    };
    const std::size_t capacity = tables_->capacity, slots = tables_->slots;
    // Columns that the scene does not need are the last.
    const std::size_t not_needed = traits_.at("TRAIT_ANISOTROPIC") ? 0 : traits_.at("TRAIT_SHADING_NORMALS") ? 3 : 6;
    primary_ = table("primary", primary_columns - not_needed, slots);
    gain_ = table("gain", gain_columns, 4 * capacity);
    link_ = table("link", link_columns, 8 * capacity);
    prefix_ = table("prefix", prefix_columns, slots);
    difference_ = table("difference", difference_columns, 4 * slots);
    direct_ = table("direct", radiance_columns, slots);
    gradient_film_ = table("gradient_film", gradient_film_columns, film_->pixels());
    gradient_film_.clear();
    primary_.clear(); // rows of escaped paths have no material, and are read all the same
    outcome_ = Buffer(device_, "outcome", shift_outcomes * chunks_of(tables_->capacity) * sizeof(std::uint32_t));
    outcome_.clear();
    if (keeps_apart()) {
        for (Buffer &shifted : shifted_)
            shifted = table("shifted", shifted_columns, 4 * capacity);
        offset_vertex_ = table("offset_vertex", offset_vertex_columns - not_needed, 4 * capacity);
        offset_vertex_.clear(); // as `primary`
        offset_ray_ = table("offset_ray", offset_ray_columns, 4 * capacity);
        offset_state_ = Buffer(device_, "offset_state", capacity * sizeof(std::uint32_t));
        if (keeps_distance())
            offset_reach_ = table("offset_reach", 1, capacity);
    } else {
        shifted_[0] = shifted_[1] = table("shifted", shifted_state, 4 * capacity);
    }
}

void GradientPathTracer::bind_kernels() {
    std::vector<const Buffer *> buffers = {&material_kind_, &primary_, &gain_,          &link_,   &prefix_,
                                           &difference_,    &direct_,  &gradient_film_, &outcome_};
    if (keeps_apart())
        buffers.insert(buffers.end(), {&offset_vertex_, &offset_ray_, &offset_state_});
    if (keeps_distance())
        buffers.push_back(&offset_reach_);
    const double shift_distance = options_.shift_distance * scene_tables_.scene_diameter;
    std::vector<Kernel *> kernels = more_kernels_;
    kernels.push_back(&classify_);
    for (Kernel *kernel : kernels) {
        for (const Buffer *buffer : buffers)
            kernel->bind(*buffer);
        kernel->bind("shifted", shifted_[0]);
        kernel->bind("shifted_old", shifted_[1]);
        bind_film_place(*kernel);
        kernel->set("chunks_at_most", chunks_of(tables_->capacity));
        kernel->set_real("shift_distance", shift_distance);
        for (const char *number : {"link_first", "link_stride", "offset_first", "offset_stride", "to", "escaped",
                                   "shifting", "fresh", "frames"})
            kernel->set(number, 0);
    }
}

GradientPathTracer::Vertices GradientPathTracer::partition(const Vertices &old, std::uint32_t fresh,
                                                           const Buffer &vertex) {
    const std::uint32_t rays = old.count + fresh;
    classify_.set("shifting", old.shifting());
    classify_.set("fresh", old.count);
    classify_.bind("vertex", vertex);
    run(classify_, 0, rays);
    const std::vector<std::uint32_t> &range = partition_->run(rays);
    const std::size_t kinds = kinds_.size(), present = keeps_apart() ? phases : phases - 1;
    Vertices vertices;
    vertices.escaped_count = range[present];
    vertices.count = range.back() - vertices.escaped_count;
    const auto rows = [&](std::size_t first_bin, std::size_t end_bin) {
        return Range{range[first_bin] - vertices.escaped_count, range[end_bin] - range[first_bin]};
    };
    for (std::size_t phase = 0, number = 0; phase < phases; ++phase) {
        const bool is_present = phase != apart || keeps_apart();
        const std::size_t bin = present + 2 * number * kinds, end = is_present ? 2 : 0;
        vertices.escaped[phase] = {range[number], is_present ? range[number + 1] - range[number] : 0};
        vertices.rows[phase] = rows(bin, bin + end * kinds);
        for (std::size_t k = 0; k < kinds; ++k) {
            const std::size_t first_bin = bin + end * k;
            vertices.kinds[phase].push_back(rows(first_bin, first_bin + end));
            vertices.emitting[phase].push_back(rows(first_bin + end / 2, first_bin + end));
        }
        number += is_present;
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
        const Vertices vertices = partition(Vertices(), rows, tables_->vertex[0]);
        surface_.bind("vertex_old", tables_->vertex[0]);
        surface_.bind("vertex", tables_->vertex[1]);
        run(surface_, vertices.escaped_count, vertices.count);
        primary_surface_.bind("vertex", tables_->vertex[1]);
        primary_surface_.set("escaped", vertices.escaped_count);
        run(primary_surface_, 0, vertices.count);
    }
}

/// Takes offset paths to the next vertices of their base paths, and traces what they ask, with the light samples of
/// those that are apart. Where they ask: first the light samples, then surfaces, then those that escaped.
GradientPathTracer::Shiftings GradientPathTracer::shift(const Vertices &vertices, const Vertices &next) {
    Shiftings shiftings;
    shiftings.links = 4 * vertices.shifting();
    const auto send = [&](Kernel &kernel, bool is_apart, Range index, std::uint32_t to) {
        const Shifting shifting = {index, to, shiftings.links, shiftings.offset_rays};
        shiftings.links += 4 * index.count;
        shiftings.offset_rays += is_apart ? 4 * index.count : 0;
        kernel.set("to", to);
        kernel.set("link_first", shifting.link_first);
        kernel.set("link_stride", index.count);
        kernel.set("offset_first", shifting.offset_first);
        kernel.set("offset_stride", index.count);
        run(kernel, index.first, index.count);
        return shifting;
    };
    for (const Phase phase : {apart, joined}) {
        const Range &rows = next.rows[phase], &escaped = next.escaped[phase];
        const bool is_apart = phase == apart;
        if (rows.count > 0)
            shiftings.surface[phase] =
                send(shift_[is_apart], is_apart, {next.escaped_count + rows.first, rows.count}, rows.first);
        if (escaped.count > 0 && shift_escaped_[is_apart].valid())
            shiftings.escaped[phase] = send(shift_escaped_[is_apart], is_apart, escaped, next.count + escaped.first);
    }
    statistics_.rays["offset"] +=
        run_offset_stage(tracer_, link_, shiftings.links, keeps_apart() ? &offset_ray_ : nullptr, shiftings.offset_rays,
                         tables_->capacity, options_.precision, trace_seconds_);
    return shiftings;
}

/// Adds the light samples of the newest vertices.
void GradientPathTracer::connect(const Vertices &vertices, const Buffer &vertex) {
    if (vertices.count == 0)
        return;
    for (Kernel *kernel : {&connect_first_, &connect_apart_, &connect_joined_, &connect_})
        if (kernel->valid()) {
            kernel->bind("vertex", vertex);
            kernel->set("link_stride", vertices.shifting());
        }
    for (std::size_t k = 0; k < kinds_.size(); ++k)
        if (gradient_kinds_[k].light_first.valid()) {
            const auto run_on = [&](Kernel &kernel, Phase phase) {
                run(kernel, vertices.kinds[phase][k].first, vertices.kinds[phase][k].count);
            };
            run_on(connect_first_, first);
            run_on(connect_apart_, apart);
            run_on(connect_joined_, joined);
        }
    run(connect_, vertices.rows[later].first, vertices.rows[later].count);
}

/// Adds the light that paths have met.
void GradientPathTracer::emit(const Vertices &next, const Shiftings &shiftings) {
    for (const Phase phase : {first, later}) {
        for (Kernel *kernel : {&escape_, &emission_})
            if (kernel->valid())
                kernel->bind("radiance", phase == first ? direct_ : tables_->radiance);
        run(escape_, next.escaped[phase].first, next.escaped[phase].count);
        for (const Range &emitting : next.emitting[phase])
            run(emission_, next.escaped_count + emitting.first, emitting.count);
    }
    /// Rows [skip, skip + count) of those that were sent.
    const auto add = [this](Kernel &kernel, const Shifting &sent, std::uint32_t skip, std::uint32_t count) {
        if (count == 0 || !kernel.valid())
            return;
        kernel.set("to", sent.to + skip);
        kernel.set("link_first", sent.link_first + skip);
        kernel.set("link_stride", sent.index.count);
        kernel.set("offset_first", sent.offset_first + skip);
        kernel.set("offset_stride", sent.index.count);
        run(kernel, sent.index.first + skip, count);
    };
    for (const Phase phase : {apart, joined})
        add(offset_escape_[phase == apart], shiftings.escaped[phase], 0, shiftings.escaped[phase].index.count);
    // An offset path that is apart may find a light where its base path finds none.
    add(offset_emission_[1], shiftings.surface[apart], 0, shiftings.surface[apart].index.count);
    for (const Range &emitting : next.emitting[joined])
        add(offset_emission_[0], shiftings.surface[joined], emitting.first - next.rows[joined].first, emitting.count);
}

/// Samples lights and the BSDF at the newest vertices.
void GradientPathTracer::scatter(const Vertices &vertices, const Buffer &vertex) {
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
        KindKernels &kind = kinds_[k];
        GradientKernels &gradient = gradient_kinds_[k];
        for (Kernel *kernel :
             {&kind.feature, &kind.light_sample, &kind.scatter, &gradient.light_first, &gradient.light_apart,
              &gradient.light_joined, &gradient.scatter_apart, &gradient.scatter_joined})
            if (kernel->valid())
                kernel->bind("vertex", vertex);
        const auto run_on = [&](Kernel &kernel, Phase phase) {
            run(kernel, vertices.kinds[phase][k].first, vertices.kinds[phase][k].count);
        };
        run_on(kind.feature, first);
        const bool samples = gradient.light_first.valid();
        Kernel &light_first = samples ? gradient.light_first : close_links_;
        Kernel &light_apart = samples ? gradient.light_apart : close_links_;
        for (const auto &[phase, light] : {std::pair(first, &light_first), {apart, &light_apart}}) {
            if (vertices.rows[phase].count == 0)
                continue;
            light->set("link_stride", vertices.shifting());
            run_on(*light, phase);
            run_on(gradient.scatter_apart, phase);
        }
        run_on(gradient.light_joined, joined);
        run_on(gradient.scatter_joined, joined);
        run_on(kind.light_sample, later);
        run_on(kind.scatter, later);
    }
}

bool GradientPathTracer::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    if (!direct_edges_ && settings_.max_depth != 0 && !settings_.hide_emitters)
        direct_edges_ = sample_direct_edges(scene_tables_, film_settings_, tracer_, options_.seed,
                                            static_cast<std::uint32_t>(settings_.samples_per_pixel), edge_rays_);
    statistics_.rays["edge"] = edge_rays_;
    const std::uint32_t paths = begin_pass();
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
        if (vertices.count + fresh == 0)
            break;
        trace(vertices.count + fresh, vertices.count);

        const Buffer &old_vertex = tables_->vertex[newest], &new_vertex = tables_->vertex[1 - newest];
        const Vertices next = partition(vertices, fresh, old_vertex);
        for (Kernel *kernel : more_kernels_) {
            kernel->bind("vertex_old", old_vertex);
            kernel->bind("vertex", new_vertex);
            kernel->bind("shifted_old", shifted_[newest]);
            kernel->bind("shifted", shifted_[1 - newest]);
        }
        for (Kernel *kernel : {&shift_[0], &shift_[1], &shift_escaped_[0], &shift_escaped_[1]})
            if (kernel->valid())
                kernel->bind("vertex", old_vertex);
        for (Kernel *kernel : {&surface_, &escape_, &emission_})
            if (kernel->valid()) {
                kernel->bind("vertex_old", old_vertex);
                kernel->bind("vertex", new_vertex);
            }
        const Shiftings shiftings = shift(vertices, next);
        connect(vertices, old_vertex);
        const Shifting &apart_sent = shiftings.surface[apart];
        if (apart_sent.index.count > 0) {
            offset_surface_.set("escaped", next.escaped_count);
            offset_surface_.set("link_first", apart_sent.link_first);
            offset_surface_.set("link_stride", apart_sent.index.count);
            offset_surface_.set("offset_first", apart_sent.offset_first);
            offset_surface_.set("offset_stride", apart_sent.index.count);
            run(offset_surface_, next.rows[apart].first, next.rows[apart].count);
        }
        emit(next, shiftings);
        run(clear_, next.escaped[first].first, next.escaped[first].count);
        for (std::size_t k = 0; k < kinds_.size(); ++k)
            if (!gradient_kinds_[k].light_first.valid())
                run(clear_, next.escaped_count + next.kinds[first][k].first, next.kinds[first][k].count);
        run(surface_, next.escaped_count, next.count);
        for (const Phase phase : {apart, joined}) {
            settle_.set("link_first", shiftings.surface[phase].link_first);
            settle_.set("link_stride", next.rows[phase].count);
            run(settle_, next.rows[phase].first, next.rows[phase].count);
            count_outcomes(next.rows[phase]);
        }
        run(offset_begin_, next.rows[first].first, next.rows[first].count);
        newest = 1 - newest;
        vertices = next;
        scatter(vertices, tables_->vertex[newest]);
    }
    run(combine_, 0, paths);
    film_->accumulate(paths, 0);
    const std::uint32_t frames = paths / film_->pixels();
    for (std::uint32_t frame = 0; frame < frames; frame += accumulated_frames) {
        gradient_accumulate_.set("first_slot", frame * film_->pixels());
        gradient_accumulate_.set("frames", std::min(accumulated_frames, frames - frame));
        run(gradient_accumulate_, 0, film_->pixels());
    }
    return end_pass(paths, start);
}

void GradientPathTracer::restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel) {
    PathTracer::restart(first_sample, samples_per_pixel);
    gradient_film_.clear();
    outcome_.clear();
}

Image GradientPathTracer::image() {
    statistics_.non_finite = 0;
    const Image whole = film_->image(done_, statistics_.non_finite);
    if (!solver_)
        solver_ = std::make_unique<PoissonSolver>(device_, film_settings_.crop_width, film_settings_.crop_height, 3);
    return reconstruct(*solver_, whole,
                       read_gradient_film(HostTable(gradient_film_, film_->pixels(), options_.precision),
                                          film_->pixels(), done_ / film_->pixels()),
                       direct_edges_.value_or(std::vector<DirectPixel>()), options_);
}

void GradientPathTracer::count_outcomes(Range rows) {
    if (rows.count == 0)
        return;
    const std::uint32_t chunks = chunks_of(rows.count);
    count_.set("first", rows.first);
    count_.set("count", rows.count);
    count_.set("chunks", chunks);
    count_.launch(chunks);
}

Statistics GradientPathTracer::statistics() const {
    Statistics s = PathTracer::statistics();
    std::vector<std::uint32_t> found(outcome_.bytes() / sizeof(std::uint32_t));
    outcome_.read(found.data(), outcome_.bytes());
#define GRADUS_OUTCOME_NAME(name, text) #name,
    const char *const names[] = {GRADUS_SHIFT_OUTCOMES(GRADUS_OUTCOME_NAME)};
#undef GRADUS_OUTCOME_NAME
    const std::size_t chunks = found.size() / shift_outcomes;
    for (std::size_t i = 0; i < found.size(); ++i)
        s.shifts[names[i / chunks]] += found[i];
    return s;
}

} // namespace gradus
