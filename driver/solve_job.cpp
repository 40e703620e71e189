#include "driver/solve_job.h"

#include "driver/finite_values.h"
#include "driver/number_checks.h"
#include "driver/program.h"
#include "driver/reconstruction_options.h"
#include "driver/solve_report.h"
#include "driver/standard_streams.h"
#include "runtime/error.h"
#include "runtime/io/image_io.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/sample_parts.h"
#include "solver/brightness.h"
#include "solver/halves.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <optional>

namespace gradus {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void refuse(const std::string &message) { throw Error(ExitCode::usage, message); }

/// An output in the place of an input would destroy what a render may have taken hours for.
void check_inputs_are_kept(const SolveRequest &request) {
    std::vector<std::string> inputs{request.sources.layered};
    for (const auto &[layer, path] : request.sources.files)
        inputs.push_back(path);
    check_distinct(output_list(request.outputs), inputs);
}

void check_options(const SolveRequest &request) {
    if (request.options.weigh_by_variance && request.options.norm == PoissonNorm::l1)
        refuse("--weights variance is for l2: add --reconstruction l2");
    const bool is_l1 = request.reconstruction == Reconstruction::l1,
               is_l2 = request.reconstruction == Reconstruction::l2;
    if (is_l2 && !request.options.joint_channels && !request.options.weigh_by_variance)
        refuse("--per-channel changes nothing with l2 but where --weights variance gives weights");
    if (!is_l1 && !request.options.keep_mean)
        refuse("--no-mean-correction is for l1, the only one that has that correction");
    check_alpha(request.reconstruction, request.alpha_is_given, request.options.alpha);
    if (needs_halves(request.reconstruction) && !(request.options == PoissonOptions{.norm = PoissonNorm::l2}))
        refuse(fmt::format("--reconstruction {} chooses weights and method by itself: leave --weights, --method, "
                           "--tolerance, --iterations and --per-channel out",
                           reconstruction_name(request.reconstruction)));
    if (request.guide && request.reconstruction != Reconstruction::guided)
        refuse("--guide is of one reconstruction: add --reconstruction guided");
    if (request.damping && request.options.method != LinearMethod::jacobi)
        refuse("--damping is for one method: add --method jacobi");
}

class SolveJob {
  public:
    SolveJob(SolveRequest request, const Services &services) : request_(std::move(request)), services_(services) {
        PoissonOptions &options = request_.options;
        options.damping = request_.damping.value_or(options.damping);
        request_.sources.variances = options.alpha_from_variances || options.weigh_by_variance;
        request_.sources.halves = needs_halves(request_.reconstruction);
        request_.sources.features = request_.reconstruction == Reconstruction::guided;
    }

    /// Whether all values of the image are finite.
    bool run() {
        warn_of_what_is_not_read();
        images_ = read_gradient_images(request_.sources);
        warn_of_other_reconstruction();
        warn_of_brightness();
        take_out_pixels_without_samples();
        if (request_.sources.variances)
            check_variances();
        if (request_.sources.features && images_.channels.size() != 3)
            throw Error(ExitCode::image, "--reconstruction guided is for images of R, G and B");
        solve();
        return write_results();
    }

  private:
    void warn(const std::string &text) const {
        if (!request_.quiet)
            print_message("gradus: warning: " + text + "\n");
    }

    /// A render's layers without a word on how to solve them give another image than the render's.
    void warn_of_other_reconstruction() const {
        const auto made = images_.metadata.find("reconstruction");
        if (made == images_.metadata.end())
            return;
        std::string own = "--reconstruction " + made->second, ours = reconstruction_name(request_.reconstruction);
        const bool is_other = made->second != ours;
        // The render's alpha is from variances as a rule, a solve's is not.
        const auto text = images_.metadata.find("alpha");
        const auto alpha = text != images_.metadata.end() ? finite_number(text->second) : std::nullopt;
        const bool alpha_is_other = alpha && !request_.options.alpha_from_variances && *alpha != request_.options.alpha;
        if (is_other ? request_.reconstruction_is_given : request_.alpha_is_given || !alpha_is_other)
            return;
        if (alpha_is_other) {
            own += " --alpha " + text->second;
            if (!needs_halves(request_.reconstruction))
                ours += fmt::format(" with --alpha {}", request_.options.alpha);
        }
        warn(fmt::format("the render that wrote these layers has {0}, and this image is {1}: {0} makes its own", own,
                         ours));
    }

    void warn_of_what_is_not_read() const {
        const auto reason = [&](GradientLayer layer) {
            return is_variance(layer) ? std::string("only --alpha auto and --weights variance use variances")
                                      : fmt::format("--reconstruction {} has no use for {}",
                                                    reconstruction_name(request_.reconstruction), layer_name(layer));
        };
        for (const auto &[layer, path] : request_.sources.files)
            if (!is_asked_for(layer, request_.sources))
                warn(fmt::format("'{}' is not read: {}", path, reason(layer)));
        for (const auto &[layer, name] : request_.sources.names)
            if (!is_asked_for(layer, request_.sources))
                warn(fmt::format("--layer {}={} is not read: {}", layer_name(layer), name, reason(layer)));
    }

    /// What is NaN, infinite or below 0 is no variance: its equation would be left out.
    void check_variances() const {
        std::size_t values = 0, missing = 0, above_zero = 0;
        for (const GradientLayer layer :
             {GradientLayer::primal_variance, GradientLayer::dx_variance, GradientLayer::dy_variance}) {
            const float *row = images_.find(layer);
            // Beyond the last column and row are no differences.
            const std::size_t columns = images_.width - (layer == GradientLayer::dx_variance ? 1 : 0);
            const std::size_t rows = images_.height - (layer == GradientLayer::dy_variance ? 1 : 0);
            values += columns * rows * images_.channels.size();
            for (std::size_t c = 0; c < images_.channels.size(); ++c)
                for (std::size_t y = 0; y < images_.height; ++y, row += images_.width)
                    for (std::size_t x = 0; x < columns && y < rows; ++x) {
                        missing += std::isfinite(row[x]) && row[x] >= 0 ? 0 : 1;
                        above_zero += std::isfinite(row[x]) && row[x] > 0 ? 1 : 0;
                    }
        }
        if (missing == values)
            throw Error(ExitCode::image, "no variance is a number of at least 0");
        if (missing > 0)
            warn(fmt::format("{} of {} variances are NaN, infinite or below 0, which says nothing", missing, values));
        if (request_.options.alpha_from_variances && above_zero == 0)
            warn(fmt::format("all variances are 0, as of one sample a pixel: they tell no alpha, so it is {}",
                             request_.options.alpha));
    }

    /// Of the layers, where the render says it: without those around the image, which a filter reaches.
    std::optional<std::uint64_t> stated_samples() const {
        for (const char *key : {"layer_samples", "samples"})
            if (const auto text = images_.metadata.find(key); text != images_.metadata.end())
                return std::strtoull(text->second.c_str(), nullptr, 10);
        return {};
    }

    /// Of a render that was stopped during its first frame the first so many; the layers hold the others as black.
    std::size_t pixels_with_samples() const {
        const std::size_t pixels = std::size_t(images_.width) * images_.height;
        const auto partial = images_.metadata.find("partial");
        const bool is_partial = partial != images_.metadata.end() && partial->second == "true";
        return is_partial ? std::size_t(std::min<std::uint64_t>(stated_samples().value_or(pixels), pixels)) : pixels;
    }

    /// As the render takes them: for missing.
    void take_out_pixels_without_samples() {
        const std::size_t pixels = std::size_t(images_.width) * images_.height, known = pixels_with_samples();
        if (known == pixels)
            return;
        warn("the render that wrote these layers was stopped before each pixel had a sample: the others are black");
        for (const GradientLayer layer : {GradientLayer::primal, GradientLayer::dx, GradientLayer::dy}) {
            const auto plane = images_.planes.find(layer);
            if (plane == images_.planes.end()) // halves, of which so few samples are refused
                continue;
            // A difference to the pixel below is of both.
            const std::size_t first =
                layer == GradientLayer::dy ? known - std::min<std::size_t>(known, images_.width) : known;
            for (std::size_t c = 0; c < images_.channels.size(); ++c)
                std::fill_n(plane->second.begin() + std::ptrdiff_t(c * pixels + first), pixels - first,
                            std::numeric_limits<float>::quiet_NaN());
        }
    }

    void warn_of_brightness() const {
        const std::size_t values = std::size_t(images_.width) * images_.height * images_.channels.size();
        std::string note;
        for (const GradientLayer layer : {GradientLayer::primal, GradientLayer::primal_even, GradientLayer::primal_odd})
            if (const float *plane = images_.find(layer); plane && note.empty())
                note = note_of_brightness({{plane, values}});
        if (!note.empty())
            warn(note);
    }

    void solve() {
        const auto channels = static_cast<std::uint32_t>(images_.channels.size());
        const auto start = Clock::now();
        const PreparedSolver solver =
            services_.prepare_solver(request_.device, request_.threads, images_.width, images_.height, channels);
        record_.prepare_seconds = seconds_since(start);
        record_.norm = request_.options.norm == PoissonNorm::l1 ? "L1" : "L2";
        record_.reconstruction = reconstruction_name(request_.reconstruction);
        record_.weights = request_.options.weigh_by_variance || request_.sources.halves ? "variance" : "uniform";
        record_.width = images_.width;
        record_.height = images_.height;
        record_.channels = channels;
        record_.device = solver.description;

        HostImages planes;
        planes.primal = images_.find(GradientLayer::primal);
        planes.dx = images_.find(GradientLayer::dx);
        planes.dy = images_.find(GradientLayer::dy);
        planes.direct = images_.find(GradientLayer::direct);
        planes.primal_variance = images_.find(GradientLayer::primal_variance);
        planes.dx_variance = images_.find(GradientLayer::dx_variance);
        planes.dy_variance = images_.find(GradientLayer::dy_variance);
        result_.resize(std::size_t(images_.width) * images_.height * channels);
        for (int i = 0; i < request_.repeats; ++i)
            report_ = solved(solver, planes);
        if (const float *direct = planes.direct; direct && request_.sources.halves)
            for (std::size_t i = 0; i < result_.size(); ++i)
                result_[i] += direct[i];
        // What the solver tells of pixels without samples comes from those beside them.
        const std::size_t pixels = std::size_t(images_.width) * images_.height, known = pixels_with_samples();
        for (std::size_t c = 0; c < channels; ++c)
            std::fill_n(result_.begin() + std::ptrdiff_t(c * pixels + known), pixels - known, 0.0f);
        images_.planes.clear();
    }

    PoissonReport solved(const PreparedSolver &solver, const HostImages &planes) {
        if (request_.reconstruction == Reconstruction::weighted)
            return solver.solve_weighted(halves(), result_.data());
        if (request_.reconstruction != Reconstruction::guided)
            return solver.solve(planes, request_.options, result_.data());
        HostGuideInputs inputs;
        inputs.albedo = images_.find(GradientLayer::albedo);
        inputs.normal = images_.find(GradientLayer::normal);
        inputs.depth = images_.find(GradientLayer::depth);
        inputs.direct = planes.direct;
        return solver.solve_guided(halves(), inputs, request_.guide.value_or(Guide::filter), result_.data());
    }

    HostHalves halves() const {
        HostHalves halves;
        for (int i = 0; i < 2; ++i) {
            const auto [primal, dx, dy, primal_variance, dx_variance, dy_variance] = half_layers[i];
            HostImages &images = halves.images[i];
            images.primal = images_.find(primal);
            images.dx = images_.find(dx);
            images.dy = images_.find(dy);
            images.primal_variance = images_.find(primal_variance);
            images.dx_variance = images_.find(dx_variance);
            images.dy_variance = images_.find(dy_variance);
        }
        halves.samples = samples_of_halves();
        return halves;
    }

    /// As the render's file says; as many in both halves where it does not.
    std::array<std::uint64_t, 2> samples_of_halves() const {
        const std::uint64_t samples = stated_samples().value_or(0);
        const std::uint64_t pixels = std::uint64_t(images_.width) * images_.height;
        if (samples == 0)
            return {1, 1};
        // Halves without differences need no variances.
        const std::uint64_t least = images_.find(GradientLayer::dx_even) ? 2 * least_half_samples : 2;
        if (samples / pixels < least)
            throw Error(ExitCode::image,
                        fmt::format("{} needs {} samples of each pixel, and the render that wrote these layers took {}",
                                    record_.reconstruction, least, samples / pixels));
        return {samples_of_part(samples, pixels, 0, 2), samples_of_part(samples, pixels, 1, 2)};
    }

    Image result_image() const {
        Image image;
        image.width = images_.width;
        image.height = images_.height;
        image.origin = images_.origin;
        const std::size_t pixels = std::size_t(images_.width) * images_.height;
        for (std::size_t c = 0; c < images_.channels.size(); ++c) {
            const auto plane = result_.begin() + static_cast<std::ptrdiff_t>(c * pixels);
            image.channels.push_back({images_.channels[c], {plane, plane + static_cast<std::ptrdiff_t>(pixels)}});
        }
        // What was rendered stays known, so that `gradus compare` finds seeds and sample counts.
        for (const char *key : {"scene", "seed", "samples", "spp", "crop", "partial"})
            if (const auto at = images_.metadata.find(key); at != images_.metadata.end())
                image.metadata[key] = at->second;
        image.metadata["version"] = version();
        image.metadata["method"] = report_.method;
        image.metadata["reconstruction"] = record_.reconstruction;
        if (request_.sources.features)
            image.metadata["guide"] = guide_name(request_.guide.value_or(Guide::filter));
        image.metadata["norm"] = record_.norm;
        image.metadata["weights"] = record_.weights;
        image.metadata["alpha"] = fmt::format("{}", report_.alpha);
        image.metadata["device"] = record_.device.name;
        image.metadata["seconds"] = fmt::format("{:.3f}", report_.seconds);
        return image;
    }

    bool write_results() {
        Image image = result_image();
        const std::uint64_t non_finite = settle_values(image).values;
        Image grey; // a picture has three channels
        if (request_.outputs.png && image.channels.size() == 1)
            grey = {image.width,
                    image.height,
                    {{"R", image.channels[0].values}, {"G", image.channels[0].values}, {"B", image.channels[0].values}},
                    {}};
        write_outputs(request_.outputs, image, grey.channels.empty() ? image : grey, [&] {
            record_.wall_seconds = seconds_since(start_);
            return solve_report_json(record_, report_);
        });
        if (non_finite > 0)
            print_message(fmt::format("gradus: error: {} values of the image are NaN or infinite; the file holds them "
                                      "as 0\n",
                                      non_finite));
        // L1 comes ever closer and is stopped by count as a rule; L2 that does not arrive is not the solution.
        if (!report_.converged && request_.options.iterations == 0 && request_.options.norm == PoissonNorm::l2)
            warn("the tolerance was not reached");
        const std::uint64_t primals = request_.sources.halves ? 2 : 1;
        if (report_.missing_primal == primals * images_.width * images_.height)
            warn("no pixel of the primal has a finite value");
        if (!request_.quiet && request_.outputs.statistics != "-")
            print_result(solve_report_text(report_));
        return non_finite == 0;
    }

    SolveRequest request_;
    const Services &services_;
    const Clock::time_point start_ = Clock::now();
    GradientImages images_;
    std::vector<float> result_;
    PoissonReport report_;
    SolveRecord record_;
};

} // namespace

void check_images_fit(const DeviceDescription &device, std::uint32_t width, std::uint32_t height,
                      std::uint32_t channels) {
    const std::uint64_t bytes = std::uint64_t(width) * height * channels * sizeof(float);
    if (bytes > device.allocation_bytes)
        throw Error(
            ExitCode::device,
            fmt::format("images of {}x{} pixels are too large for {}: with {} channels they have {} MB each, and "
                        "it allocates {} MB at once",
                        width, height, device.name, channels, bytes >> 20, device.allocation_bytes >> 20));
}

int run_solve(SolveRequest request, const Services &services) {
    check_options(request);
    check_outputs(request.outputs);
    check_inputs_are_kept(request);
    try {
        const bool is_finite = SolveJob(std::move(request), services).run();
        return static_cast<int>(is_finite ? ExitCode::success : ExitCode::failure);
    } catch (const std::bad_alloc &) {
        throw Error(ExitCode::device, "out of memory: the images are too large for this machine");
    }
}

} // namespace gradus
