#include "driver/comparison.h"

#include "driver/place_in_frame.h"
#include "runtime/error.h"
#include "runtime/io/image_io.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <map>

namespace gradus {
namespace {

Image read_selected(const std::string &path, const CompareRequest &request) {
    const std::string &layer = request.layer;
    Image image = read_image(path, request.limits);
    if (layer.empty())
        return image;
    try {
        return select_layer(image, layer);
    } catch (const Error &error) {
        throw Error(error.code, fmt::format("{}: {}", path, error.what()));
    }
}

/// A file that holds a variance, or our own image with its variance as a layer, which is that of its samples' mean.
Image read_variance(const CompareRequest &request) {
    const Image image = read_selected(request.variance, request);
    if (!request.layer.empty() || !image.find("variance.R"))
        return image;
    const auto made_by = image.metadata.find("reconstruction");
    if (made_by != image.metadata.end() && made_by->second != "none")
        throw Error(ExitCode::image, fmt::format("{}: its pixels are a reconstruction ({}), and its layer variance is "
                                                 "that of the samples' mean; render the reference with --method pt",
                                                 request.variance, made_by->second));
    return select_layer(image, "variance");
}

/// Scores of what is no variance would tell nothing.
void check_variance(const Image &variance, const Image &reference, const std::string &path) {
    for (const Channel *channel : compared_channels(variance, reference))
        for (const float value : channel->values)
            if (value < 0)
                throw Error(ExitCode::image,
                            fmt::format("{}: a variance is below 0 in channel {}: {:g}", path, channel->name, value));
}

/// Images of different places have no pixel in common.
void check_place(const std::string &path, const Image &image, const std::string &other_path, const Image &other) {
    const PlaceInFrame ours = place_in_frame(image), theirs = place_in_frame(other);
    if (!may_be_one_place(ours, theirs))
        throw Error(ExitCode::image, fmt::format("'{}' is {}, and '{}' is {}: they have not the same pixels", path,
                                                 place_text(ours), other_path, place_text(theirs)));
}

/// Samples a pixel as our own files state them; 0 where the file does not say.
double stated_samples(const Image &image) {
    const auto at = image.metadata.find("spp");
    return at == image.metadata.end() ? 0.0 : std::max(0.0, std::strtod(at->second.c_str(), nullptr));
}

Comparison::Figures figures_of(const std::string &name, const Image &image, const Image &reference) {
    Comparison::Figures figures;
    figures.name = name;
    try {
        figures.relative_mse = relative_mse(image, reference);
    } catch (const Error &error) {
        throw Error(error.code, fmt::format("{}: {}", name, error.what()));
    }
    figures.trimmed_relative_mse = trimmed_relative_mse(image, reference);
    figures.psnr = psnr(image, reference);
    figures.mean = compare_means(image, reference);
    Image judged;
    judged.width = image.width;
    judged.height = image.height;
    for (const Channel *channel : compared_channels(image, reference))
        judged.channels.push_back(*channel);
    figures.non_finite = count_non_finite(judged);
    return figures;
}

/// The same seed twice is one sample, not two.
void check_independence(const std::vector<const Image *> &images, const std::vector<std::string> &names,
                        Comparison &result) {
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < images.size(); ++i) {
        const auto at = images[i]->metadata.find("seed");
        if (at == images[i]->metadata.end())
            continue;
        const auto [first, fresh] = seen.emplace(at->second, i);
        if (!fresh)
            result.failures.push_back(fmt::format("'{}' and '{}' have the same seed {}: they are not independent",
                                                  names[first->second], names[i], at->second));
    }
}

void find_sample_counts(const CompareRequest &request, const std::vector<Image> &images, const Image &reference,
                        Comparison &result) {
    result.samples_per_pixel = request.samples_per_pixel;
    if (result.samples_per_pixel <= 0) {
        double least = stated_samples(images[0]), most = least;
        for (const Image &image : images) {
            least = std::min(least, stated_samples(image));
            most = std::max(most, stated_samples(image));
        }
        if (least != most)
            result.notes.push_back(fmt::format("the images have from {:g} to {:g} samples a pixel; all count as {:g}",
                                               least, most, least));
        result.samples_per_pixel = least;
    }
    result.reference_spp = request.reference_spp > 0 ? request.reference_spp : stated_samples(reference);
    const auto sampler = images[0].metadata.find("sampler");
    if (images.size() == 1 && result.variance_given && sampler != images[0].metadata.end() &&
        sampler->second == "sobol" && result.samples_per_pixel < result.reference_spp)
        result.notes.push_back("of Sobol samples few have more variance than the reference's tells, which falls faster "
                               "than 1 / n: z scores are too large; give images of several seeds");
    if (result.variance_given && (result.samples_per_pixel <= 0 || result.reference_spp <= 0))
        result.notes.push_back(fmt::format("the reference's variance is no floor for ours: {} not known (give {})",
                                           result.reference_spp <= 0 ? "its sample count is" : "our sample count is",
                                           result.reference_spp <= 0 ? "--reference-spp" : "--spp"));
}

void judge_test(const char *where, const BlockTest &test, double limit, bool count_too, Comparison &result) {
    if (test.non_finite > 0)
        result.failures.push_back(fmt::format("{}: {} are not finite", where, test.non_finite));
    if (test.tested == 0)
        result.failures.push_back(fmt::format("{}: nothing to test", where));
    if (test.largest > limit)
        result.failures.push_back(fmt::format("{}: largest |z| {:.2f} is over {:.2f}", where, test.largest, limit));
    if (count_too && test.over_three > test.over_three_limit)
        result.failures.push_back(fmt::format("{}: {} scores are over 3, at most {} by chance", where, test.over_three,
                                              test.over_three_limit));
}

void run_tests(const CompareRequest &request, const std::vector<Image> &images, const Image &reference,
               const Image &variance, Comparison &result) {
    const bool known =
        images.size() > 1 || (result.variance_given && result.samples_per_pixel > 0 && result.reference_spp > 0);
    if (!known)
        return;
    const auto test = [&](int block) {
        return block_z_test(images, reference, variance, result.samples_per_pixel, result.reference_spp, block,
                            request.reference_batches);
    };
    result.whole = test(0);
    result.blocks = test(request.block);
    result.pixels = test(1);
    judge_test("whole image", *result.whole, result.whole->largest_limit, false, result);
    judge_test("blocks", *result.blocks, request.threshold > 0 ? request.threshold : result.blocks->largest_limit,
               request.threshold <= 0, result);
}

std::string error_layer_line(const ErrorCalibration &error) {
    return fmt::format("  error layer: {:.1f} % of the errors within it, {:.1f} % within twice that{}\n",
                       100 * error.within, 100 * error.within_twice,
                       error.relative_mse ? fmt::format("; estimated relMSE {:.4e}", *error.relative_mse) : "");
}

std::string figures_line(const Comparison::Figures &figures) {
    return fmt::format(
               "{}\n  relMSE {:.4e}   trimmed {:.4e}   PSNR {:.2f} dB   mean ratio {}   bias {:+.3e}{}\n", figures.name,
               figures.relative_mse, figures.trimmed_relative_mse, figures.psnr,
               std::isfinite(figures.mean.ratio) ? fmt::format("{:.6f}", figures.mean.ratio) : "none",
               figures.mean.bias,
               figures.non_finite > 0
                   ? fmt::format("\n  {} values are NaN or infinite; their pixels are left out", figures.non_finite)
                   : "") +
           (figures.error_layer ? error_layer_line(*figures.error_layer) : "");
}

std::string test_line(const char *name, const BlockTest &test) {
    std::string where = "none";
    if (test.tested > 0) {
        const std::size_t per_channel = std::size_t(test.blocks_x) * test.blocks_y;
        const std::size_t at = test.largest_index % per_channel;
        where = fmt::format("{:.2f} at ({}, {}) in {}", test.largest, at % test.blocks_x, at / test.blocks_x,
                            test.channels[test.largest_index / per_channel]);
    }
    return fmt::format("  {:<12} {} scores, largest |z| {} (limit {:.2f}); over 3: {}, by chance {:.1f} (limit {})\n",
                       name, test.tested, where, test.largest_limit, test.over_three, test.expected_over_three,
                       test.over_three_limit);
}

/// Numbers of JSON are finite, and a PSNR is infinite for what is equal and for what is all wrong.
nlohmann::json psnr_json(double psnr) {
    return std::isinf(psnr) ? nlohmann::json(psnr > 0 ? "inf" : "-inf") : nlohmann::json(psnr);
}

nlohmann::json figures_json(const Comparison::Figures &figures) {
    nlohmann::json json{{"name", figures.name},
                        {"relative_mse", figures.relative_mse},
                        {"trimmed_relative_mse", figures.trimmed_relative_mse},
                        {"psnr", psnr_json(figures.psnr)},
                        {"mean", figures.mean.image},
                        {"reference_mean", figures.mean.reference},
                        {"mean_ratio", figures.mean.ratio},
                        {"bias", figures.mean.bias},
                        {"non_finite", figures.non_finite}};
    if (const auto &error = figures.error_layer) {
        json["error_layer"] = {{"within", error->within}, {"within_twice", error->within_twice}};
        if (error->relative_mse)
            json["error_layer"]["relative_mse"] = *error->relative_mse;
    }
    return json;
}

nlohmann::json test_json(const BlockTest &test, bool with_scores) {
    nlohmann::json json{{"tested", test.tested},
                        {"non_finite", test.non_finite},
                        {"largest", test.largest},
                        {"largest_limit", test.largest_limit},
                        {"over_three", test.over_three},
                        {"expected_over_three", test.expected_over_three},
                        {"over_three_limit", test.over_three_limit},
                        {"blocks_x", test.blocks_x},
                        {"blocks_y", test.blocks_y},
                        {"channels", test.channels}};
    if (with_scores) {
        json["z"] = test.z;
        json["difference"] = test.difference;
        json["standard_error"] = test.standard_error;
    }
    return json;
}

} // namespace

Comparison compare_images(const CompareRequest &request) {
    Comparison result;
    result.reference = request.reference;
    result.block = request.block;
    result.variance_given = !request.variance.empty();
    const Image reference = read_selected(request.reference, request);
    const Image variance = result.variance_given ? read_variance(request) : Image();
    if (result.variance_given) {
        check_place(request.variance, variance, request.reference, reference);
        result.reference_relative_mse = relative_variance(variance, reference);
        check_variance(variance, reference, request.variance);
    }
    std::vector<Image> images;
    for (const std::string &path : request.images) {
        images.push_back(read_selected(path, request));
        check_place(path, images.back(), request.reference, reference);
        // Of each other they may tell what the reference does not.
        check_place(path, images.back(), request.images.front(), images.front());
        result.images.push_back(figures_of(path, images.back(), reference));
        if (request.layer.empty())
            result.images.back().error_layer = error_calibration(images.back(), reference, variance);
        if (result.images.back().non_finite > 0)
            result.failures.push_back(
                fmt::format("'{}' holds {} values that are not finite", path, result.images.back().non_finite));
    }
    result.reference_peak = reference_peak(reference);
    result.reference_non_finite = count_non_finite(reference);
    if (result.reference_non_finite > 0)
        result.failures.push_back(
            fmt::format("the reference holds {} values that are not finite", result.reference_non_finite));
    find_sample_counts(request, images, reference, result);
    result.mean_image = mean_image(images);
    if (images.size() > 1)
        result.mean = figures_of(fmt::format("mean of {} images", images.size()), result.mean_image, reference);
    run_tests(request, images, reference, variance, result);
    std::vector<const Image *> independent;
    std::vector<std::string> names = request.images;
    for (const Image &image : images)
        independent.push_back(&image);
    if (result.whole) { // its scores take the reference for another sample
        independent.push_back(&reference);
        names.push_back(request.reference);
    }
    check_independence(independent, names, result);
    const double judged = result.mean ? result.mean->relative_mse : result.images[0].relative_mse;
    // Negated, so that NaN fails.
    if (request.largest_relative_mse > 0 && !(judged <= request.largest_relative_mse))
        result.failures.push_back(fmt::format("relMSE {:.4e} is over {:.4e}", judged, request.largest_relative_mse));
    result.judged = result.whole.has_value() || request.largest_relative_mse > 0;
    result.reference_image = reference;
    return result;
}

const char *const what_bias_needs = "several seeds, or --variance and sample counts";

std::string comparison_text(const Comparison &comparison) {
    std::string text;
    for (const Comparison::Figures &figures : comparison.images)
        text += figures_line(figures);
    if (comparison.mean)
        text += figures_line(*comparison.mean);
    text += fmt::format("reference {}, PSNR peak {:.6g}{}\n", comparison.reference, comparison.reference_peak,
                        comparison.reference_relative_mse
                            ? fmt::format(", its own relMSE {:.4e}", *comparison.reference_relative_mse)
                            : "");
    for (const std::string &note : comparison.notes)
        text += "note: " + note + "\n";
    if (comparison.blocks) {
        text += fmt::format("z scores against the reference{}\n",
                            comparison.variance_given ? " and its variance" : " (its own variance taken as 0)");
        for (std::size_t c = 0; c < comparison.whole->channels.size(); ++c)
            text += fmt::format("  {:<12} bias {:+.3e} +- {:.3e}   z {:+.2f}\n", comparison.whole->channels[c],
                                comparison.whole->difference[c], comparison.whole->standard_error[c],
                                comparison.whole->z[c]);
        text += test_line("whole image", *comparison.whole);
        text += test_line(fmt::format("blocks of {}", comparison.block).c_str(), *comparison.blocks);
        text += test_line("pixels", *comparison.pixels);
        text += "  pixels are not judged: single pixels are far from normal\n";
    }
    for (const std::string &failure : comparison.failures)
        text += "FAILED: " + failure + "\n";
    if (comparison.failures.empty())
        text += comparison.blocks ? std::string("verdict: equal within the noise\n")
                                  : fmt::format("verdict: none on bias (it needs {})\n", what_bias_needs);
    else
        text += "verdict: not equal\n";
    return text;
}

nlohmann::json comparison_json(const Comparison &comparison) {
    nlohmann::json images = nlohmann::json::array();
    for (const Comparison::Figures &figures : comparison.images)
        images.push_back(figures_json(figures));
    nlohmann::json json{{"images", images},
                        {"reference", comparison.reference},
                        {"reference_peak", comparison.reference_peak},
                        {"reference_non_finite", comparison.reference_non_finite},
                        {"samples_per_pixel", comparison.samples_per_pixel},
                        {"reference_samples_per_pixel", comparison.reference_spp},
                        {"notes", comparison.notes},
                        {"failures", comparison.failures},
                        {"judged", comparison.judged},
                        {"holds", comparison.judged && comparison.failures.empty()}};
    if (comparison.reference_relative_mse)
        json["reference_relative_mse"] = *comparison.reference_relative_mse;
    if (comparison.mean)
        json["mean"] = figures_json(*comparison.mean);
    if (comparison.blocks) {
        json["block"] = comparison.block;
        json["z"] = {{"whole", test_json(*comparison.whole, true)},
                     {"blocks", test_json(*comparison.blocks, true)},
                     {"pixels", test_json(*comparison.pixels, false)}};
    }
    return json;
}

} // namespace gradus
