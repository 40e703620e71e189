#include "methods/error_layer.h"

#include "runtime/error.h"
#include "runtime/film/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

namespace {

/// Pixels, of the Gaussian weights of neighbours, up to three of them far. Wider ones know better what is alike around
/// them, narrower ones what is not; of a bias, which is the difference of larger numbers, more must be known.
constexpr double of_variance = 2, of_bias = 6;

/// Weighted means over neighbours, of those values that are finite; NaN where none is.
class Neighbourhood {
  public:
    Neighbourhood(std::uint32_t width, std::uint32_t height, double size)
        : width_(width), height_(height), reach_(std::lround(3 * size)) {
        for (std::ptrdiff_t d = -reach_; d <= reach_; ++d)
            taps_.push_back(std::exp(-0.5 * double(d * d) / (size * size)));
    }

    /// And their standard errors, as the spread around zero tells them, where `errors` are asked for.
    std::vector<double> means(std::vector<double> values, std::vector<double> *errors = nullptr) const {
        std::vector<double> area(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            area[i] = std::isfinite(values[i]) ? 1 : 0;
            values[i] = area[i] > 0 ? values[i] : 0;
        }
        std::vector<double> result = sums(values, taps_);
        area = sums(area, taps_);
        if (errors) {
            std::vector<double> squares = taps_;
            for (double &tap : squares)
                tap *= tap;
            for (double &value : values)
                value *= value;
            *errors = sums(values, squares);
            for (std::size_t i = 0; i < area.size(); ++i)
                (*errors)[i] = std::sqrt((*errors)[i]) / area[i];
        }
        for (std::size_t i = 0; i < area.size(); ++i)
            result[i] /= area[i]; // 0 / 0 is NaN
        return result;
    }

  private:
    /// Along rows, then along columns.
    std::vector<double> sums(const std::vector<double> &values, const std::vector<double> &taps) const {
        std::vector<double> across(values.size(), 0.0), all(values.size(), 0.0);
        for (std::ptrdiff_t y = 0; y < height_; ++y)
            for (std::ptrdiff_t d = -reach_; d <= reach_; ++d)
                for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(0, -d); x < std::min(width_, width_ - d); ++x)
                    across[y * width_ + x] += taps[d + reach_] * values[y * width_ + x + d];
        for (std::ptrdiff_t y = 0; y < height_; ++y)
            for (std::ptrdiff_t d = std::max(-reach_, -y); d <= std::min(reach_, height_ - 1 - y); ++d)
                for (std::ptrdiff_t x = 0; x < width_; ++x)
                    all[y * width_ + x] += taps[d + reach_] * across[(y + d) * width_ + x];
        return all;
    }

    std::ptrdiff_t width_, height_, reach_;
    std::vector<double> taps_;
};

} // namespace

void check_error(const RenderOptions &options, const char *method) {
    if (options.error)
        throw Error(ExitCode::usage,
                    fmt::format("--error and --until-error are of pt and gpt: of {} halves of the samples do not tell "
                                "what the radius adds",
                                method));
}

std::optional<double> add_error_layer(Image &image, const SquaredErrors &errors) {
    const std::size_t pixels = std::size_t(image.width) * image.height;
    const Neighbourhood near(image.width, image.height, of_variance), wide(image.width, image.height, of_bias);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float> &values = image.channels[c].values;
        // A firefly that were its own reference would weigh little.
        const std::vector<double> weights =
            relative_weights(std::vector<double>(values.begin(), values.end()), image.width, image.height);
        const auto plane = errors.variance.begin() + std::ptrdiff_t(c * pixels);
        const std::vector<double> variance = near.means(std::vector<double>(plane, plane + std::ptrdiff_t(pixels)));
        // Relative, so that what is bright does not decide for what is dark beside it. A bias that is less than one
        // standard error counts as that: nobody knows that it is less.
        std::vector<double> bias(pixels, 0.0), unsure(pixels, 0.0);
        if (!errors.bias.empty()) {
            for (std::size_t i = 0; i < pixels; ++i)
                bias[i] = weights[i] * errors.bias[c * pixels + i];
            bias = wide.means(std::move(bias), &unsure);
        }
        Channel layer{std::string("error.") + "RGB"[c], std::vector<float>(pixels)};
        for (std::size_t i = 0; i < pixels; ++i) {
            const double least = std::max(bias[i], unsure[i]), raw = plane[std::ptrdiff_t(i)];
            if (!std::isfinite(variance[i]) || !std::isfinite(least))
                continue;
            layer.values[i] = float(std::sqrt(variance[i] + least / weights[i]));
            // By sum no neighbours are needed.
            sum += weights[i] * (std::isfinite(raw) ? raw : variance[i]) + least;
            ++count;
        }
        image.channels.push_back(std::move(layer));
    }
    if (count == 0)
        return std::nullopt;
    return sum / double(count);
}

} // namespace gradus
