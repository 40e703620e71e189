#include "runtime/methods/path_tracer.h"

#include "runtime/error.h"
#include "runtime/seconds_since.h"
#include "runtime/stages/invariant_division.h"
#include "runtime/stages/trace_stage.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <limits>

namespace gradus {

namespace {

constexpr std::uint32_t deepest = 1u << 16; // where a file asks for paths without end

TraitMap traits_for(const Scene &scene, const RenderOptions &options, const TraitMap &more) {
    TraitMap traits = scene_traits(scene);
    traits["TRAIT_AOV"] = options.aov;
    if (options.all_traits)
        traits = with_all_traits(traits);
    // Settings of a method, which no scene has.
    traits["TRAIT_SHARED_JITTER"] = 0;
    traits["STRATEGY"] = static_cast<int>(options.strategy);
    for (const auto &[name, value] : more)
        traits[name] = value;
    return traits;
}

FilmSettings with_crop(FilmSettings film) {
    if (film.crop_width == 0 || film.crop_height == 0) {
        film.crop_x = film.crop_y = 0;
        film.crop_width = film.width;
        film.crop_height = film.height;
    }
    if (film.width == 0 || film.height == 0 || film.crop_x + film.crop_width > film.width ||
        film.crop_y + film.crop_height > film.height)
        throw Error(ExitCode::usage,
                    fmt::format("the crop {}x{} at {},{} does not lie in the film of {}x{}", film.crop_width,
                                film.crop_height, film.crop_x, film.crop_y, film.width, film.height));
    if (std::uint64_t(film.width) * film.height >= std::numeric_limits<std::int32_t>::max())
        throw Error(ExitCode::usage, fmt::format("a film of {}x{} has too many pixels", film.width, film.height));
    return film;
}

} // namespace

PathTracer::PathTracer(Device &device, const Scene &scene, const RenderOptions &options)
    : PathTracer(device, scene, options, TraitMap()) {
    prepare(Additions());
}

PathTracer::PathTracer(Device &device, const Scene &scene, const RenderOptions &options, const TraitMap &more_traits)
    : device_(device), options_(options), settings_(scene.settings), film_settings_(with_crop(scene.film)),
      traits_(traits_for(scene, options, more_traits)), scene_tables_(make_scene_tables(scene, traits_)),
      tracer_(scene, options.threads) {}

void PathTracer::prepare(const Additions &additions) {
    const std::uint32_t pixels = film_settings_.crop_width * film_settings_.crop_height;
    total_ = pixels * settings_.samples_per_pixel;
    const std::uint32_t bins = static_cast<std::uint32_t>(additions.phases * (1 + 2 * scene_tables_.kinds.size()));
    const std::uint32_t capacity = choose_batch_size(device_, options_.batch_size, total_, traits_, options_.precision);
    std::uint64_t pass =
        std::min<std::uint64_t>(batches_a_pass * std::uint64_t(capacity), std::max<std::uint64_t>(total_, 1));
    if (additions.whole_frames)
        pass = std::max<std::uint64_t>(pass / pixels, 1) * pixels;
    pass_ = static_cast<std::uint32_t>(pass);
    tables_.emplace(device_, capacity, pass_, bins, traits_, options_.precision);
    scene_buffers_.emplace(device_, scene_tables_, options_.precision);
    build_kernels(scene_tables_.kinds, additions);
    film_.emplace(device_, accumulate_, *tables_, film_settings_.crop_width, film_settings_.crop_height, traits_,
                  options_.precision);
    partition_.emplace(partition_kernels_, *tables_, bins);
    if (additions.bind)
        additions.bind();
    warm(all_kernels());
}

KernelRequest PathTracer::request_of(const std::string &stage) {
    return {stage, "kernels/stages/" + stage + ".cl", stage, {}};
}

KernelRequest PathTracer::request_of(const std::string &stage, const std::string &kind) {
    return {stage + " " + kind,
            "kernels/stages/" + stage + ".cl",
            stage,
            {{"BSDF", kind}, {"BSDF_IS_DIRAC", bsdf_kind_is_dirac(kind) ? "1" : "0"}}};
}

void PathTracer::build_kernels(const std::vector<std::string> &kinds, const Additions &additions) {
    std::vector<Wanted> wanted;
    const auto want = [&](Kernel &place, const std::string &stage) { wanted.push_back({&place, request_of(stage)}); };
    want(camera_, "camera");
    want(classify_, "classify");
    if (additions.phases > 1)
        wanted.back().request.definitions["PHASES"] = std::to_string(additions.phases) + "u";
    want(surface_, "surface");
    want(connect_, "connect");
    if (escape_wanted())
        want(escape_, "escape");
    if (emission_wanted())
        want(emission_, "emission");
    wanted.push_back({&accumulate_, FilmStage::request()});
    const std::vector<KernelRequest> partition = PartitionStage::requests();
    partition_kernels_.resize(partition.size());
    for (std::size_t i = 0; i < partition.size(); ++i)
        wanted.push_back({&partition_kernels_[i], partition[i]});
    kinds_.resize(kinds.size());
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        KindKernels &kind = kinds_[k];
        kind.is_dirac = bsdf_kind_is_dirac(kinds[k]);
        const auto want_variant = [&](Kernel &place, const std::string &stage) {
            wanted.push_back({&place, request_of(stage, kinds[k])});
        };
        if (options_.aov)
            want_variant(kind.feature, "feature");
        if (samples_lights(kind.is_dirac))
            want_variant(kind.light_sample, "light_sample");
        want_variant(kind.scatter, "scatter");
    }

    for (const Wanted &more : additions.kernels) {
        wanted.push_back(more);
        more_kernels_.push_back(more.place);
    }

    std::vector<KernelRequest> requests;
    for (const Wanted &w : wanted)
        requests.push_back(w.request);
    KernelLibrary library(device_, traits_, options_.precision, options_.work_group_size);
    const std::vector<Kernel> built = library.build(
        requests,
        [&](const std::string &name, std::size_t ready, std::size_t total, double seconds) {
            if (seconds > 0)
                statistics_.compile_seconds[name] += seconds;
            if (seconds > 0 && options_.on_compiled)
                options_.on_compiled(name, ready, total, seconds);
        },
        options_.dump_kernels);
    for (std::size_t i = 0; i < wanted.size(); ++i)
        *wanted[i].place = built[i];

    for (Kernel *kernel : all_kernels())
        bind_common(*kernel);
    classify_.set("bins_of_phase", static_cast<std::uint32_t>(1 + 2 * kinds.size()));
    bind_film_place(camera_);
    camera_.set("crop_x", film_settings_.crop_x);
    camera_.set("crop_y", film_settings_.crop_y);
    camera_.set("film_width", film_settings_.width);
    camera_.set("seed_low", static_cast<std::uint32_t>(options_.seed));
    camera_.set("seed_high", static_cast<std::uint32_t>(options_.seed >> 32));
}

void PathTracer::bind_common(Kernel &kernel) const {
    scene_buffers_->bind(kernel);
    for (const Buffer *buffer : {&tables_->ray, &tables_->shadow, &tables_->radiance, &tables_->feature,
                                 &tables_->tangent, &tables_->bin, &tables_->index, &tables_->vertex[0]})
        kernel.bind(*buffer);
    kernel.bind("vertex_old", tables_->vertex[1]);
    for (const char *number : {"count", "first", "chunks", "first_row", "first_pixel", "first_slot", "first_sample_low",
                               "first_sample_high"})
        kernel.set(number, 0);
    kernel.set("max_depth", max_depth());
    // Mitsuba's rr_depth; a negative one means none.
    kernel.set("roulette_depth", settings_.rr_depth < 0 ? 0xFFFFFFFFu : std::uint32_t(settings_.rr_depth));
    kernel.set("slots", tables_->slots);
    kernel.set("capacity", tables_->capacity);
}

void PathTracer::bind_film_place(Kernel &kernel) const {
    const std::uint32_t pixels = film_settings_.crop_width * film_settings_.crop_height;
    const InvariantDivision by_pixels = invariant_division(pixels);
    const InvariantDivision by_width = invariant_division(film_settings_.crop_width);
    kernel.set("pixels", pixels);
    kernel.set("pixels_multiplier", by_pixels.multiplier);
    kernel.set("pixels_shift", by_pixels.shift);
    kernel.set("width_multiplier", by_width.multiplier);
    kernel.set("width_shift", by_width.shift);
    kernel.set("crop_width", film_settings_.crop_width);
    kernel.set("crop_height", film_settings_.crop_height);
}

bool PathTracer::samples_lights(bool is_dirac) const {
    return !is_dirac && scene_tables_.light_count > 0 && options_.strategy != RenderOptions::Strategy::bsdf;
}

std::vector<Kernel *> PathTracer::all_kernels() {
    std::vector<Kernel *> kernels = {&camera_, &classify_, &surface_, &escape_, &connect_, &emission_, &accumulate_};
    for (Kernel &kernel : partition_kernels_)
        kernels.push_back(&kernel);
    for (KindKernels &kind : kinds_)
        for (Kernel *kernel : {&kind.feature, &kind.light_sample, &kind.scatter})
            kernels.push_back(kernel);
    kernels.insert(kernels.end(), more_kernels_.begin(), more_kernels_.end());
    std::erase_if(kernels, [](const Kernel *kernel) { return !kernel->valid(); });
    return kernels;
}

/// A launch on no rows takes less than a thousandth of that, and no compiler is so fast.
constexpr double least_compile_seconds = 0.02;

/// Some implementations compile at the first launch: do that now, on no rows, and say what it took.
void PathTracer::warm(std::vector<Kernel *> kernels) {
    for (std::size_t i = 0; i < kernels.size(); ++i) {
        const auto start = std::chrono::steady_clock::now();
        kernels[i]->set("count", 0);
        kernels[i]->launch(1);
        finish(device_);
        kernels[i]->reset_usage();
        const double seconds = seconds_since(start);
        if (seconds < least_compile_seconds)
            continue; // it was there
        statistics_.compile_seconds[kernels[i]->name()] += seconds;
        if (options_.on_compiled)
            options_.on_compiled(kernels[i]->name(), i + 1, kernels.size(), seconds);
    }
}

std::uint32_t PathTracer::max_depth() const {
    return settings_.max_depth < 0 ? deepest : static_cast<std::uint32_t>(settings_.max_depth);
}

void PathTracer::begin_paths(std::uint32_t row, std::uint32_t slot, std::uint32_t count, const Buffer &vertex) {
    camera_.bind("vertex", vertex);
    camera_.set("count", count);
    camera_.set("first_row", row);
    camera_.set("first_slot", slot);
    camera_.launch(count);
}

void PathTracer::trace(std::uint32_t rays, std::uint32_t shadows) {
    const TraceCounts counts = run_trace_stage(tracer_, *tables_, rays, shadows, trace_seconds_);
    statistics_.rays["extension"] += counts.extension;
    statistics_.rays["shadow"] += counts.shadow;
}

void PathTracer::run(Kernel &kernel, std::uint32_t first, std::uint32_t items) {
    if (items == 0 || !kernel.valid())
        return;
    kernel.set("first", first);
    kernel.set("count", items);
    kernel.launch(items);
}

std::uint32_t PathTracer::begin_pass() {
    const std::uint64_t first_sample = first_sample_ + done_ / film_->pixels();
    camera_.set("first_pixel", static_cast<std::uint32_t>(done_ % film_->pixels()));
    camera_.set("first_sample_low", static_cast<std::uint32_t>(first_sample));
    camera_.set("first_sample_high", static_cast<std::uint32_t>(first_sample >> 32));
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(pass_, total_ - done_));
}

bool PathTracer::end_pass(std::uint32_t paths, std::chrono::steady_clock::time_point start) {
    finish(device_);
    done_ += paths;
    statistics_.samples += paths;
    statistics_.render_seconds += seconds_since(start);
    return done_ < total_;
}

void PathTracer::restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel) {
    first_sample_ = first_sample;
    done_ = 0;
    total_ = film_->pixels() * samples_per_pixel;
    film_->clear();
    Statistics fresh;
    fresh.compile_seconds = statistics_.compile_seconds;
    statistics_ = fresh;
    trace_seconds_ = 0;
    for (Kernel *kernel : all_kernels())
        kernel->reset_usage();
}

bool PathTracer::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t first_pixel = static_cast<std::uint32_t>(done_ % film_->pixels());
    const std::uint32_t paths = begin_pass();

    if (settings_.max_depth == 0) { // no path begins, so none sets its row to zero
        tables_->radiance.clear();
        tables_->feature.clear();
    }
    int newest = 0;
    std::uint32_t begun = 0;    // paths of this pass
    std::uint32_t vertices = 0; // rows of the newest vertices; the same rows of the ray table hold what they sent out
    for (;;) {
        // New paths fill the rows that others have left.
        const std::uint32_t fresh =
            settings_.max_depth == 0 ? 0 : std::min(tables_->capacity - vertices, paths - begun);
        begin_paths(vertices, begun, fresh, tables_->vertex[newest]);
        begun += fresh;
        const std::uint32_t rays = vertices + fresh;
        if (rays == 0)
            break;

        trace(rays, vertices);
        connect_.bind("vertex", tables_->vertex[newest]);
        run(connect_, 0, vertices);

        run(classify_, 0, rays);
        const std::vector<std::uint32_t> &range = partition_->run(rays);
        const std::uint32_t escaped = range[1], hits = range.back() - escaped;
        for (Kernel *kernel : {&surface_, &escape_, &emission_}) {
            if (!kernel->valid())
                continue;
            kernel->bind("vertex_old", tables_->vertex[newest]);
            kernel->bind("vertex", tables_->vertex[1 - newest]);
        }
        run(escape_, 0, escaped);
        for (std::size_t k = 0; k < kinds_.size(); ++k)
            run(emission_, range[2 + 2 * k], range[3 + 2 * k] - range[2 + 2 * k]);
        run(surface_, escaped, hits);
        newest = 1 - newest;
        vertices = hits;

        for (std::size_t k = 0; k < kinds_.size(); ++k) {
            const std::uint32_t first = range[1 + 2 * k] - escaped, items = range[3 + 2 * k] - range[1 + 2 * k];
            KindKernels &kind = kinds_[k];
            for (Kernel *kernel : {&kind.feature, &kind.light_sample, &kind.scatter}) {
                if (!kernel->valid())
                    continue;
                kernel->bind("vertex", tables_->vertex[newest]);
                run(*kernel, first, items);
            }
        }
    }
    film_->accumulate(paths, first_pixel);
    return end_pass(paths, start);
}

Image PathTracer::image() {
    statistics_.non_finite = 0;
    return film_->image(done_, statistics_.non_finite);
}

Statistics PathTracer::statistics() const {
    Statistics s = statistics_;
    // The kernels of a stage may be several; a path meets them in this order.
    const auto stage = [&](const Kernel &kernel) {
        if (!kernel.valid())
            return;
        const Kernel::Usage usage = kernel.usage();
        s.stages.push_back({kernel.name(), usage.seconds, usage.items, usage.launches});
    };
    stage(camera_);
    std::uint64_t traced = 0;
    for (const auto &[kind, count] : s.rays)
        traced += count;
    s.stages.push_back({"trace", trace_seconds_, traced, 0});
    stage(connect_);
    stage(classify_);
    for (const Kernel &kernel : partition_kernels_)
        stage(kernel);
    stage(escape_);
    stage(emission_);
    stage(surface_);
    for (const KindKernels &kind : kinds_) {
        stage(kind.feature);
        stage(kind.light_sample);
        stage(kind.scatter);
    }
    for (const Kernel *kernel : more_kernels_)
        stage(*kernel);
    stage(accumulate_);
    std::erase_if(s.stages, [](const Statistics::Stage &row) { return row.items == 0; });
    double known = 0;
    for (const Statistics::Stage &row : s.stages)
        known += row.seconds;
    s.stages.push_back({"launch and wait", std::max(0.0, s.render_seconds - known), 0, 0});
    s.device_bytes = peak_device_bytes(device_);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    s.peak_host_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    return s;
}

} // namespace gradus
