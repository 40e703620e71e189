#include "runtime/film/metrics.h"

#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace gradus {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void fail(const std::string &message) { throw Error(ExitCode::image, message); }

std::vector<std::string> compared_names(const Image &reference) {
    if (reference.find("R") && reference.find("G") && reference.find("B"))
        return {"R", "G", "B"};
    std::vector<std::string> names;
    for (const Channel &channel : reference.channels)
        names.push_back(channel.name);
    return names;
}

/// An image and its reference, channel by channel.
struct Pair {
    std::vector<const Channel *> image, reference;
    std::size_t pixels = 0;

    Pair(const Image &a, const Image &r)
        : image(compared_channels(a, r)), reference(compared_channels(r, r)), pixels(reference[0]->values.size()) {}

    std::size_t channels() const { return image.size(); }
    bool finite(std::size_t pixel) const {
        for (std::size_t c = 0; c < channels(); ++c)
            if (!std::isfinite(image[c]->values[pixel]) || !std::isfinite(reference[c]->values[pixel]))
                return false;
        return true;
    }
    double difference(std::size_t channel, std::size_t pixel) const {
        return double(image[channel]->values[pixel]) - double(reference[channel]->values[pixel]);
    }
    /// Mean over the channels of the squared relative error.
    double squared_relative_error(std::size_t pixel) const {
        double sum = 0;
        for (std::size_t c = 0; c < channels(); ++c) {
            const double r = reference[c]->values[pixel], d = difference(c, pixel);
            sum += d * d / (r * r + relative_mse_epsilon);
        }
        return sum / double(channels());
    }
    /// Mean over the channels of the value of the image, a variance, over the reference squared.
    double relative_variance(std::size_t pixel) const {
        double sum = 0;
        for (std::size_t c = 0; c < channels(); ++c) {
            const double r = reference[c]->values[pixel];
            sum += image[c]->values[pixel] / (r * r + relative_mse_epsilon);
        }
        return sum / double(channels());
    }
};

std::vector<double> squared_relative_errors(const Image &image, const Image &reference) {
    const Pair pair(image, reference);
    std::vector<double> errors;
    errors.reserve(pair.pixels);
    for (std::size_t i = 0; i < pair.pixels; ++i)
        if (pair.finite(i))
            errors.push_back(pair.squared_relative_error(i));
    return errors;
}

double mean_of_first(const std::vector<double> &values, std::size_t count) {
    if (count == 0)
        return not_a_number;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        sum += values[i];
    return sum / double(count);
}

} // namespace

std::vector<const Channel *> compared_channels(const Image &image, const Image &reference) {
    if (image.width != reference.width || image.height != reference.height)
        fail(fmt::format("the images differ in size: {}x{} and {}x{}", image.width, image.height, reference.width,
                         reference.height));
    const std::size_t pixels = std::size_t(image.width) * image.height;
    std::vector<const Channel *> channels;
    for (const std::string &name : compared_names(reference)) {
        const Channel *channel = image.find(name);
        if (!channel)
            fail(fmt::format("an image lacks the channel '{}', which the reference has", name));
        if (channel->values.size() != pixels)
            fail(fmt::format("the channel '{}' does not fill the image", name));
        channels.push_back(channel);
    }
    if (pixels == 0 || channels.empty())
        fail("an image has no pixels or no channels");
    return channels;
}

bool equal_bits(const Image &a, const Image &b) {
    if (a.width != b.width || a.height != b.height || a.channels.size() != b.channels.size())
        return false;
    for (std::size_t c = 0; c < a.channels.size(); ++c) {
        const Channel &x = a.channels[c], &y = b.channels[c];
        if (x.name != y.name || x.values.size() != y.values.size() ||
            std::memcmp(x.values.data(), y.values.data(), sizeof(float) * x.values.size()) != 0)
            return false;
    }
    return true;
}

double relative_mse(const Image &image, const Image &reference) {
    const std::vector<double> errors = squared_relative_errors(image, reference);
    return mean_of_first(errors, errors.size());
}

double relative_variance(const Image &variance, const Image &reference) {
    const Pair pair(variance, reference);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pair.pixels; ++i)
        if (pair.finite(i)) {
            sum += pair.relative_variance(i);
            ++count;
        }
    return count == 0 ? not_a_number : sum / double(count);
}

double trimmed_relative_mse(const Image &image, const Image &reference, double fraction) {
    std::vector<double> errors = squared_relative_errors(image, reference);
    const auto left_out = static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * double(errors.size()));
    // Sorted in full, not partitioned: the order of the sum, and so its rounding, is then the same everywhere.
    std::sort(errors.begin(), errors.end());
    return mean_of_first(errors, errors.size() - left_out);
}

double reference_peak(const Image &reference) {
    const std::vector<const Channel *> channels = compared_channels(reference, reference);
    std::vector<float> values;
    for (const Channel *channel : channels)
        for (const float value : channel->values)
            if (std::isfinite(value))
                values.push_back(value);
    if (values.empty())
        return not_a_number;
    // In whole numbers: ceil(0.999 * 1000) in floating point may be 1000.
    const std::size_t rank = (values.size() * 999 + 999) / 1000;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank - 1), values.end());
    return values[rank - 1];
}

double psnr(const Image &image, const Image &reference) {
    const Pair pair(image, reference);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pair.pixels; ++i) {
        if (!pair.finite(i))
            continue;
        for (std::size_t c = 0; c < pair.channels(); ++c) {
            const double d = pair.difference(c, i);
            sum += d * d;
        }
        count += pair.channels();
    }
    if (count == 0)
        return not_a_number;
    if (sum == 0)
        return std::numeric_limits<double>::infinity();
    const double peak = reference_peak(reference);
    return 10 * std::log10(peak * peak / (sum / double(count)));
}

MeanComparison compare_means(const Image &image, const Image &reference) {
    const Pair pair(image, reference);
    double image_sum = 0, reference_sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pair.pixels; ++i) {
        if (!pair.finite(i))
            continue;
        for (std::size_t c = 0; c < pair.channels(); ++c) {
            image_sum += pair.image[c]->values[i];
            reference_sum += pair.reference[c]->values[i];
        }
        count += pair.channels();
    }
    MeanComparison result;
    result.image = count > 0 ? image_sum / double(count) : not_a_number;
    result.reference = count > 0 ? reference_sum / double(count) : not_a_number;
    result.ratio = result.image / result.reference;
    result.bias = result.image - result.reference;
    return result;
}

Image relative_error_image(const Image &image, const Image &reference) {
    const Pair pair(image, reference);
    Image error;
    error.width = reference.width;
    error.height = reference.height;
    for (std::size_t c = 0; c < pair.channels(); ++c) {
        Channel channel{pair.reference[c]->name, std::vector<float>(pair.pixels)};
        for (std::size_t i = 0; i < pair.pixels; ++i) {
            const double r = pair.reference[c]->values[i];
            channel.values[i] = static_cast<float>(pair.difference(c, i) / std::sqrt(r * r + relative_mse_epsilon));
        }
        error.channels.push_back(std::move(channel));
    }
    return error;
}

Image error_picture(const Image &error) {
    const std::vector<const Channel *> channels = compared_channels(error, error);
    const std::size_t pixels = channels[0]->values.size();
    Image picture;
    picture.width = error.width;
    picture.height = error.height;
    for (const char *name : {"R", "G", "B"})
        picture.channels.push_back({name, std::vector<float>(pixels)});
    for (std::size_t i = 0; i < pixels; ++i) {
        double mean = 0;
        for (const Channel *channel : channels)
            mean += channel->values[i] / double(channels.size());
        std::array<double, 3> color{1, 1, 0};
        if (std::isfinite(mean)) {
            const double brighter = std::clamp(mean, 0.0, 1.0), darker = std::clamp(-mean, 0.0, 1.0);
            color = {1 - darker, 1 - brighter - darker, 1 - brighter};
        }
        for (std::size_t c = 0; c < 3; ++c)
            picture.channels[c].values[i] = static_cast<float>(color[c]);
    }
    return picture;
}

Image mean_image(const std::vector<Image> &images) {
    if (images.empty())
        fail("there is no image");
    Image mean;
    mean.width = images[0].width;
    mean.height = images[0].height;
    std::vector<std::vector<const Channel *>> channels;
    for (const Image &image : images)
        channels.push_back(compared_channels(image, images[0]));
    for (std::size_t c = 0; c < channels[0].size(); ++c) {
        Channel channel{channels[0][c]->name, std::vector<float>(channels[0][c]->values.size())};
        for (std::size_t i = 0; i < channel.values.size(); ++i) {
            double sum = 0;
            for (const auto &of_image : channels)
                sum += of_image[c]->values[i];
            channel.values[i] = static_cast<float>(sum / double(images.size()));
        }
        mean.channels.push_back(std::move(channel));
    }
    return mean;
}

std::uint64_t count_non_finite(const Image &image) {
    std::uint64_t count = 0;
    for (const Channel *channel : compared_channels(image, image))
        for (const float value : channel->values)
            count += std::isfinite(value) ? 0 : 1;
    return count;
}

Image select_layer(const Image &image, const std::string &layer) {
    Image result;
    result.width = image.width;
    result.height = image.height;
    result.metadata = image.metadata;
    result.origin = image.origin;
    std::set<std::string> layers;
    for (const Channel &channel : image.channels) {
        const std::size_t dot = channel.name.rfind('.');
        if (dot == std::string::npos)
            continue;
        layers.insert(channel.name.substr(0, dot));
        if (channel.name.substr(0, dot) == layer)
            result.channels.push_back({channel.name.substr(dot + 1), channel.values});
    }
    if (result.channels.empty())
        fail(fmt::format("an image has no layer '{}'; it has {}", layer,
                         layers.empty() ? "none" : fmt::format("{}", fmt::join(layers, ", "))));
    return result;
}

} // namespace gradus
