#include "methods/gradient_photon_mapper.h"

#include "kernels/shared/tables.h"
#include "methods/gradient_image.h"
#include "methods/path_stages.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/segments.h"

#include <algorithm>
#include <chrono>

namespace gradus {

using namespace lib_float;

namespace {

constexpr std::uint32_t planes = 5; // the paths of pixels, and four offset paths of each

/// By material record, the place of its kind in SceneTables::kinds; bin_none for those whose direction is given, where
/// photons do not come to another place.
std::vector<std::uint32_t> material_bins(const Scene &scene, const Session &session) {
    const std::vector<std::string> &kinds = session.scene.kinds;
    std::vector<std::uint32_t> bins;
    for (const Bsdf &bsdf : material_records(scene)) {
        const auto kind = std::find(kinds.begin(), kinds.end(), bsdf_kind_name(bsdf));
        const bool is_dirac = bsdf_kind_is_dirac(bsdf_kind_name(bsdf));
        bins.push_back(is_dirac || kind == kinds.end() ? bin_none : std::uint32_t(kind - kinds.begin()));
    }
    return bins;
}

} // namespace

GradientPhotonMapper::GradientPhotonMapper(Device &device, const Scene &scene, const RenderOptions &options)
    : options_(options),
      session_(device, checked_for_gathering(scene, options), options, {{"TRAIT_LIGHT_VERTICES", 1}}),
      paths_(session_, stages_, scene, options, true), photons_(session_, stages_, scene, options),
      pairs_(stages_, true), bin_(stages_.add({.name = "gather_bin"})),
      order_(stages_, "gather", std::uint32_t(session_.scene.kinds.size()), RowsOf::slot),
      evaluate_(stages_.add({.name = "photon_evaluate", .by_kind = true})),
      shift_(stages_.add({.name = "photon_shift", .by_kind = true})),
      moved_(stages_, "moved", std::uint32_t(session_.scene.kinds.size()), RowsOf::path, 4 * PhotonPairs::pair_rows(1)),
      reconnect_(stages_.add({.name = "photon_reconnect", .by_kind = true, .numbers = {"first", "pairs"}})),
      arrive_(stages_.add({.name = "photon_arrive", .by_kind = true, .numbers = {"pairs"}})),
      sum_(stages_.add(pairs_.sum_stage("pair_difference_sum"))),
      gradient_gather_(stages_.add({.name = "gradient_gather"})),
      combine_(stages_.add({.name = "gradient_combine", .strict = true})), film_(session_, stages_),
      accumulate_(stages_.add({.name = "gradient_accumulate", .strict = true, .numbers = {"first_slot", "frames"}})),
      carry_(stages_.add({.name = "gradient_carry", .numbers = {"first_slot"}})) {
    const std::vector<std::uint32_t> bins = material_bins(scene, session_);
    session_.scene_buffers.emplace_back(device, "material_bin", bins.data(), bins.size() * sizeof(bins[0]));
    total_ = std::uint64_t(session_.pixels()) * session_.settings.samples_per_pixel;
    allocate();
}

TableList GradientPhotonMapper::tables() const {
    const std::uint32_t pairs = PhotonPairs::pair_rows(1);
    return {{.name = "direct", .rows = RowsOf::slot, .columns = radiance_columns},
            {.name = "prefix", .rows = RowsOf::slot, .columns = prefix_columns},
            {.name = "difference", .rows = RowsOf::slot, .multiple = 4, .columns = difference_columns},
            {.name = "pair_difference", .multiple = 4 * pairs, .columns = pair_difference_columns},
            {.name = "moved", .multiple = 4 * pairs, .columns = moved_columns},
            {.name = "carry", .rows = RowsOf::image_row, .columns = carry_columns, .is_cleared = true},
            {.name = "gradient_film", .rows = RowsOf::pixel, .columns = gradient_film_columns, .is_cleared = true}};
}

void GradientPhotonMapper::allocate() {
    TableList list = joined(joined(paths_.tables(), film_.tables()), joined(photons_.tables(), pairs_.tables()));
    list = joined(list, joined(joined(order_.tables(), moved_.tables()), tables()));
    const std::uint32_t width = session_.film.crop_width, height = session_.film.crop_height;
    const std::uint32_t batch = choose_batch_size(session_.device, options_.batch_size,
                                                  planes * std::uint64_t(session_.pixels()), list, options_.precision);
    strip_rows_ = std::clamp(batches_a_pass * batch / planes / width, 1u, height);
    tables_.emplace(session_.device, list, table_rows(session_, batch, planes * strip_rows_ * width),
                    options_.precision);
    session_.numbers["capacity"] = batch;
    session_.numbers["slots"] = tables_->rows().slots;
    session_.numbers["gather_rows"] = tables_->rows().slots;
    session_.numbers["pair_rows"] = PhotonPairs::pair_rows(batch);
    set_divisor(session_, "strip", "strip_pixels", strip_rows_ * width);
    session_.numbers["strip_first"] = 0;
    photons_.attach(*tables_);
    stages_.build(session_, *tables_);
    paths_.attach(*tables_);
    pairs_.attach(*tables_);
    order_.attach(*tables_);
    moved_.attach(*tables_);
    film_.attach(*tables_);
}

GradientPhotonMapper::Strip GradientPhotonMapper::next_strip() const {
    const std::uint32_t width = session_.film.crop_width;
    Strip strip;
    strip.first = static_cast<std::uint32_t>(done_ % session_.pixels() / width);
    strip.rows = std::min(strip_rows_, session_.film.crop_height - strip.first);
    strip.pixels = strip.rows * width;
    return strip;
}

/// Tells the stages which pixels the slots belong to.
void GradientPhotonMapper::begin_strip(const Strip &strip) {
    set_divisor(session_, "strip", "strip_pixels", strip.pixels);
    session_.numbers["strip_first"] = strip.first;
    for (const char *number : {"strip_pixels", "strip_multiplier", "strip_shift", "strip_first"})
        stages_.set(number, session_.numbers[number]);
}

bool GradientPhotonMapper::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    if (!solver_ && !solver_compiled_.valid()) // with one thread, once it is needed
        solver_compiled_ = std::async(options_.threads == 1 ? std::launch::deferred : std::launch::async, [this] {
            PoissonSolver::compile(session_.device, poisson_options(options_, session_.settings.samples_per_pixel));
        });
    if (!direct_edges_ && session_.max_depth() != 0 && !session_.settings.hide_emitters)
        direct_edges_ =
            sample_direct_edges(session_.scene, session_.film, session_.tracer, options_.seed,
                                static_cast<std::uint32_t>(session_.settings.samples_per_pixel), edge_rays_);
    const Strip strip = next_strip();
    const std::uint64_t pass = done_ / session_.pixels();
    begin_strip(strip);
    if (session_.max_depth() == 0) { // no path begins
        for (const char *table : {"radiance", "feature", "direct", "prefix", "difference"})
            if (tables_->has(table))
                (*tables_)[table].clear();
    } else {
        photons_.begin(pass);
        paths_.trace(planes * strip.pixels, strip.first * session_.film.crop_width, pass, [](const Hits &) {});
        gather_photons(strip);
    }
    add_to_film(strip);
    finish(session_.device);
    done_ += strip.pixels;
    statistics_.samples += strip.pixels;
    statistics_.render_seconds += seconds_since(start);
    return done_ < total_;
}

void GradientPhotonMapper::gather_photons(const Strip &strip) {
    bin_.run(strip.pixels);
    order_.run(strip.pixels);
    const std::uint32_t most = tables_->rows().paths;
    for (std::uint32_t kind = 0; kind < paths_.kinds(); ++kind) {
        const Range all = order_.bin(kind);
        statistics_.gather_points += all.count;
        for (std::uint32_t from = 0; from < all.count; from += most)
            statistics_.photon_pairs +=
                pairs_.find({all.first + from, std::min(most, all.count - from)}, [&](const PairWindow &window) {
                    evaluate_.run_kind(kind, window.pairs);
                    shift_photons(kind, window);
                    pairs_.sum(window);
                    sum_.run_planes(0, window.rows, 4,
                                    {{"first", window.first},
                                     {"from", window.from},
                                     {"window_first", window.window_first},
                                     {"window_pairs", window.pairs}});
                });
    }
    gradient_gather_.run(strip.pixels);
}

/// The differences of the pairs in a window, whose gather points are of one BSDF kind.
void GradientPhotonMapper::shift_photons(std::size_t kind, const PairWindow &window) {
    shift_.run_planes(kind, window.pairs, 4);
    moved_.run(4 * window.pairs);
    for (std::uint32_t last = 0; last < paths_.kinds(); ++last)
        reconnect_.run_kind(last, moved_.bin(last).count, {{"first", moved_.bin(last).first}, {"pairs", window.pairs}});
    const TraceCounts counts = trace_segments(session_.tracer, options_.precision,
                                              {&(*tables_)["moved"], tables_->rows_of("moved"), moved_.count(),
                                               moved_origin_x, moved_direction_x, moved_primitive},
                                              {}, session_.trace_seconds);
    session_.rays["offset"] += counts.extension;
    arrive_.run_kind(kind, moved_.count(), {{"pairs", window.pairs}});
}

void GradientPhotonMapper::add_to_film(const Strip &strip) {
    const std::uint32_t width = session_.film.crop_width;
    combine_.run(strip.pixels);
    film_.add(strip.pixels, strip.first * width);
    accumulate_.run(strip.pixels, {{"first_slot", 0}, {"frames", 1}});
    if (strip.first + strip.rows < session_.film.crop_height)
        carry_.run(width, {{"first_slot", strip.pixels - width}});
}

Image GradientPhotonMapper::make_image(bool layers, bool last) {
    if (last) // what a pass needs and the films do not
        tables_->release_all_but({"film", "feature_film", "gradient_film"});
    statistics_.non_finite = 0;
    Image whole = film_.image(done_, statistics_.non_finite);
    if (last)
        tables_->release_all_but({"gradient_film"});
    if (solver_compiled_.valid())
        solver_compiled_.get();
    if (!solver_)
        solver_ =
            std::make_unique<PoissonSolver>(session_.device, session_.film.crop_width, session_.film.crop_height, 3);
    Image image = reconstruct(*solver_, std::move(whole),
                              std::make_unique<GradientFilm>((*tables_)["gradient_film"], session_.film.crop_width,
                                                             session_.film.crop_height, options_.precision, done_),
                              direct_edges_.value_or(std::vector<DirectPixel>()), options_, layers, [&] {
                                  if (last)
                                      tables_->release_all_but({});
                              });
    if (last)
        solver_.reset();
    return image;
}

Statistics GradientPhotonMapper::statistics() const {
    Statistics s = statistics_;
    s.light_paths = photons_.light_paths().light_paths();
    s.photons = photons_.light_paths().photons();
    s.radius_sum = pairs_.radius_sum();
    s = collected(s, session_, stages_, photons_.light_paths().times());
    s.rays["edge"] = edge_rays_;
    return s;
}

std::unique_ptr<Method> make_gradient_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<GradientPhotonMapper>(device, scene, options);
}

} // namespace gradus
