#include "bench/render/measurements.h"
#include "planning/make_method.h"
#include "runtime/error.h"
#include "runtime/film/metrics.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

namespace gradus::bench {

namespace {

/// Passes of each half of the reference over those of the longest render.
constexpr std::uint64_t reference_length = 8;
/// Seeds of the halves; those of the renders count from 1.
constexpr std::uint64_t reference_seeds[] = {1'000'001, 1'000'002};
/// Light paths a pass. Nearly all leave no photon that counts.
constexpr std::uint64_t light_paths = 100'000;

enum Estimate { throughput, reconstruction, throughput_differences, gradients, estimate_count };
constexpr std::array<const char *, estimate_count> names = {"throughput", "reconstruction", "throughput_differences",
                                                            "gradients"};

RenderOptions options_for(const Settings &settings, std::uint64_t seed) {
    RenderOptions options;
    options.threads = settings.threads;
    options.seed = seed;
    options.layers = options.only_chains = true;
    // Linear, and so unbiased: a norm and a weight that do not look at what they weigh. One radius, one expectation.
    options.reconstruction = Reconstruction::l2;
    options.alpha = 0.2;
    options.radius = RenderOptions::GatherRadius{1, false};
    options.radius_alpha = 1;
    options.photons = light_paths;
    return options;
}

using Values = std::vector<double>;

Values values_of(const Image &image, const std::string &layer) {
    Values values;
    for (const char *color : {"R", "G", "B"}) {
        const std::vector<float> &channel = image.find(layer + color)->values;
        values.insert(values.end(), channel.begin(), channel.end());
    }
    return values;
}

/// To the right and downwards, 0 at the borders; of R, G and B one after the other.
Values differences_of(const Values &values, std::size_t width, std::size_t height) {
    Values result(2 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t x = i % width, y = i / width % height;
        result[i] = x + 1 < width ? values[i + 1] - values[i] : 0;
        result[values.size() + i] = y + 1 < height ? values[i + width] - values[i] : 0;
    }
    return result;
}

/// dx and dy as the method gives them; those at the borders lead nowhere.
Values gradients_of(const Image &image) {
    Values result = values_of(image, "dx."), down = values_of(image, "dy.");
    const std::size_t width = image.width, height = image.height;
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = i % width + 1 < width ? result[i] : 0;
        down[i] = i / width % height + 1 < height ? down[i] : 0;
    }
    result.insert(result.end(), down.begin(), down.end());
    return result;
}

double mean_product(const Values &a, const Values &b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += a[i] * b[i];
    return sum / double(a.size());
}

/// Two independent estimates of the truth: (I - R_1) (I - R_2) has the squared error of I as its mean, whatever the
/// noise of both.
struct Reference {
    Values halves[2];

    double magnitude() const { return mean_product(halves[0], halves[1]); }
    double squared_error(const Values &image) const {
        double sum = 0;
        for (std::size_t i = 0; i < image.size(); ++i)
            sum += (image[i] - halves[0][i]) * (image[i] - halves[1][i]);
        return sum / double(image.size());
    }
};

} // namespace

nlohmann::json measure_chains(const Settings &settings, const Job &job) {
    const std::uint64_t longest = job.scene.settings.samples_per_pixel;
    const std::size_t width = job.scene.film.width, height = job.scene.film.height;
    Reference image, change;
    for (int half = 0; half < 2; ++half) {
        Scene scene = job.scene;
        scene.settings.samples_per_pixel = reference_length * longest;
        const std::unique_ptr<Method> method =
            make_method("gpm", settings.device, scene, options_for(settings, reference_seeds[half]));
        while (method->render_batch()) {
        }
        image.halves[half] = values_of(method->last_image(), "primal.");
        change.halves[half] = differences_of(image.halves[half], width, height);
    }
    if (!(image.magnitude() > 0))
        throw Error(ExitCode::usage, "there is no light by chains in " + job.name);

    std::map<std::uint64_t, std::array<double, estimate_count>> squared; // by passes; sums over the turns
    double failed = 0, shifts = 0;
    for (int turn = 1; turn <= settings.repeats; ++turn) {
        const std::unique_ptr<Method> method =
            make_method("gpm", settings.device, job.scene, options_for(settings, std::uint64_t(turn)));
        for (std::uint64_t passes = 1; passes <= longest; passes *= 4) {
            while (method->done_samples() < passes * width * height)
                method->render_batch();
            const Image found = method->image();
            const Values primal = values_of(found, "primal.");
            Values solved = values_of(found, "");
            const Values direct = values_of(found, "direct."); // added to the reconstruction at last
            for (std::size_t i = 0; i < solved.size(); ++i)
                solved[i] -= direct[i];
            std::array<double, estimate_count> &sums = squared[passes];
            sums[throughput] += image.squared_error(primal);
            sums[reconstruction] += image.squared_error(solved);
            sums[throughput_differences] += change.squared_error(differences_of(primal, width, height));
            sums[gradients] += change.squared_error(gradients_of(found));
        }
        for (const auto &[what, count] : method->statistics().shifts) {
            failed += what == "failed" ? double(count) : 0;
            shifts += double(count);
        }
    }

    fmt::print("{}, chains alone: relative L2 errors\n  passes  throughput  reconstruction  its differences  "
               "gradients\n",
               job.name);
    nlohmann::json points = nlohmann::json::array();
    for (const auto &[passes, sums] : squared) {
        nlohmann::json point = {{"passes", passes}};
        std::array<double, estimate_count> errors;
        for (int estimate = 0; estimate < estimate_count; ++estimate) {
            const double magnitude = estimate < throughput_differences ? image.magnitude() : change.magnitude();
            errors[estimate] = std::sqrt(std::max(sums[estimate], 0.0) / settings.repeats / magnitude);
            point[names[estimate]] = errors[estimate];
        }
        points.push_back(point);
        fmt::print("  {:6}  {:10.4f}  {:14.4f}  {:15.4f}  {:9.4f}\n", passes, errors[throughput],
                   errors[reconstruction], errors[throughput_differences], errors[gradients]);
    }
    fmt::print("  {:.1f} % of the shifts fail\n", 100 * failed / shifts);
    return {{"job", job.name},           {"light_paths", light_paths},
            {"turns", settings.repeats}, {"reference_passes", 2 * reference_length * longest},
            {"points", points},          {"failed_shifts", failed / shifts}};
}

} // namespace gradus::bench
