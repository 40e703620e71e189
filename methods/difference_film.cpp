#include "methods/difference_film.h"

#include "kernels/shared/tables.h"
#include "methods/error_layer.h"
#include "methods/gradient_image.h"
#include "methods/path_stages.h"
#include "methods/reconstruction_inputs.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/sample_parts.h"
#include "solver/squared_errors.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {

/// R, G and B of an image that may have more.
Image mean_of(const Image &image) {
    return {image.width, image.height, {image.channels.begin(), image.channels.begin() + 3}, {}};
}

std::vector<std::string> numbers_of_launch_of_differences(const Session &session) {
    if (session.has_frame())
        return {"first_pixel", "frames_before", "filter_x", "filter_y"};
    return {"first_slot", "first_pixel", "first_above", "is_carried", "has_above", "frames", "frames_before"};
}

std::vector<std::string> film_names(std::uint32_t parts) {
    std::vector<std::string> names;
    for (std::uint32_t part = 0; part < parts; ++part)
        names.push_back(name_of_part("gradient_film", part));
    return names;
}

} // namespace

DifferenceFilm::DifferenceFilm(Session &session, Stages &stages, const RenderOptions &options, const char *counts,
                               bool may_tell_error)
    : session_(session), options_(options), counts_(counts),
      tells_error_(may_tell_error && has_error_layer(options, keeps_halves(options))),
      film_names_(film_names(1u << session.traits.at("TRAIT_PART_BITS"))),
      combine_(stages.add({.name = "gradient_combine", .strict = true})), film_(session, stages, tells_error_),
      frame_(stages.add({.name = "gradient_frame",
                         .is_wanted = session.has_frame(),
                         .strict = true,
                         .numbers = {"first_slot", "first_pixel", "has_above"}})),
      accumulate_(stages.add(
          {.name = "gradient_accumulate", .strict = true, .numbers = numbers_of_launch_of_differences(session)})),
      carry_(stages.add({.name = "gradient_carry", .numbers = {"first_slot"}})) {
    check_guide(options);
    if (options.threads != 1)
        compilers_ = keep_compilers(session.device);
}

DifferenceFilm::~DifferenceFilm() { is_going_ = true; }

TableList DifferenceFilm::tables() const {
    TableList list = joined(film_.tables(),
                            {{.name = "direct", .rows = RowsOf::slot, .columns = radiance_columns},
                             {.name = "prefix", .rows = RowsOf::slot, .columns = prefix_columns},
                             {.name = "difference", .rows = RowsOf::slot, .multiple = 4, .columns = difference_columns},
                             {.name = "carry", .rows = RowsOf::image_row, .columns = carry_columns},
                             {.name = "gradient_frame",
                              .rows = RowsOf::pixel,
                              .columns = session_.has_frame() ? std::uint32_t(gradient_frame_columns) : 0u}});
    for (const std::string &name : film_names_)
        list.push_back({.name = name, .rows = RowsOf::pixel, .columns = gradient_film_columns, .is_cleared = true});
    return list;
}

void DifferenceFilm::attach(Tables &tables) {
    tables_ = &tables;
    film_.attach(tables);
}

void DifferenceFilm::begin() {
    if (!solver_ && !solver_compiled_.valid()) // with one thread, once it is needed
        solver_compiled_ =
            std::async(options_.threads == 1 ? std::launch::deferred : std::launch::async,
                       [this, compilers = std::exchange(compilers_, nullptr)]() mutable {
                           compile_reconstruction(session_.device, options_, session_.settings.samples_per_pixel,
                                                  [this](const std::string &, std::size_t, std::size_t, double) {
                                                      if (is_going_)
                                                          throw Stopped();
                                                  });
                           compilers.reset();
                       });
}

const std::vector<DirectPixel> &DifferenceFilm::edges(std::uint64_t samples, bool last) {
    constexpr std::uint64_t most = 0xFFFFFFFFu; // far more than have an effect
    const auto all = std::uint32_t(std::min((samples + session_.pixels() - 1) / session_.pixels(), most));
    const bool is_whole = last || all == session_.settings.samples_per_pixel;
    const std::uint32_t a_pixel = is_whole ? all : std::bit_floor(all);
    if (a_pixel != edge_samples_ && session_.max_depth() != 0 && !session_.settings.hide_emitters) {
        const auto start = std::chrono::steady_clock::now();
        edges_ =
            sample_direct_edges(session_.scene, session_.film, session_.tracer, options_.seed, a_pixel, edge_rays_);
        edge_samples_ = a_pixel;
        edge_seconds_ += seconds_since(start);
    }
    return edges_;
}

std::vector<float> DifferenceFilm::direct_variance(std::uint64_t samples, const std::vector<DirectPixel> &edges) const {
    const GradientFilms films = this->films(samples);
    const std::size_t pixels = session_.image_pixels();
    std::vector<float> direct[2], primal(pixels);
    for (int half = 0; half < 2; ++half) {
        direct[half].resize(3 * pixels);
        const GradientFilms of_half = films.half(half);
        const PlaneSource mean = of_half.mean(GradientFilm::primal);
        for (std::uint32_t c = 0; c < 3; ++c) {
            float *plane = &direct[half][c * pixels];
            film_.half_mean(half, samples, int(c), plane);
            mean(c, primal.data());
            for (std::size_t i = 0; i < pixels; ++i)
                plane[i] -= primal[i];
        }
    }
    const double share = double(films.half(0).samples()) / double(films.samples());
    std::vector<float> variance = errors_of_halves(direct[0], direct[1], share).variance;
    for (const DirectPixel &edge : edges)
        for (std::size_t c = 0; c < 3; ++c)
            variance[c * pixels + edge.pixel] = edge.variance[c];
    return variance;
}

void DifferenceFilm::clear_slots() {
    film_.clear_slots();
    for (const char *table : {"direct", "prefix", "difference"})
        if (tables_->has(table))
            (*tables_)[table].clear();
}

void DifferenceFilm::add(std::uint32_t first, std::uint32_t rows, std::uint32_t frames, std::uint64_t number) {
    const std::uint32_t width = session_.width(), pixels = rows * width;
    combine_.run(frames * pixels);
    film_.add(frames * pixels, first * width, number);
    if (session_.has_frame())
        for (std::uint32_t frame = 0; frame < frames; ++frame)
            add_filtered(first, rows, frame * pixels, number + frame);
    else
        add_slots(first, rows, frames, number);
    if (first + rows < session_.height())
        carry_.run(width, {{"first_slot", pixels - width}});
}

void DifferenceFilm::add_slots(std::uint32_t first, std::uint32_t rows, std::uint32_t frames, std::uint64_t number) {
    const std::uint32_t width = session_.width(), pixels = rows * width;
    const auto apart = std::uint32_t(film_names_.size()); // frames of a film
    for (std::uint32_t film = 0; film < apart; ++film) {
        // Of a part the first frame of its own, and from there on each that is as many further as there are parts.
        const auto first_frame = std::uint32_t((film + apart - number % apart) % apart);
        if (apart > 1)
            accumulate_.bind("gradient_film", (*tables_)[film_names_[film]]);
        for (std::uint32_t frame = first_frame; frame < frames; frame += apart * accumulated_frames) {
            const std::uint32_t together = std::min(accumulated_frames, (frames - frame + apart - 1) / apart);
            const std::uint64_t before = number + frame - first_sample_; // of all films
            accumulate_.run(width, {{"first_slot", frame * pixels},
                                    {"first_pixel", first * width},
                                    {"first_above", ((first > 0 ? first : session_.height()) - 1) * width},
                                    {"is_carried", 1},
                                    {"has_above", first > 0},
                                    {"frames", together},
                                    {"frames_before", static_cast<std::uint32_t>(before / apart)}});
            accumulate_.run(pixels - width, {{"first_slot", frame * pixels + width},
                                             {"first_pixel", (first + 1) * width},
                                             {"first_above", first * width},
                                             {"is_carried", 0},
                                             {"has_above", 1},
                                             {"frames", together},
                                             {"frames_before", static_cast<std::uint32_t>(before / apart)}});
        }
    }
}

/// Of one frame, from `first_slot` on.
void DifferenceFilm::add_filtered(std::uint32_t first, std::uint32_t rows, std::uint32_t first_slot,
                                  std::uint64_t number) {
    const std::uint32_t width = session_.width();
    const Range samples{first * width, rows * width};
    frame_.run(samples.count, {{"first_slot", first_slot}, {"first_pixel", samples.first}, {"has_above", first > 0}});
    const auto apart = std::uint32_t(film_names_.size());
    if (apart > 1)
        accumulate_.bind("gradient_film", (*tables_)[film_names_[number % apart]]);
    const Range filtered = filtered_pixels(session_, samples);
    const FramePlace place = film_.place_of(number);
    accumulate_.run(filtered.count, {{"first_pixel", filtered.first},
                                     {"frames_before", static_cast<std::uint32_t>((number - first_sample_) / apart)},
                                     {"filter_x", place.x},
                                     {"filter_y", place.y}});
}

Image DifferenceFilm::image(std::uint64_t samples, bool layers, bool last, std::uint64_t &non_finite) {
    const auto keep_films_and = [&](std::vector<std::string> kept) {
        kept.insert(kept.end(), film_names_.begin(), film_names_.end());
        kept.push_back(counts_);
        tables_->release_all_but(kept);
    };
    if (last) // what a pass needs and the films do not
        keep_films_and(film_.table_names());
    Image whole = film_.image(samples, non_finite);
    lost_pixels_ = pixels_without_a_color(whole);
    const std::vector<DirectPixel> &of_edges = edges(samples, last);
    relative_error_.reset();
    ErrorOfImage error;
    if (tells_error_)
        error.direct_variance = direct_variance(samples, of_edges);
    if (last) {
        mean_ = mean_of(whole);
        keep_films_and({});
    }
    if (solver_compiled_.valid())
        solver_compiled_.get();
    if (!solver_)
        solver_ =
            std::make_unique<PoissonSolver>(session_.device, session_.film.crop_width, session_.film.crop_height, 3);
    Image image = reconstruct(
        session_.device, *solver_, std::move(whole), films(samples), of_edges, options_, layers,
        [&] {
            if (last)
                tables_->release_all_but({counts_});
        },
        used_, tells_error_ ? &error : nullptr);
    relative_error_ = error.relative;
    if (last) {
        solver_.reset();
        mean_.reset();
    }
    return image;
}

GradientFilms DifferenceFilm::films(std::uint64_t samples) const {
    GradientFilms films(session_.tracer, keeps_halves(options_), has_replicates(session_.options));
    const auto parts = std::uint32_t(film_names_.size());
    for (std::uint32_t part = 0; part < parts; ++part)
        films.add((*tables_)[film_names_[part]], session_.area(), options_.precision,
                  samples_of_part(session_.filtered_samples(samples), session_.pixels(), part, parts));
    return films;
}

Image DifferenceFilm::mean(std::uint64_t samples) const {
    std::uint64_t non_finite = 0;
    return mean_ ? *mean_ : mean_of(film_.image(samples, non_finite));
}

void DifferenceFilm::add_to(Statistics &statistics) const {
    statistics.reconstruction =
        mean_ ? ReconstructionUsed{"none", accuracy_name(Accuracy::unbiased), "the reconstruction failed"} : used_;
    statistics.estimated_error = relative_error_;
    statistics.lost_pixels = lost_pixels_;
    statistics.rays["edge"] = edge_rays_;
    statistics.render_seconds += edge_seconds_;
    statistics.stages.push_back({"edges of lights", edge_seconds_, 0, 0});
}

void DifferenceFilm::clear(std::uint64_t first_sample) {
    edge_rays_ = 0;
    edge_seconds_ = 0;
    first_sample_ = first_sample;
    film_.clear(first_sample);
    for (const std::string &name : film_names_)
        (*tables_)[name].clear();
}

} // namespace gradus
