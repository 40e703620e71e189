#include "methods/gradient_photon_mapper.h"

#include "kernels/shared/tables.h"
#include "methods/error_layer.h"
#include "methods/path_stages.h"
#include "methods/photons/moved_by_surface.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/sample_parts.h"
#include "runtime/wavefront/segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace gradus {

using namespace lib_float;

namespace {

constexpr std::uint32_t planes = 5; // the paths of pixels, and four offset paths of each

// Specular vertices that a photon may have come by one after the other, and still be shifted.
constexpr std::uint32_t most_inner = 6;

/// Where light may come straight from a light, or by specular vertices alone, shifts ask how it left.
TraitMap light_vertex_traits(const Scene &scene, const RenderOptions &options) {
    TraitMap traits = {
        {"TRAIT_LIGHT_VERTICES", 1},
        {"TRAIT_LIGHT_STARTS", options.direct_photons || options.all_traits || !walked_kinds(scene, options).empty()},
        {"TRAIT_ONLY_CHAINS", options.only_chains},
        {"TRAIT_AOV", options.all_traits || needs_features(options)},
        {"TRAIT_PART_BITS", part_bits(options, needs_halves(options.reconstruction))}};
    traits.merge(gather_traits(scene, options));
    return traits;
}

const Scene &checked(const Scene &scene) {
    if (const std::string reason = reason_against_gpm(scene); !reason.empty())
        throw Error(ExitCode::usage, reason);
    return scene;
}

/// What is done by the kind of the vertex that light leaves, or where that is on a light.
StageDeclaration leaving_stage(const char *name, bool is_light, bool is_wanted, std::vector<std::string> numbers) {
    return {.name = std::string(name) + (is_light ? " light" : ""),
            .file = name,
            .definitions = {{"LAST_IS_LIGHT", is_light ? "1" : "0"}},
            .by_kind = !is_light,
            .dirac = DiracKinds::left_out,
            .is_wanted = is_wanted,
            .numbers = std::move(numbers)};
}

const std::vector<std::string> leave_numbers = {"first", "pairs", "chain_rows", "chain_vertices", "leave_bin"};
const std::vector<std::string> chain_numbers = {"first", "pairs", "chain_rows", "chain_vertices"};

} // namespace

std::string reason_against_gpm(const Scene &scene) {
    // Walks would have to know how normals of an instance change.
    if (!scene.instances.empty())
        return "gpm knows no instances; pt, gpt and sppm do, and --instances copies makes shapes of them";
    return "";
}

GradientPhotonMapper::GradientPhotonMapper(Device &device, const Scene &scene, const RenderOptions &options)
    : options_(options),
      session_(device, checked_for_gathering(checked(scene), options), options, light_vertex_traits(scene, options)),
      walked_kinds_(walked_kinds(scene, options)), paths_(session_, stages_, scene, options, true),
      photons_(session_, stages_, scene, options, 0.5, needs_halves(options.reconstruction)), pairs_(stages_, true),
      bin_(stages_.add({.name = "gather_bin"})),
      order_(session_, stages_, "gather", first_kind_bin + std::uint32_t(session_.scene.kinds.size()), RowsOf::slot),
      evaluate_(stages_.add({.name = "photon_evaluate", .by_kind = true, .dirac = DiracKinds::left_out})),
      shift_(stages_.add({.name = "photon_shift", .by_kind = true, .dirac = DiracKinds::left_out})),
      moved_(session_, stages_, "moved", light_bin() + 1, RowsOf::path, 4 * PhotonPairs::pair_rows(1)),
      reconnect_(stages_.add(leaving_stage("photon_reconnect", false, true, {"first", "pairs"}))),
      reconnect_light_(stages_.add(leaving_stage("photon_reconnect", true, true, {"first", "pairs"}))),
      project_(stages_.add({.name = "photon_project", .is_wanted = has_chains(), .numbers = {"first", "pairs"}})),
      walk_(stages_.add({.name = "photon_walk", .is_wanted = has_chains(), .numbers = chain_numbers})),
      leave_(stages_.add(leaving_stage("photon_leave", false, has_chains(), leave_numbers))),
      leave_light_(stages_.add(leaving_stage("photon_leave", true, has_chains(), leave_numbers))),
      pass_(stages_.add({.name = "photon_pass",
                         .definitions = {{"LAST_KIND", "0"}},
                         .by_kind = true,
                         .only_kinds = walked_kinds_,
                         .is_wanted = has_chains(),
                         .numbers = chain_numbers})),
      end_(stages_.add({.name = "photon_pass end",
                        .file = "photon_pass",
                        .definitions = {{"LAST_KIND", "1"}},
                        .is_wanted = has_chains(),
                        .numbers = {"first", "chain_rows", "chain_vertices"}})),
      count_(stages_.add({.name = "photon_count",
                          .definitions = {{"PARTITION_CHUNK", std::to_string(partition_chunk)}},
                          .numbers = {"first", "rows", "to"}})),
      bias_(session_, stages_, pairs_, options, true),
      arrive_(
          stages_.add({.name = "photon_arrive", .by_kind = true, .dirac = DiracKinds::left_out, .numbers = {"pairs"}})),
      sum_(stages_.add(pairs_.sum_stage("pair_difference_sum"))),
      gradient_gather_(stages_.add({.name = "gradient_gather"})),
      film_(session_, stages_, options_, "photon_found", false) {
    check_error(options, "gpm");
    if (has_chains())
        manifold_walk_.emplace(session_, stages_, WalkSettings{.most_vertices = most_inner});
    const std::vector<std::string> &kinds = session_.scene.kinds;
    session_.add_scene_buffer("bin_of_material", bins_of_kinds(scene, kinds));
    session_.add_scene_buffer("leaving_bin", bins_of_leaving(scene, kinds, options));
    session_.add_scene_buffer("walked_kind", kinds_for_walks(scene, options.gather_roughness));
    statistics_.surfaces = gathering_surfaces(scene, options.gather_roughness);
    total_ = std::uint64_t(session_.pixels()) * session_.settings.samples_per_pixel;
    allocate();
}

TableList GradientPhotonMapper::tables() const {
    const std::uint32_t pairs = PhotonPairs::pair_rows(1);
    return {{.name = "pair_difference", .multiple = 4 * pairs, .columns = pair_difference_columns},
            {.name = "moved", .multiple = 4 * pairs, .columns = moved_columns},
            {.name = "moved_link", .columns = std::uint32_t(has_chains() ? moved_link_columns : 0)},
            {.name = "photon_found", .multiple = 2, .is_uint = true, .is_cleared = true}};
}

void GradientPhotonMapper::allocate() {
    TableList list = joined(joined(paths_.tables(), film_.tables()), joined(photons_.tables(), pairs_.tables()));
    list = joined(list, bias_.tables());
    list = joined(list, joined(joined(order_.tables(), moved_.tables()), tables()));
    if (manifold_walk_)
        list = joined(list, manifold_walk_->tables());
    const std::uint32_t width = session_.width(), height = session_.height();
    const std::uint64_t paths = planes * std::uint64_t(session_.pixels());
    const std::uint32_t batch =
        choose_batch_size(session_.device, options_.batch_size,
                          std::max<std::uint64_t>(paths, PhotonPairs::least_batch), list, options_.precision);
    strip_rows_ = std::clamp(batches_a_pass * batch / planes / width, 1u, height);
    if (strip_rows_ == height)
        film_.carry_nothing();
    tables_.emplace(session_.device, list, table_rows(session_, batch, planes * strip_rows_ * width),
                    options_.precision);
    session_.numbers["capacity"] = batch;
    session_.numbers["slots"] = tables_->rows().slots;
    session_.numbers["gather_rows"] = tables_->rows().slots;
    session_.numbers["pair_rows"] = PhotonPairs::pair_rows(batch);
    set_divisor(session_, "strip", "strip_pixels", strip_rows_ * width);
    session_.numbers["strip_first"] = 0;
    session_.numbers["chain_bin"] = chain_bin;
    session_.numbers["light_bin"] = light_bin();
    session_.numbers["most_inner"] = most_inner;
    photons_.attach(*tables_);
    stages_.build(session_, *tables_);
    paths_.attach(*tables_);
    pairs_.attach(*tables_);
    bias_.attach(*tables_);
    order_.attach(*tables_);
    moved_.attach(*tables_);
    if (manifold_walk_)
        manifold_walk_->attach(*tables_);
    film_.attach(*tables_);
}

GradientPhotonMapper::Strip GradientPhotonMapper::next_strip() const {
    const std::uint32_t width = session_.width();
    Strip strip;
    strip.first = static_cast<std::uint32_t>(done_ % session_.pixels() / width);
    strip.rows = std::min(strip_rows_, session_.height() - strip.first);
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
    const AddedSeconds render_seconds(statistics_.render_seconds);
    film_.begin();
    const Strip strip = next_strip();
    const std::uint64_t pass = done_ / session_.pixels();
    begin_strip(strip);
    const double radii_before = pairs_.radius_sum();
    const std::uint64_t points_before = statistics_.gather_points;
    if (session_.max_depth() == 0) { // no path begins
        film_.clear_slots();
    } else {
        photons_.begin(pass);
        paths_.trace(planes * strip.pixels, strip.first * session_.width(), pass, [](const Hits &) {});
        gather_photons(strip);
    }
    film_.add(strip.first, strip.rows, 1, pass);
    finish(session_.device);
    count_radii(statistics_, pass, strip.first == 0,
                {statistics_.gather_points - points_before, pairs_.radius_sum() - radii_before});
    done_ += strip.pixels;
    statistics_.samples += strip.pixels;
    return done_ < total_;
}

void GradientPhotonMapper::gather_photons(const Strip &strip) {
    bin_.run(strip.pixels);
    order_.run(strip.pixels);
    const std::uint32_t most = tables_->rows().paths;
    for (std::uint32_t kind = 0; kind < paths_.kinds(); ++kind) {
        const Range all = order_.bin(first_kind_bin + kind);
        statistics_.gather_points += all.count;
        for (std::uint32_t from = 0; from < all.count; from += most)
            statistics_.photon_pairs +=
                pairs_.find({all.first + from, std::min(most, all.count - from)}, [&](const PairWindow &window) {
                    session_.ask_to_go_on();
                    evaluate_.run_kind(kind, window.pairs);
                    shift_photons(kind, window);
                    pairs_.sum(window);
                    bias_.sum(window);
                    PhotonPairs::sum(sum_, 4, window);
                });
    }
    gradient_gather_.run(strip.pixels);
    bias_.add({0, strip.pixels});
    bias_.keep(strip.pixels, strip.first * session_.width(), done_ / session_.pixels());
}

/// The differences of the pairs in a window, whose gather points are of one BSDF kind.
void GradientPhotonMapper::shift_photons(std::size_t kind, const PairWindow &window) {
    shift_.run_planes(kind, window.pairs, 4);
    moved_.run(4 * window.pairs);
    move_chains(moved_.bin(chain_bin), window.pairs);
    for (std::uint32_t last = 0; last < paths_.kinds(); ++last) {
        const Range rows = moved_.bin(first_kind_bin + last);
        reconnect_.run_kind(last, rows.count, {{"first", rows.first}, {"pairs", window.pairs}});
    }
    const Range lit = moved_.bin(light_bin());
    reconnect_light_.run(lit.count, {{"first", lit.first}, {"pairs", window.pairs}});
    const TraceCounts counts = session_.segments.trace({&(*tables_)["moved"], tables_->rows_of("moved"), moved_.count(),
                                                        moved_origin_x, moved_direction_x, moved_primitive},
                                                       {});
    session_.rays["offset"] += counts.extension;
    arrive_.run_kind(kind, moved_.count(), {{"pairs", window.pairs}});
    const Range chains = moved_.bin(chain_bin);
    const std::uint32_t others = moved_.count() - chains.count;
    count_.run(chunks_of(chains.count), {{"first", 0}, {"rows", chains.count}, {"to", 0}});
    count_.run(chunks_of(others), {{"first", chains.count}, {"rows", others}, {"to", tables_->rows().paths}});
    moved_photons_ += moved_.count();
}

/// Photons at the end of chains of specular vertices, which walk to their new ends. They are first in `moved`; once
/// walked, their rays need no tracing any more.
void GradientPhotonMapper::move_chains(Range chains, std::uint32_t pairs) {
    if (!manifold_walk_)
        return;
    const std::vector<std::string> &kinds = session_.scene.kinds;
    const std::uint32_t room = tables_->rows().paths;
    const std::uint32_t rows = manifold_walk_->chain_rows(), vertices = manifold_walk_->chain_vertices();
    for (std::uint32_t done = 0; done < chains.count; done += room) {
        const std::uint32_t count = std::min(room, chains.count - done), first = chains.first + done;
        project_.run(count, {{"first", first}, {"pairs", pairs}});
        const TraceCounts traced = session_.segments.trace(
            {&(*tables_)["moved"], tables_->rows_of("moved"), first + count, moved_origin_x, moved_direction_x,
             moved_primitive},
            {&(*tables_)["moved_link"], room, count, moved_link_origin_x, moved_link_direction_x, moved_link_open});
        session_.rays["offset"] += traced.extension + traced.shadow;
        walk_.run(count, {{"first", first}, {"pairs", pairs}, {"chain_rows", rows}, {"chain_vertices", vertices}});
        manifold_walk_->run(count);
        for (std::uint32_t kind = 0; kind < kinds.size(); ++kind)
            if (!bsdf_kind_is_dirac(kinds[kind]))
                leave_.run_kind(kind, count,
                                {{"first", first},
                                 {"pairs", pairs},
                                 {"chain_rows", rows},
                                 {"chain_vertices", vertices},
                                 {"leave_bin", first_kind_bin + kind}});
        leave_light_.run(count, {{"first", first},
                                 {"pairs", pairs},
                                 {"chain_rows", rows},
                                 {"chain_vertices", vertices},
                                 {"leave_bin", light_bin()}});
        for (std::uint32_t kind = 0; kind < kinds.size(); ++kind)
            if (pass_.is_first_of_kernel(kind))
                pass_.run_kind(
                    kind, count,
                    {{"first", first}, {"pairs", pairs}, {"chain_rows", rows}, {"chain_vertices", vertices}});
        end_.run(count, {{"first", first}, {"chain_rows", rows}, {"chain_vertices", vertices}});
    }
}

/// The bin of photons straight from a light.
std::uint32_t GradientPhotonMapper::light_bin() const {
    return first_kind_bin + std::uint32_t(session_.scene.kinds.size());
}

Image GradientPhotonMapper::make_image(bool layers, bool last) {
    statistics_.non_finite = 0;
    const std::optional<BiasEstimates> bias = bias_.estimates(done_);
    Image image = film_.image(done_, layers, last, statistics_.non_finite);
    add_pass_errors(bias, image, statistics_);
    return image;
}

Statistics GradientPhotonMapper::statistics() const {
    Statistics s = statistics_;
    s.light_paths = photons_.light_paths().light_paths();
    s.photons = photons_.light_paths().photons();
    s.radius_sum = pairs_.radius_sum();
    s = collected(s, session_, stages_, photons_.light_paths().times());
    film_.add_to(s);
    s.reconstruction.accuracy = accuracy_of_photons(options_);
    std::vector<std::uint32_t> found(2 * std::size_t(tables_->rows().paths));
    (*tables_)["photon_found"].read(found.data(), found.size() * sizeof(found[0]));
    const auto half = found.begin() + std::ptrdiff_t(found.size() / 2);
    s.shifts["walked"] = std::accumulate(found.begin(), half, std::uint64_t(0));
    s.shifts["reconnected"] = std::accumulate(half, found.end(), std::uint64_t(0));
    s.shifts["failed"] = moved_photons_ - s.shifts["walked"] - s.shifts["reconnected"];
    if (manifold_walk_)
        s.walks = manifold_walk_->counts();
    return s;
}

std::unique_ptr<Method> make_gradient_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<GradientPhotonMapper>(device, scene, options);
}

} // namespace gradus
