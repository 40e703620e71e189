#include "methods/photon_mapper.h"

#include "kernels/shared/tables.h"
#include "methods/error_layer.h"
#include "methods/path_stages.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

namespace gradus {

using namespace lib_float;

PhotonMapper::PhotonMapper(Device &device, const Scene &scene, const RenderOptions &options)
    : options_(options),
      session_(device, checked_for_gathering(scene, options), options, gather_traits(scene, options)),
      paths_(session_, stages_, scene, options, false), photons_(session_, stages_, scene, options, 2, false),
      pairs_(stages_),
      evaluate_(stages_.add({.name = "photon_evaluate", .by_kind = true, .dirac = DiracKinds::left_out})),
      add_(stages_.add({.name = "gather_add", .numbers = {"first"}})), bias_(session_, stages_, pairs_, options, false),
      film_(session_, stages_) {
    check_error(options, "sppm");
    statistics_.surfaces = gathering_surfaces(scene, options.gather_roughness);
    total_ = std::uint64_t(session_.pixels()) * session_.settings.samples_per_pixel;
    allocate();
}

void PhotonMapper::allocate() {
    TableList list = joined(joined(paths_.tables(), film_.tables()), joined(photons_.tables(), pairs_.tables()));
    list = joined(list, bias_.tables());
    const std::uint32_t batch =
        choose_batch_size(session_.device, options_.batch_size, std::max(session_.pixels(), PhotonPairs::least_batch),
                          list, options_.precision);
    camera_paths_ =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(batches_a_pass * std::uint64_t(batch), session_.pixels()));
    tables_.emplace(session_.device, list, table_rows(session_, batch, camera_paths_), options_.precision);

    session_.numbers["capacity"] = batch;
    session_.numbers["gather_rows"] = batch;
    session_.numbers["slots"] = tables_->rows().slots;
    session_.numbers["pair_rows"] = PhotonPairs::pair_rows(batch);
    photons_.attach(*tables_);
    stages_.build(session_, *tables_);
    paths_.attach(*tables_);
    pairs_.attach(*tables_);
    bias_.attach(*tables_);
    film_.attach(*tables_);
}

bool PhotonMapper::render_batch() {
    if (done_ >= total_)
        return false;
    const AddedSeconds render_seconds(statistics_.render_seconds);
    const std::uint64_t pass = done_ / session_.pixels();
    const auto first_pixel = static_cast<std::uint32_t>(done_ % session_.pixels());
    const std::uint32_t paths = std::min(camera_paths_, session_.pixels() - first_pixel);
    const double radii_before = pairs_.radius_sum();
    const std::uint64_t points_before = statistics_.gather_points;
    bias_.begin();
    if (session_.max_depth() == 0) {
        film_.clear_slots();
    } else {
        photons_.begin(pass);
        paths_.trace(paths, first_pixel, pass, [&](const Hits &hits) { gather_photons(hits); });
    }
    film_.add(paths, first_pixel, pass);
    bias_.keep(paths, first_pixel, pass);
    finish(session_.device);
    count_radii(statistics_, pass, first_pixel == 0,
                {statistics_.gather_points - points_before, pairs_.radius_sum() - radii_before});
    done_ += paths;
    statistics_.samples += paths;
    return done_ < total_;
}

void PhotonMapper::gather_photons(const Hits &hits) {
    for (std::size_t kind = 0; kind < paths_.kinds(); ++kind) {
        const Range rows = paths_.gather_points(hits, kind);
        statistics_.gather_points += rows.count;
        statistics_.photon_pairs += pairs_.find(rows, [&](const PairWindow &window) {
            session_.ask_to_go_on();
            evaluate_.run_kind(kind, window.pairs);
            pairs_.sum(window);
            bias_.sum(window);
        });
        add_.run(rows.count, {{"first", rows.first}});
        bias_.add(rows);
    }
}

Image PhotonMapper::image() {
    statistics_.non_finite = 0;
    Image image = film_.image(done_, statistics_.non_finite);
    add_pass_errors(bias_.estimates(done_), image, statistics_);
    return image;
}

Statistics PhotonMapper::statistics() const {
    Statistics s = statistics_;
    s.light_paths = photons_.light_paths().light_paths();
    s.photons = photons_.light_paths().photons();
    s.radius_sum = pairs_.radius_sum();
    s = collected(s, session_, stages_, photons_.light_paths().times());
    s.reconstruction = {"none", accuracy_of_photons(options_), ""};
    return s;
}

std::unique_ptr<Method> make_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<PhotonMapper>(device, scene, options);
}

} // namespace gradus
