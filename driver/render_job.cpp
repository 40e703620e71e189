#include "driver/render_job.h"

#include "driver/error_watch.h"
#include "driver/finite_values.h"
#include "driver/interrupt.h"
#include "driver/memory_check.h"
#include "driver/options_of_method.h"
#include "driver/phase_watch.h"
#include "driver/program.h"
#include "driver/progress.h"
#include "driver/standard_streams.h"
#include "driver/statistics_json.h"
#include "runtime/error.h"
#include "runtime/io/image_io.h"
#include "runtime/io/picture_library.h"
#include "runtime/scene/own_frame.h"
#include "runtime/seconds_since.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <optional>

namespace gradus {
namespace {

using Clock = std::chrono::steady_clock;

/// The sampler's count where only the time ends a render: more than any render takes, and far from overflow.
constexpr std::uint64_t endless_samples_per_pixel = std::uint64_t(1) << 30;

/// The render while it runs: the method and what is written of it.
class RenderJob {
  public:
    RenderJob(const RenderRequest &request, const Services &services)
        : request_(request), services_(services), progress_(Progress::choose_mode(request.quiet, stderr)) {}

    int run() {
        prepare();
        watch_.emplace();
        saving([&] { render(); }, [&] { return image_or_mean(); });
        record_.interrupted = watch_->requested();
        if (record_.interrupted) {
            record_.stopped_by = "interrupt";
            if (has_nothing_to_show()) {
                print_message(fmt::format("gradus: interrupted before the first samples; nothing is written to {}\n",
                                          request_.outputs.image));
                return static_cast<int>(ExitCode::interrupted);
            }
            progress_.message("interrupted; making the image of the samples so far: a second time ends at once");
        }
        if (has_nothing_to_show())
            throw Error(ExitCode::failure,
                        fmt::format("no sample was done after {:.0f} s, so there is no image: give "
                                    "more --time, a smaller --size or --max-depth{}",
                                    seconds_since(render_start_),
                                    request_.method.options.photons > 0 ? ", or fewer --photons" : ""));
        if (!record_.interrupted && !request_.quiet)
            watch_->answer("\ngradus: all samples are done, and the image is being made: a second time loses it\n");
        Image image;
        saving(
            [&] {
                const PhaseWatch phase_watch(phases_, progress_);
                const Phase phase(&phases_, phase_names::image);
                image = described(prepared_.method->last_image(), record_.interrupted || has_holes());
            },
            [&] { return prepared_.method->mean_image(); });
        watch_->answer(nullptr);
        write_results(image);
        if (statistics_failure_)
            std::rethrow_exception(statistics_failure_);
        if (black_pixels_ > 0)
            return static_cast<int>(ExitCode::failure);
        return static_cast<int>(record_.interrupted ? ExitCode::interrupted : ExitCode::success);
    }

  private:
    void prepare() {
        const PhaseWatch phase_watch(phases_, progress_);
        // What will write it, while there is memory for it and nothing to lose.
        if (request_.outputs.png)
            picture_library();
        const auto warn = [this](const std::string &warning) { progress_.message("gradus: warning: " + warning); };
        Scene scene = load_requested_scene(for_method(request_.scene, request_.method.method), services_, warn,
                                           &files_read_, &phases_);
        check_distinct(output_list(request_.outputs), files_read_);
        check_counts(scene);
        warn_of_unread_options(request_.method.method);
        const std::uint64_t left = bytes_left(request_.method.options.threads);
        check_memory(scene, request_.method.method, request_.method.options, left);
        if (!is_limited_by_samples())
            scene.settings.samples_per_pixel =
                request_.until_error > 0 ? ErrorWatch::most_samples : endless_samples_per_pixel;
        own_scale_ = bring_to_own_frame(scene, warn);
        // A crop that is the whole is none.
        const bool is_cropped = image_size(scene.film) != std::array{scene.film.width, scene.film.height};
        crop_ = is_cropped ? fmt::format("{},{},{},{}", scene.film.crop_x, scene.film.crop_y, scene.film.crop_width,
                                         scene.film.crop_height)
                           : std::string();
        const auto [width, height] = image_size(scene.film);
        record_.width = width;
        record_.height = height;
        record_.scene = request_.scene.path;
        record_.method = request_.method.method;
        record_.precision = precision_name(request_.method.options.precision);
        record_.sampler = request_.method.options.sampler == RenderOptions::Sampler::sobol ? "sobol" : "independent";
        record_.seed = request_.method.options.seed;

        RenderOptions options = request_.method.options;
        options.on_compiled = [this](const std::string &kernel, std::size_t ready, std::size_t total, double seconds) {
            progress_.compiled(kernel, ready, total, seconds);
        };
        options.phases = &phases_;
        options.time_limit = request_.time_limit;
        options.stop = [this] { return is_to_stop(); };
        options.on_pilot = [this](std::uint64_t samples) {
            progress_.message(fmt::format("pilot of {} samples a pixel, to choose the method", samples));
        };
        const auto start = Clock::now();
        prepared_ = services_.prepare(request_.method.method, request_.method.device, scene, options);
        record_.prepare_seconds = seconds_since(start);
        record_.device = prepared_.description;
        if (!prepared_.warning.empty())
            warn(prepared_.warning);
        for (const Phases::Time &time : phases_.times())
            record_.phase_seconds.emplace_back(time.name.key, time.seconds);
        statistics_ = prepared_.method->statistics();
        if (const std::optional<MethodChoice> choice = statistics_.choice) {
            record_.method = choice->method;
            pilot_seconds_ = choice->pilot_seconds;
            progress_.message(fmt::format("method {}: {}", choice->method, choice->reason));
            warn_of_unread_options(choice->method);
            check_memory_of_choice(scene, choice->method, request_.method.options, left);
        }
        std::string aim = is_limited_by_samples() ? fmt::format("{} samples a pixel", scene.settings.samples_per_pixel)
                          : request_.time_limit > 0 ? fmt::format("{} s", request_.time_limit)
                                                    : "";
        if (request_.until_error > 0)
            aim += fmt::format("{}until the estimated relMSE is {}", aim.empty() ? "" : " or ", request_.until_error);
        progress_.message(fmt::format("rendering {} at {}x{}, {}, on {}", request_.scene.path, width, height, aim,
                                      record_.device.name));
    }

    /// Whether the number of samples is an aim: not the file's where time or error is one.
    bool is_limited_by_samples() const {
        return (request_.time_limit <= 0 && request_.until_error <= 0) || request_.scene.samples_per_pixel;
    }

    void warn_of_unread_options(const std::string &method) {
        for (const std::string &sentence : unread_options(request_.method, method))
            progress_.message("gradus: warning: " + sentence);
    }

    /// Samples are counted in 64 bits, with room for sums and for what methods add to each.
    static void check_counts(const Scene &scene) {
        constexpr std::uint64_t most = std::uint64_t(1) << 56;
        const auto [width, height] = image_size(scene.film);
        const std::uint64_t pixels = std::uint64_t(width) * height;
        if (pixels > 0 && scene.settings.samples_per_pixel > most / pixels)
            throw Error(ExitCode::usage, fmt::format("{} samples for each of {} pixels are more than 2^56: give a "
                                                     "smaller --spp or --size",
                                                     scene.settings.samples_per_pixel, pixels));
    }

    ProgressState state() const {
        ProgressState state;
        state.done = prepared_.method->done_samples();
        state.total = prepared_.method->total_samples();
        state.elapsed = seconds_since(render_start_);
        state.time_limit = request_.time_limit;
        state.sample_limit = is_limited_by_samples();
        if (error_watch_) {
            state.error_limit = error_watch_->aim();
            state.error = error_watch_->estimate();
            state.samples_of_error = error_watch_->samples() * prepared_.method->frame_samples();
        }
        return state;
    }

    /// Whether there is not one sample, though there should be.
    bool has_nothing_to_show() const {
        return prepared_.method->done_samples() == 0 && prepared_.method->total_samples() > 0;
    }

    /// Whether there are pixels without a sample.
    bool has_holes() const {
        return prepared_.method->done_samples() <
               std::min(prepared_.method->frame_samples(), prepared_.method->total_samples());
    }

    bool is_done() const { return prepared_.method->done_samples() >= prepared_.method->total_samples(); }

    /// Whether the time is over. An image with holes, or none, is of no use, so a sample of each pixel is waited for,
    /// but not for ever.
    bool is_over(double patience) const {
        constexpr double times_longer = 10, least_wait = 5;
        const double limit =
            has_holes() ? std::max(times_longer * request_.time_limit, least_wait) : request_.time_limit + patience;
        return request_.time_limit > 0 && seconds_since(render_start_) >= limit;
    }

    /// Whether a batch that is under way is to be given up: at once when interrupted, but for a time limit only after a
    /// second more, so that batches of usual length are not lost.
    bool is_to_stop() const {
        constexpr double patience = 1;
        return watch_ && (watch_->requested() || is_over(patience));
    }

    /// The next batch; false after the last, or where it was given up.
    bool render_batch() {
        // One sample a pixel, then more with what is done: a pass of the device's own size may take longer than there
        // is time, or patience, and would be lost. Until a time as many as are done; else thrice, which costs a long
        // render next to nothing.
        constexpr std::uint64_t long_render = 1u << 20;
        if (request_.time_limit > 0 || prepared_.method->total_samples() > long_render) {
            const std::uint64_t done = prepared_.method->done_samples();
            const std::uint64_t next =
                done + std::max(request_.time_limit > 0 ? done : 3 * done, prepared_.method->frame_samples());
            prepared_.method->pause_at(error_watch_ ? std::min(next, error_watch_->next_look()) : next);
        }
        try {
            return prepared_.method->render_batch();
        } catch (const Stopped &) {
            return false;
        }
    }

    void render() {
        // The pilot counts as rendering: a time limit includes it.
        render_start_ =
            Clock::now() - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pilot_seconds_));
        auto last_partial = Clock::now();
        progress_.update(state());
        if (request_.until_error > 0)
            error_watch_.emplace(*prepared_.method, request_.until_error);
        bool more = true;
        while (more) {
            more = render_batch();
            if (watch_->requested())
                break;
            if (error_watch_ && error_watch_->is_reached())
                record_.stopped_by = "error";
            const ProgressState now = state();
            progress_.update(now);
            if (record_.stopped_by == "error")
                break;
            if (!is_done() && is_over(0)) {
                record_.stopped_by = "time";
                break;
            }
            if (more && request_.partial_interval > 0 && seconds_since(last_partial) >= request_.partial_interval) {
                write_partial();
                last_partial = Clock::now();
            }
        }
        if (record_.stopped_by == "time" && has_holes() && !has_nothing_to_show())
            progress_.message(
                "gradus: warning: the time was over before each pixel had a sample: the others are black");
        progress_.finish(state());
    }

    /// A partial image that cannot be written is no reason to lose the render: the disk may have room again at the end.
    void write_partial() {
        try {
            write_image(described(prepared_.method->image(), true), request_.outputs.image);
        } catch (const std::bad_alloc &) {
            progress_.message("gradus: warning: out of memory for an image so far; the render goes on");
        } catch (const std::exception &error) {
            progress_.message(fmt::format("gradus: warning: {}; the render goes on", error.what()));
        }
    }

    /// Does `work`. Where that throws, hours of samples may be there: they are saved, as the image that is `left`.
    void saving(const std::function<void()> &work, const std::function<Image()> &left) {
        try {
            work();
        } catch (...) {
            save(left);
            throw;
        }
    }

    /// What cannot be written is told beside the error itself.
    void save(const std::function<Image()> &left) {
        if (prepared_.method->done_samples() == 0)
            return;
        try {
            write_image(described(left(), true), request_.outputs.image);
            progress_.message(fmt::format("gradus: warning: the render failed; wrote {} of what was rendered: {:.6g} "
                                          "samples a pixel",
                                          request_.outputs.image, record_.samples_per_pixel));
        } catch (const std::exception &error) {
            progress_.message(fmt::format("gradus: warning: what was rendered cannot be written: {}", error.what()));
        }
    }

    Image image_or_mean() {
        try {
            return prepared_.method->last_image();
        } catch (const std::exception &) {
            return prepared_.method->mean_image();
        }
    }

    /// For these the method asks the device. Where that fails the image is there all the same, and goes with what was
    /// told before.
    void take_statistics() {
        try {
            statistics_ = prepared_.method->statistics();
            statistics_failure_ = nullptr;
        } catch (const std::exception &error) {
            statistics_failure_ = std::current_exception();
            progress_.message(
                fmt::format("gradus: warning: the image is written without its statistics: {}", error.what()));
        }
    }

    /// Radii are the only lengths there.
    Statistics in_units_of_the_scene(Statistics statistics) const {
        for (double *sum : {&statistics.radius_sum, &statistics.first_radii.sum, &statistics.last_radii.sum})
            *sum /= own_scale_;
        return statistics;
    }

    /// An image as it is to be written: in the scene's own units, without what is no number, and with what made it.
    Image described(Image image, bool partial) {
        take_statistics();
        for (Channel &channel : image.channels)
            if (own_scale_ != 1 && channel.name == "depth.Z")
                for (float &value : channel.values)
                    value = float(value / own_scale_);
        black_pixels_ = std::max(settle_values(image).pixels, statistics_.lost_pixels);
        const std::uint64_t done = prepared_.method->done_samples();
        record_.samples_per_pixel = double(done) / double(prepared_.method->frame_samples());
        image.metadata["version"] = version();
        image.metadata["scene"] = record_.scene;
        image.metadata["method"] = record_.method;
        image.metadata["precision"] = record_.precision;
        image.metadata["sampler"] = record_.sampler;
        image.metadata["seed"] = std::to_string(record_.seed);
        const ReconstructionUsed &used = statistics_.reconstruction;
        image.metadata["reconstruction"] = used.name;
        if (!used.guide.empty())
            image.metadata["guide"] = used.guide;
        if (used.alpha)
            image.metadata["alpha"] = fmt::format("{}", *used.alpha);
        image.metadata["accuracy"] = used.accuracy;
        image.metadata["samples"] = std::to_string(done);
        image.metadata["spp"] = fmt::format("{}", record_.samples_per_pixel);
        image.metadata["device"] = record_.device.name;
        image.metadata["seconds"] = fmt::format("{:.3f}", seconds_since(render_start_));
        if (const std::optional<double> error = statistics_.estimated_error)
            image.metadata["estimated_error"] = fmt::format("{:.6g}", *error);
        image.metadata["partial"] = partial ? "true" : "false";
        if (!crop_.empty())
            image.metadata["crop"] = crop_;
        return image;
    }

    void write_results(const Image &image) {
        const Statistics statistics = in_units_of_the_scene(statistics_);
        OutputFiles files = request_.outputs;
        if (statistics_failure_)
            files.statistics.clear();
        write_outputs(files, image, image, [&] {
            record_.wall_seconds = seconds_since(job_start_);
            return statistics_to_json(record_, statistics);
        });
        if (statistics.non_finite > 0)
            progress_.message(fmt::format("gradus: warning: {} samples were NaN or infinite and were left out",
                                          statistics.non_finite));
        if (!statistics.reconstruction.note.empty())
            progress_.message("gradus: warning: " + statistics.reconstruction.note);
        if (services_.programs_not_kept() > 0)
            progress_.message(fmt::format("gradus: warning: not all kernels could be kept in '{}', so the next render "
                                          "compiles them again: is the disk full?",
                                          services_.cache_folder().string()));
        if (black_pixels_ > 0)
            print_message(fmt::format("gradus: error: {} pixels have a value that is NaN or infinite, which the image "
                                      "holds as 0, or as their neighbours have it: the scene's numbers are too large "
                                      "or too small\n",
                                      black_pixels_));
        const std::optional<double> error = statistics.estimated_error;
        progress_.message(fmt::format(
            "{}wrote {}: {:.6g} samples a pixel{}", record_.interrupted ? "interrupted; " : "", request_.outputs.image,
            record_.samples_per_pixel, error ? fmt::format(", estimated relMSE {:.3g}", *error) : ""));
        if (request_.until_error > 0 && record_.stopped_by == "samples" && !(error && *error <= request_.until_error))
            progress_.message("gradus: warning: the samples were at their end before the error was small enough");
    }

    const RenderRequest &request_;
    const Services &services_;
    const Clock::time_point job_start_ = Clock::now();
    Clock::time_point render_start_ = job_start_;
    Progress progress_;
    Phases phases_;                       ///< until the first sample
    std::optional<InterruptWatch> watch_; ///< once there is something to lose
    PreparedMethod prepared_;
    RenderRecord record_;
    std::optional<ErrorWatch> error_watch_;
    std::string crop_;
    std::vector<std::string> files_read_;
    std::uint64_t black_pixels_ = 0;        ///< of the last image
    Statistics statistics_;                 ///< the last that the method told
    std::exception_ptr statistics_failure_; ///< why they are not of the last image
    double pilot_seconds_ = 0;              ///< of the method auto
    double own_scale_ = 1;                  ///< of the scene's lengths, while it renders
};

} // namespace

int run_render(const RenderRequest &request, const Services &services) {
    check_outputs(request.outputs);
    check_method_options(request.method);
    if (!request.method.options.dump_kernels.empty())
        check_folder(request.method.options.dump_kernels);
    return RenderJob(request, services).run();
}

} // namespace gradus
