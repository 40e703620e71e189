// The feature filter and the judging of guides, pixel by pixel in double precision, as their headers describe them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gradus::testing {

/// Planes of an image: (c * height + y) * width + x.
struct GuideImage {
    int width = 0, height = 0;
    std::vector<float> values;

    GuideImage() = default;
    GuideImage(int width, int height, int channels = 3, float value = 0)
        : width(width), height(height), values(std::size_t(width) * height * channels, value) {}
    float &at(int c, int x, int y) { return values[(std::size_t(c) * height + y) * width + x]; }
    float at(int c, int x, int y) const { return values[(std::size_t(c) * height + y) * width + x]; }
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
    bool is_finite(int x, int y) const {
        return std::isfinite(at(0, x, y)) && std::isfinite(at(1, x, y)) && std::isfinite(at(2, x, y));
    }
};

using GuideHalves = std::array<GuideImage, 2>;

class GuideReference {
  public:
    GuideReference(const GuideHalves &halves, double share)
        : halves_(halves), p_(share), width_(halves[0].width), height_(halves[0].height) {
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const double bright = smoothed_brightness(x, y);
                double sum = 0;
                for (int c = 0; c < 3; ++c) {
                    const double raw = smoothed_variance(c, x, y);
                    variances_.push_back(raw + 1e-6 * bright + 1e-30);
                    sum += raw / 3;
                }
                trusts_.push_back(1 / std::sqrt(sum + 1e-4 * bright + 1e-30));
            }
    }

    GuideHalves filtered(const GuideImage &features) const {
        GuideHalves result{GuideImage(width_, height_), GuideImage(width_, height_)};
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                double weights = 0;
                std::array<std::array<double, 3>, 2> sums{};
                for (int v = y - 4; v <= y + 4; ++v)
                    for (int u = x - 4; u <= x + 4; ++u) {
                        if (!halves_[0].inside(u, v) || !counts(u, v))
                            continue;
                        const double weight =
                            trust(u, v) * std::exp(-(std::max(patch_distance(x, y, u - x, v - y), 0.0) +
                                                     feature_distance(features, x, y, u, v)));
                        weights += weight;
                        for (int h = 0; h < 2; ++h)
                            for (int c = 0; c < 3; ++c)
                                sums[h][c] += weight * halves_[h].at(c, u, v);
                    }
                for (int h = 0; h < 2; ++h)
                    for (int c = 0; c < 3; ++c)
                        result[h].at(c, x, y) = float(weights > 0 ? sums[h][c] / weights : 0);
            }
        return result;
    }

    GuideImage judged(const GuideHalves &guides) const {
        double brightness = 0;
        for (const float value : guides[0].values)
            brightness += std::isfinite(value) ? std::abs(value) : 0;
        brightness /= double(guides[0].values.size());
        const double least = std::max(0.01 * brightness * brightness, 1e-30);
        std::vector<double> share(std::size_t(width_) * height_);
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                share[std::size_t(y) * width_ + x] = share_at(guides, x, y, least);
        GuideImage result(width_, height_);
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                double sum = 0, area = 0;
                for (int v = -3; v <= 3; ++v)
                    for (int u = -3; u <= 3; ++u)
                        if (halves_[0].inside(x + u, y + v) && all_there(guides, x + u, y + v)) {
                            const double tap = std::exp(-0.5 * (u * u + v * v));
                            sum += tap * share[std::size_t(y + v) * width_ + x + u];
                            area += tap;
                        }
                const bool image = counts(x, y), guide = guides[0].is_finite(x, y) && guides[1].is_finite(x, y);
                const double part = !guide ? 0 : !image ? 1 : area > 0 ? sum / area : 0;
                for (int c = 0; c < 3; ++c) {
                    const double own = image ? mean(halves_, c, x, y) : 0, other = guide ? mean(guides, c, x, y) : 0;
                    result.at(c, x, y) = float(own + part * (other - own));
                }
            }
        return result;
    }

    double mean(const GuideHalves &of, int c, int x, int y) const {
        return p_ * of[0].at(c, x, y) + (1 - p_) * of[1].at(c, x, y);
    }

  private:
    bool counts(int x, int y) const { return halves_[0].is_finite(x, y) && halves_[1].is_finite(x, y); }
    bool all_there(const GuideHalves &guides, int x, int y) const {
        return counts(x, y) && guides[0].is_finite(x, y) && guides[1].is_finite(x, y);
    }

    /// The mean nearby of what `of` says of a pixel that counts.
    template <class Of>
    double smoothed(int x, int y, Of of) const {
        double sum = 0, area = 0;
        for (int v = y - 3; v <= y + 3; ++v)
            for (int u = x - 3; u <= x + 3; ++u)
                if (halves_[0].inside(u, v) && counts(u, v)) {
                    const double tap = std::exp(-0.5 * ((u - x) * (u - x) + (v - y) * (v - y)));
                    sum += tap * of(u, v);
                    area += tap;
                }
        return area > 0 ? sum / area : 0;
    }
    double smoothed_brightness(int x, int y) const {
        return smoothed(x, y, [&](int u, int v) {
            double sum = 0;
            for (int c = 0; c < 3; ++c)
                sum += mean(halves_, c, u, v) * mean(halves_, c, u, v) / 3;
            return sum;
        });
    }
    double smoothed_variance(int c, int x, int y) const {
        return smoothed(x, y, [&](int u, int v) {
            const double d = double(halves_[0].at(c, u, v)) - halves_[1].at(c, u, v);
            return p_ * (1 - p_) * d * d;
        });
    }
    double variance(int c, int x, int y) const { return variances_[3 * (std::size_t(y) * width_ + x) + c]; }
    double trust(int x, int y) const { return trusts_[std::size_t(y) * width_ + x]; }

    double patch_distance(int x, int y, int dx, int dy) const {
        double sum = 0;
        int count = 0;
        for (int v = y - 1; v <= y + 1; ++v)
            for (int u = x - 1; u <= x + 1; ++u) {
                if (!halves_[0].inside(u, v) || !halves_[0].inside(u + dx, v + dy))
                    continue;
                ++count; // what is missing is no different
                if (!counts(u, v) || !counts(u + dx, v + dy))
                    continue;
                for (int c = 0; c < 3; ++c) {
                    const double d = mean(halves_, c, u, v) - mean(halves_, c, u + dx, v + dy);
                    const double a = variance(c, u, v), b = variance(c, u + dx, v + dy);
                    sum += std::min((d * d - (a + std::min(a, b))) / (a + b), 1e4) / 3;
                }
            }
        return sum / count;
    }
    static double feature_distance(const GuideImage &features, int x, int y, int u, int v) {
        double most = 0;
        for (int c = 0; c < 7; ++c) {
            const auto value = [&](int i, int j) {
                const double given = features.at(c, i, j), finite = std::isfinite(given) ? given : 0;
                const double unit = c < 3 ? 0.07 : c < 6 ? 0.4 : 0.07;
                return (c < 6 ? finite : std::log(std::clamp(finite, 1e-6, 1e30))) / unit;
            };
            const double d = value(x, y) - value(u, v);
            most = std::max(most, d * d);
        }
        return most;
    }

    /// Of one pixel: gain and loss relative to its squared brightness.
    std::array<double, 2> moments(const GuideHalves &guides, int x, int y, double least) const {
        double gain = 0, apart = 0, bright = 0;
        for (int c = 0; c < 3; ++c) {
            const double noise = double(halves_[0].at(c, x, y)) - halves_[1].at(c, x, y);
            const double noise_of_guide = double(guides[0].at(c, x, y)) - guides[1].at(c, x, y);
            gain += p_ * (1 - p_) * noise * (noise - noise_of_guide);
            const double d = mean(guides, c, x, y) - mean(halves_, c, x, y);
            apart += d * d;
            bright += mean(guides, c, x, y) / 3;
        }
        const double scale = 1 / (3 * (bright * bright + least));
        return {scale * gain, scale * (apart - gain)};
    }
    double share_at(const GuideHalves &guides, int x, int y, double least) const {
        double gain = 0, loss = 0, square = 0;
        for (int v = y - 9; v <= y + 9; ++v)
            for (int u = x - 9; u <= x + 9; ++u)
                if (halves_[0].inside(u, v) && all_there(guides, u, v)) {
                    const double tap = std::exp(-((u - x) * (u - x) + (v - y) * (v - y)) / 18.0);
                    const auto [of_gain, of_loss] = moments(guides, u, v, least);
                    gain += tap * of_gain;
                    loss += tap * of_loss;
                    square += tap * of_loss * of_loss;
                }
        gain = std::max(gain, 0.0);
        loss = std::max(loss - std::sqrt(square / 2), 0.0);
        return gain + loss > 0 ? gain / (gain + loss) : 0;
    }

    const GuideHalves &halves_;
    const double p_;
    const int width_, height_;
    std::vector<double> variances_, trusts_;
};

} // namespace gradus::testing
