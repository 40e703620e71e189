#include "methods/path_tracer.h"

#include "methods/error_layer.h"
#include "methods/path_stages.h"
#include "methods/reconstruction_inputs.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/sample_parts.h"
#include "solver/guide/guided_reconstruction.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace gradus {

PathTracer::PathTracer(Device &device, const Scene &scene, const RenderOptions &options)
    : options_(options), session_(device, scene, options,
                                  {{"KINDS_BY_CLASS", 1},
                                   {"TRAIT_AOV", options.all_traits || needs_features(options)},
                                   {"TRAIT_PART_BITS", part_bits(options, is_halved())}}),
      camera_(stages_.add(camera_stage())), far_clip_(stages_.add(far_clip_stage(session_))),
      connect_(stages_.add(connect_stage())),
      paths_(session_, stages_, {.kinds = std::uint32_t(session_.scene.kinds.size())}),
      escape_(stages_.add(escape_stage(session_))), emission_(stages_.add(emission_stage(session_))),
      shade_(stages_.add(shade_stage(false))), film_(session_, stages_, is_halved()) {
    check_guide(options);
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
    const AddedSeconds render_seconds(statistics_.render_seconds);
    const std::uint32_t paths = static_cast<std::uint32_t>(std::min<std::uint64_t>(pass_, samples_ahead()));
    const std::uint32_t first_pixel = static_cast<std::uint32_t>(done_ % session_.pixels());
    const std::uint64_t first_sample = done_ / session_.pixels();

    if (session_.max_depth() == 0)
        film_.clear_slots();
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
    film_.add(paths, first_pixel, first_sample);
    finish(session_.device);
    done_ += paths;
    statistics_.samples += paths;
    return done_ < total_;
}

Image PathTracer::image() {
    statistics_.non_finite = 0;
    statistics_.estimated_error.reset();
    is_mean_ = false;
    Image image = film_.image(done_, statistics_.non_finite);
    const bool tells_error = has_error_layer(options_, is_halved()) && has_halves();
    SquaredErrors errors;
    if (is_guided()) {
        statistics_.lost_pixels = pixels_without_a_color(image);
        statistics_.reconstruction.note = note_of_colors(image);
        guide(image, tells_error ? &errors : nullptr);
    } else if (tells_error)
        errors = errors_of_halves(half_image(0), half_image(1),
                                  double(samples_of_part(done_, session_.pixels(), 0, 2)) / double(done_));
    if (tells_error)
        statistics_.estimated_error = add_error_layer(image, errors);
    return image;
}

Image PathTracer::mean_image() {
    is_mean_ = true;
    statistics_.non_finite = 0;
    Image image = film_.image(done_, statistics_.non_finite);
    image.channels.resize(3);
    return image;
}

std::vector<float> PathTracer::half_image(int half) const {
    const std::size_t pixels = session_.image_pixels();
    std::vector<float> image(3 * pixels);
    for (int c = 0; c < 3; ++c)
        film_.half_mean(half, done_, c, image.data() + c * pixels);
    return image;
}

void PathTracer::guide(Image &image, SquaredErrors *errors) {
    const std::uint64_t pixels = session_.image_pixels();
    std::vector<Channel> layers;
    if (has_halves()) {
        Device &device = session_.device;
        // The image's alone, as `gradus solve` counts them. Of a frame that is under way those are not known where
        // pixels around the image have samples, too: it counts for nothing then.
        const std::uint64_t samples = session_.has_frame() ? done_ / session_.pixels() * pixels : done_;
        if (options_.layers)
            image.metadata["layer_samples"] = std::to_string(samples);
        HalvedImages halves;
        for (int i = 0; i < 2; ++i) {
            const std::vector<float> image_of_half = half_image(i);
            halves[i].primal = Buffer(device, "primal", image_of_half.data(), image_of_half.size() * sizeof(float));
            halves[i].samples = samples_of_part(samples, pixels, std::uint32_t(i), 2);
            for (int c = 0; options_.layers && c < 3; ++c) {
                const float *plane = image_of_half.data() + c * pixels;
                layers.push_back({fmt::format("primal_{}.{}", i == 0 ? "even" : "odd", "RGB"[c]),
                                  std::vector<float>(plane, plane + pixels)});
            }
        }
        GuideInputs inputs;
        inputs.features = uploaded_features(device, image);
        Buffer result(device, "result", halves[0].primal.bytes());
        PoissonSolver none(device, image.width, image.height); // samples alone ask for no solve
        GuidedReconstruction(device, none, options_.guide, options_.threads).solve(halves, inputs, result, errors);
        const auto mapping = result.map(Access::read);
        for (int c = 0; c < 3; ++c)
            std::copy_n(mapping.as<float>() + c * pixels, pixels, image.channels[c].values.begin());
    }
    if (!options_.aov && !options_.layers)
        image.channels.resize(3);
    image.channels.insert(image.channels.begin() + 3, std::make_move_iterator(layers.begin()),
                          std::make_move_iterator(layers.end()));
}

Statistics PathTracer::statistics() const {
    Statistics s = collected(statistics_, session_, stages_);
    if (is_guided() && has_halves() && !is_mean_)
        s.reconstruction = {reconstruction_name(Reconstruction::guided), accuracy_name(Accuracy::consistent),
                            statistics_.reconstruction.note, guide_name(options_.guide)};
    else
        s.reconstruction = {
            "none", accuracy_name(Accuracy::unbiased),
            is_guided() && !has_halves() ? "guided needs two samples of each pixel; with less it is their mean" : ""};
    return s;
}

std::unique_ptr<Method> make_path_tracer(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<PathTracer>(device, scene, options);
}

} // namespace gradus
