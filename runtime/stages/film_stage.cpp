#include "runtime/stages/film_stage.h"

#include "kernels/shared/tables.h"
#include "runtime/stages/host_table.h"

#include <algorithm>
#include <cmath>

namespace gradus {

using namespace lib_float;

KernelRequest FilmStage::request() { return {"accumulate", "kernels/stages/accumulate.cl", "accumulate", {}, true}; }

FilmStage::FilmStage(Device &device, Kernel kernel, const BatchTables &tables, std::uint32_t width,
                     std::uint32_t height, const TraitMap &traits, Precision precision)
    : kernel_(kernel), width_(width), height_(height), aov_(traits.at("TRAIT_AOV") != 0), precision_(precision) {
    const std::size_t column = real_bytes(precision) * width * height;
    film_ = Buffer(device, "film", column * film_columns);
    feature_film_ = Buffer(device, "feature_film", aov_ ? column * feature_film_columns : 0);
    clear();
    for (const Buffer &buffer : {tables.radiance, tables.feature, film_, feature_film_})
        kernel_.bind(buffer);
    kernel_.set("slots", tables.slots);
    kernel_.set("pixels", width * height);
}

void FilmStage::clear() {
    film_.clear();
    feature_film_.clear();
}

void FilmStage::accumulate(std::uint32_t count, std::uint32_t first_pixel) {
    // One launch a sample of each pixel: within a launch no pixel occurs twice.
    for (std::uint32_t slot = 0; slot < count; slot += pixels()) {
        const std::uint32_t part = std::min(pixels(), count - slot);
        kernel_.set("count", part);
        kernel_.set("first_slot", slot);
        kernel_.set("first_pixel", first_pixel);
        kernel_.launch(part);
    }
}

Image FilmStage::image(std::uint64_t samples, std::uint64_t &non_finite) const {
    const std::size_t count = pixels();
    const HostTable film(film_, count, precision_);
    Image image;
    image.width = width_;
    image.height = height_;
    for (std::size_t pixel = 0; pixel < count; ++pixel)
        non_finite += film.uint(film_rejected, pixel);
    const std::uint64_t of_all = samples / count, with_one_more = samples % count;
    const auto taken = [&](std::size_t pixel) {
        return double(of_all + (pixel < with_one_more ? 1 : 0)) - film.uint(film_rejected, pixel);
    };
    const auto add = [&](const std::string &name, auto mean) {
        Channel channel{name, std::vector<float>(count)};
        for (std::size_t pixel = 0; pixel < count; ++pixel)
            channel.values[pixel] = taken(pixel) > 0 ? static_cast<float>(mean(pixel)) : 0.0f;
        image.channels.push_back(std::move(channel));
    };
    const auto mean_color = [&](int channel, std::size_t pixel) {
        return (film.real(film_sum_r + channel, pixel) + film.real(film_correction_r + channel, pixel)) / taken(pixel);
    };
    const char *const colors[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
        add(colors[c], [&](std::size_t pixel) { return mean_color(c, pixel); });
    if (!aov_)
        return image;

    const HostTable features(feature_film_, count, precision_);
    const char *const axes[3] = {"X", "Y", "Z"};
    const auto mean_feature = [&](int column, std::size_t pixel) {
        return features.real(column, pixel) / taken(pixel);
    };
    for (int c = 0; c < 3; ++c)
        add(std::string("albedo.") + colors[c],
            [&](std::size_t pixel) { return mean_feature(feature_film_albedo_r + c, pixel); });
    for (int c = 0; c < 3; ++c)
        add(std::string("normal.") + axes[c],
            [&](std::size_t pixel) { return mean_feature(feature_film_normal_x + c, pixel); });
    add("depth.Z", [&](std::size_t pixel) { return mean_feature(feature_film_depth, pixel); });
    // The variance of the pixel's mean, without bias: (mean of squares - square of mean) / (n - 1).
    for (int c = 0; c < 3; ++c)
        add(std::string("variance.") + colors[c], [&](std::size_t pixel) {
            const double mean = mean_color(c, pixel);
            const double square = (features.real(feature_film_square_r + c, pixel) +
                                   features.real(feature_film_square_correction_r + c, pixel)) /
                                  taken(pixel);
            return taken(pixel) > 1 ? std::max(0.0, square - mean * mean) / (taken(pixel) - 1) : 0.0;
        });
    return image;
}

} // namespace gradus
