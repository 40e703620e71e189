#include "methods/gradient_image.h"

#include "methods/error_layer.h"
#include "methods/gradient_error.h"
#include "methods/reconstruction_inputs.h"
#include "runtime/wavefront/sample_parts.h"
#include "solver/guide/guided_reconstruction.h"
#include "solver/weighted_reconstruction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace gradus {

namespace {

constexpr auto film_layers = {GradientFilm::primal, GradientFilm::dx, GradientFilm::dy};
const char *const layer_names[] = {"primal", "dx", "dy"}, *const colors[] = {"R", "G", "B"};
const char *const half_suffixes[] = {"_even", "_odd"};

/// Makes of the channels of `whole` what they have and the primal has not.
void take_primal_off(Image &whole, const GradientFilms &films, const std::vector<DirectPixel> &edges) {
    std::vector<float> primal(films.pixels());
    const PlaneSource mean = films.mean(GradientFilm::primal);
    for (std::uint32_t c = 0; c < 3; ++c) {
        std::vector<float> &direct = whole.channels[c].values;
        mean(c, primal.data());
        for (std::size_t i = 0; i < direct.size(); ++i) {
            const float seen = direct[i] - primal[i];
            // Where no light is seen, the difference is rounding.
            direct[i] = std::abs(seen) > 1e-6f * std::abs(primal[i]) ? seen : 0.0f;
        }
        for (const DirectPixel &edge : edges)
            direct[edge.pixel] = edge.light[c];
    }
}

/// What `gradus solve` needs to make the image again: from the channels `direct` of an image, and from the films.
/// Halves are there with their variances, which their reconstruction needs.
std::vector<Channel> layers_of(const Image &direct, const GradientFilms &films, bool variances) {
    std::vector<Channel> layers;
    for (std::uint32_t c = 0; c < 3; ++c)
        layers.push_back({std::string("direct.") + colors[c], direct.channels[c].values});
    const auto add = [&](const GradientFilms &read, const char *suffix, bool with_variances) {
        const auto add_layer = [&](const std::string &name, const PlaneSource &source) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                layers.push_back({fmt::format("{}.{}", name, colors[c]), std::vector<float>(read.pixels())});
                source(c, layers.back().values.data());
            }
        };
        for (const auto layer : film_layers) {
            const std::string name = fmt::format("{}{}", layer_names[layer], suffix);
            add_layer(name, read.mean(layer));
            if (with_variances)
                add_layer(name + "_variance", read.variance(layer));
        }
    };
    add(films, "", variances);
    for (int half = 0; films.are_halves() && half < 2; ++half)
        add(films.half(half), half_suffixes[half], true);
    return layers;
}

/// The result takes the place of the direct image, which is added to it. Returns the weight of the primal that was
/// used.
double reconstruct_from_film(PoissonSolver &solver, Image &whole, GradientFilms &films, const PoissonOptions &poisson,
                             const std::function<void()> &films_are_read) {
    ImageSources images = films.images();
    const auto plane_of = [&whole](std::uint32_t c) { return whole.channels[c].values.data(); };
    const std::size_t pixels = films.pixels(), with_samples = films.pixels_with_samples();
    images.direct = [&](std::uint32_t c, float *plane) { std::copy_n(plane_of(c), pixels, plane); };
    const PoissonReport report = solver.solve(
        images, poisson,
        [&](std::uint32_t c, const float *plane) {
            std::copy_n(plane, with_samples, plane_of(c));
            // What the solver tells of the others comes from those beside them.
            std::fill_n(plane_of(c) + with_samples, pixels - with_samples, 0.0f);
        },
        [&] {
            films.release();
            if (films_are_read)
                films_are_read();
        });
    return report.alpha;
}

/// A half in device memory, with its variances.
HalfImages uploaded_half(Device &device, const GradientFilms &film) {
    const ImageSources images = film.images();
    const std::size_t pixels = film.pixels();
    HalfImages half;
    half.primal = uploaded(device, "primal", pixels, images.primal);
    half.dx = uploaded(device, "dx", pixels, images.dx);
    half.dy = uploaded(device, "dy", pixels, images.dy);
    half.primal_variance = uploaded(device, "primal_variance", pixels, images.primal_variance);
    half.dx_variance = uploaded(device, "dx_variance", pixels, images.dx_variance);
    half.dy_variance = uploaded(device, "dy_variance", pixels, images.dy_variance);
    half.samples = film.samples();
    return half;
}

void reconstruct_from_halves(Device &device, PoissonSolver &solver, Image &whole, GradientFilms &films,
                             const RenderOptions &options, SquaredErrors *errors,
                             const std::function<void()> &films_are_read) {
    const std::size_t pixels = films.pixels();
    const HalvedImages halves{uploaded_half(device, films.half(0)), uploaded_half(device, films.half(1))};
    films.release();
    if (films_are_read)
        films_are_read();
    Buffer result(device, "result", 3 * pixels * sizeof(float));
    if (options.reconstruction == Reconstruction::guided) {
        GuideInputs inputs;
        inputs.features = uploaded_features(device, whole);
        inputs.direct = uploaded(device, "direct", pixels, [&](std::uint32_t c, float *plane) {
            std::copy_n(whole.channels[c].values.data(), pixels, plane);
        });
        GuidedReconstruction(device, solver, options.guide, options.threads).solve(halves, inputs, result, errors);
    } else
        WeightedReconstruction(device, solver).solve(halves, result, errors);
    const auto mapping = result.map(Access::read);
    for (std::uint32_t c = 0; c < 3; ++c) {
        const float *plane = mapping.as<float>() + c * pixels;
        std::vector<float> &image = whole.channels[c].values;
        for (std::size_t i = 0; i < pixels; ++i)
            image[i] += plane[i];
    }
}

/// How an image of so many samples is reconstructed, and what its mean tends to. Halves of one sample have no
/// variances to judge each other by: l1 then.
ReconstructionUsed reconstruction_used(const RenderOptions &options, std::uint64_t samples, std::uint64_t pixels) {
    Reconstruction reconstruction = options.reconstruction;
    ReconstructionUsed used;
    if (needs_halves(reconstruction) && !halves_have_variances(samples, pixels)) {
        used.note = fmt::format("{} needs {} samples of each pixel, two in each half; with less it is l1",
                                reconstruction_name(reconstruction), 2 * least_half_samples);
        reconstruction = Reconstruction::l1;
    }
    used.name = reconstruction_name(reconstruction);
    if (reconstruction == Reconstruction::guided)
        used.guide = guide_name(options.guide);
    // One weight by the variances of all pixels is next to independent of each, and not quite.
    const bool l2_is_linear = options.alpha || samples / pixels <= 1;
    const bool unbiased =
        reconstruction == Reconstruction::weighted || (reconstruction == Reconstruction::l2 && l2_is_linear);
    used.accuracy = accuracy_name(unbiased ? Accuracy::unbiased : Accuracy::consistent);
    return used;
}

} // namespace

PoissonOptions poisson_options(const RenderOptions &options, std::uint64_t frames) {
    PoissonOptions poisson;
    poisson.norm = options.reconstruction == Reconstruction::l2 ? PoissonNorm::l2 : PoissonNorm::l1;
    poisson.alpha_from_variances = !options.alpha && frames > 1;
    poisson.alpha = options.alpha.value_or(poisson.alpha);
    return poisson;
}

void compile_reconstruction(Device &device, const RenderOptions &options, std::uint64_t frames,
                            const KernelLibrary::Progress &progress) {
    if (needs_halves(options.reconstruction) && halves_have_variances(frames, 1))
        options.reconstruction == Reconstruction::guided ? GuidedReconstruction::compile(device, progress)
                                                         : WeightedReconstruction::compile(device, 3, progress);
    else
        PoissonSolver::compile(device, poisson_options(options, frames), 3, Precision::single, progress);
}

Image reconstruct(Device &device, PoissonSolver &solver, Image whole, GradientFilms films,
                  const std::vector<DirectPixel> &edges, const RenderOptions &options, bool layers,
                  const std::function<void()> &films_are_read, ReconstructionUsed &used, ErrorOfImage *error) {
    used = reconstruction_used(options, films.samples(), films.pixels());
    if (used.note.empty())
        used.note = note_of_colors(whole);
    take_primal_off(whole, films, edges);
    std::vector<Channel> more;
    if (layers) {
        more = layers_of(whole, films, tells_variance(options));
        whole.metadata["layer_samples"] = std::to_string(films.samples());
    }
    SquaredErrors errors;
    const bool tells_error = error && films.are_halves() && films.frames() >= 2;
    if (needs_halves(options.reconstruction) && halves_have_variances(films.samples(), films.pixels()))
        reconstruct_from_halves(device, solver, whole, films, options, tells_error ? &errors : nullptr, films_are_read);
    else {
        const PoissonOptions poisson = poisson_options(options, films.frames());
        if (tells_error)
            errors = errors_of_solves(solver, films, poisson);
        used.alpha = reconstruct_from_film(solver, whole, films, poisson, films_are_read);
    }
    if (!options.aov && !layers) // features, if any, were there for the guide
        whole.channels.resize(3);
    whole.channels.insert(whole.channels.begin() + 3, std::make_move_iterator(more.begin()),
                          std::make_move_iterator(more.end()));
    if (tells_error) {
        for (std::size_t i = 0; i < errors.variance.size(); ++i)
            errors.variance[i] += error->direct_variance[i];
        error->relative = add_error_layer(whole, errors);
    }
    return whole;
}

} // namespace gradus
