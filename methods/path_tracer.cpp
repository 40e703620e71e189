#include "methods/path_tracer.h"

#include "methods/path_stages.h"
#include "runtime/seconds_since.h"

#include <algorithm>
#include <chrono>

namespace gradus {

PathTracer::PathTracer(Device &device, const Scene &scene, const RenderOptions &options)
    : session_(device, scene, options, {}), camera_(stages_.add(camera_stage())),
      far_clip_(stages_.add(far_clip_stage(session_))), connect_(stages_.add(connect_stage())),
      paths_(session_, stages_, {.kinds = std::uint32_t(session_.scene.kinds.size())}),
      escape_(stages_.add(escape_stage(session_))), emission_(stages_.add(emission_stage(session_))),
      shade_(stages_.add(shade_stage(false))), film_(session_, stages_) {
    total_ = session_.pixels() * session_.settings.samples_per_pixel;
    const TableList list = joined(paths_.tables(), film_.tables());
    const std::uint32_t batch =
        choose_batch_size(device, session_.options.batch_size, total_, list, session_.options.precision);
    pass_ = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(batches_a_pass * std::uint64_t(batch), std::max<std::uint64_t>(total_, 1)));
    tables_.emplace(device, list, table_rows(session_, batch, pass_), session_.options.precision);
    session_.numbers["capacity"] = batch;
    session_.numbers["slots"] = tables_->rows().slots;
    stages_.build(session_, *tables_);
    paths_.attach(*tables_);
    film_.attach(*tables_);
}

bool PathTracer::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t paths = static_cast<std::uint32_t>(std::min<std::uint64_t>(pass_, total_ - done_));
    const std::uint32_t first_pixel = static_cast<std::uint32_t>(done_ % session_.pixels());
    const std::uint64_t first_sample = done_ / session_.pixels();

    if (session_.max_depth() == 0) { // no path begins, so none sets its slot to zero
        (*tables_)["radiance"].clear();
        if (tables_->has("feature"))
            (*tables_)["feature"].clear();
    }
    paths_.begin_pass(session_.max_depth() == 0 ? 0 : paths);
    for (;;) {
        begin_camera_paths(camera_, paths_, first_pixel, first_sample);
        if (!paths_.is_alive())
            break;
        paths_.trace();
        far_clip_.run(paths_.rays());
        connect_.run(paths_.vertices(), {{"first", 0}});
        const Hits &hits = paths_.partition();
        escape_.run(hits.escaped().count, {{"first", hits.escaped().first}});
        for (std::size_t kind = 0; kind < paths_.kinds(); ++kind)
            run_on_places(emission_, hits, hits.emitting(0, kind));
        paths_.advance();
        for (std::size_t kind = 0; kind < paths_.kinds(); ++kind)
            run_shade(shade_, hits, hits.kind(0, kind), kind);
    }
    film_.add(paths, first_pixel);
    finish(session_.device);
    done_ += paths;
    statistics_.samples += paths;
    statistics_.render_seconds += seconds_since(start);
    return done_ < total_;
}

Image PathTracer::image() {
    statistics_.non_finite = 0;
    return film_.image(done_, statistics_.non_finite);
}

Statistics PathTracer::statistics() const {
    Statistics s = collected(statistics_, session_, stages_);
    s.reconstruction = {"none", accuracy_name(Accuracy::unbiased), ""};
    return s;
}

std::unique_ptr<Method> make_path_tracer(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<PathTracer>(device, scene, options);
}

} // namespace gradus
