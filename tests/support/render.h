// Rendering in process, and what tests ask of the images.
#pragma once

#include "methods/method.h"
#include "planning/make_method.h"
#include "runtime/device/device.h"
#include "runtime/device/program.h"
#include "runtime/film/image.h"
#include "runtime/film/metrics.h"
#include "runtime/scene/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace gradus::testing {

/// The device that all renders of a process share.
inline Device &shared_device() {
    static Device device("");
    static const std::shared_ptr<void> compilers = keep_compilers(device); // many renders, each with some new kernels
    return device;
}

struct Rendered {
    Image image;
    Statistics statistics;
};

/// Renders all samples, to an image with the layers that it was reconstructed from. Values that are not finite, left
/// out by the film, fail the test.
inline Rendered render(const Scene &scene, RenderOptions options = {}, const char *name = "pt") {
    options.layers = true;
    const std::unique_ptr<Method> method = make_method(name, shared_device(), scene, options);
    while (method->render_batch()) {
    }
    Rendered result{method->image(), {}};
    result.statistics = method->statistics();
    EXPECT_EQ(method->done_samples(), method->total_samples());
    EXPECT_EQ(result.statistics.non_finite, 0u) << "samples that are NaN or infinite";
    EXPECT_EQ(count_non_finite(result.image), 0u);
    return result;
}

/// Images of seeds first, first + 1, ...
inline std::vector<Image> render_seeds(const Scene &scene, std::size_t count, RenderOptions options = {},
                                       std::uint64_t first = 1, const char *name = "pt") {
    std::vector<Image> images;
    for (std::size_t i = 0; i < count; ++i) {
        options.seed = first + i;
        images.push_back(render(scene, options, name).image);
    }
    return images;
}

inline double pixel(const Image &image, std::uint32_t x, std::uint32_t y, const std::string &channel = "G") {
    return image.find(channel)->values.at(std::size_t(y) * image.width + x);
}

/// For tests that look at layers alone: all samples in one image, by the fastest reconstruction.
inline void do_not_weigh(RenderOptions &options) {
    options.reconstruction = Reconstruction::l2;
    options.alpha = 0.2;
}

/// Mean, standard error and extremes of a set of values.
struct Spread {
    double mean = 0, standard_error = 0, least = INFINITY, most = -INFINITY;
};

inline Spread spread_of(const std::vector<double> &values) {
    Spread spread;
    const double count = double(values.size());
    for (const double value : values) {
        spread.mean += value / count;
        spread.least = std::min(spread.least, value);
        spread.most = std::max(spread.most, value);
    }
    double squares = 0;
    for (const double value : values)
        squares += (value - spread.mean) * (value - spread.mean);
    spread.standard_error = std::sqrt(squares / (count - 1) / count);
    return spread;
}

/// Of the pixels of one channel; the standard error is right where all pixels estimate the same value.
inline Spread spread_of(const Image &image, const std::string &channel = "G") {
    const std::vector<float> &values = image.find(channel)->values;
    return spread_of(std::vector<double>(values.begin(), values.end()));
}

/// The mean over images by pixel, and the variance of that mean from their spread.
struct MeanAndVariance {
    Image mean, variance;
};

inline MeanAndVariance mean_and_variance(const std::vector<Image> &images) {
    MeanAndVariance result{mean_image(images), mean_image(images)};
    const double count = double(images.size());
    for (std::size_t c = 0; c < result.mean.channels.size(); ++c)
        for (std::size_t i = 0; i < result.mean.channels[c].values.size(); ++i) {
            double mean = 0, squares = 0;
            for (const Image &image : images)
                mean += image.find(result.mean.channels[c].name)->values[i] / count;
            for (const Image &image : images)
                squares += std::pow(image.find(result.mean.channels[c].name)->values[i] - mean, 2);
            result.variance.channels[c].values[i] = float(squares / (count - 1) / count);
        }
    return result;
}

} // namespace gradus::testing
