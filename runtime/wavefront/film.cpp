#include "runtime/wavefront/film.h"

#include "kernels/shared/tables.h"
#include "runtime/wavefront/host_table.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace gradus {

using namespace lib_float;

namespace {

/// What a table of samples or of splats has of a pixel, for one of R, G and B.
double film_sum(const HostTable &table, int color, std::size_t pixel) {
    return table.real(film_sum_r + color, pixel) + table.real(film_correction_r + color, pixel);
}

} // namespace

Film::Film(Session &session, Stages &stages, bool halves)
    : session_(session),
      accumulate_(stages.add({.name = "accumulate", .strict = true, .numbers = {"first_slot", "first_pixel"}})),
      halves_(halves) {}

TableList Film::tables() const {
    const bool aov = session_.has("TRAIT_AOV");
    const auto with_aov = [&](int columns) { return aov ? std::uint32_t(columns) : 0u; };
    return {{.name = "radiance", .rows = RowsOf::slot, .columns = radiance_columns},
            {.name = "filtered", .rows = RowsOf::slot, .columns = session_.has("TRAIT_FILTER_SIGNED") ? 1u : 0u},
            {.name = "feature", .rows = RowsOf::slot, .columns = with_aov(feature_columns)},
            {.name = "film", .rows = RowsOf::pixel, .columns = film_columns},
            {.name = "odd_film", .rows = RowsOf::pixel, .columns = halves_ ? std::uint32_t(film_columns) : 0u},
            {.name = "feature_film", .rows = RowsOf::pixel, .columns = with_aov(feature_film_columns)}};
}

void Film::attach(Tables &tables) {
    tables_ = &tables;
    clear();
}

void Film::clear() {
    for (const char *name : {"film", "odd_film", "feature_film", "splat_film"})
        if (tables_->has(name))
            (*tables_)[name].clear();
}

void Film::add(std::uint32_t count, std::uint32_t first_pixel, std::uint64_t first_sample) {
    // One launch a sample of each pixel: within a launch no pixel occurs twice, and their rows lie side by side.
    std::uint32_t done = 0;
    for (std::uint32_t slot = 0; slot < count; slot += done, first_pixel = 0, ++first_sample) {
        done = std::min(session_.pixels() - first_pixel, count - slot);
        if (halves_)
            accumulate_.bind("film", (*tables_)[first_sample % 2 == 0 ? "film" : "odd_film"]);
        accumulate_.run(done, {{"first_slot", slot}, {"first_pixel", first_pixel}});
    }
}

Image Film::image(std::uint64_t samples, std::uint64_t &non_finite, std::uint64_t light_paths) const {
    const std::size_t count = session_.pixels();
    const HostTable film((*tables_)["film"], count, tables_->precision());
    std::optional<HostTable> odd, splats;
    if (halves_)
        odd.emplace((*tables_)["odd_film"], count, tables_->precision());
    if (light_paths > 0 && tables_->has("splat_film"))
        splats.emplace((*tables_)["splat_film"], count, tables_->precision());
    Image image;
    image.width = session_.film.crop_width;
    image.height = session_.film.crop_height;
    const auto rejected = [&](std::size_t pixel) {
        return film.uint(film_rejected, pixel) + (odd ? odd->uint(film_rejected, pixel) : 0);
    };
    for (std::size_t pixel = 0; pixel < count; ++pixel)
        non_finite += rejected(pixel) + (splats ? splats->uint(film_rejected, pixel) : 0);
    const std::uint64_t of_all = samples / count, with_one_more = samples % count;
    const auto taken = [&](std::size_t pixel) {
        return double(of_all + (pixel < with_one_more ? 1 : 0)) - rejected(pixel);
    };
    const auto add = [&](const std::string &name, auto mean) {
        Channel channel{name, std::vector<float>(count)};
        for (std::size_t pixel = 0; pixel < count; ++pixel)
            channel.values[pixel] = static_cast<float>(mean(pixel));
        image.channels.push_back(std::move(channel));
    };
    const auto over_taken = [&](double sum, std::size_t pixel) { return taken(pixel) > 0 ? sum / taken(pixel) : 0.0; };
    const auto mean_color = [&](int channel, std::size_t pixel) {
        return over_taken(film_sum(film, channel, pixel) + (odd ? film_sum(*odd, channel, pixel) : 0.0), pixel);
    };
    const char *const colors[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
        add(colors[c], [&](std::size_t pixel) {
            const double mean = mean_color(c, pixel);
            return splats ? mean + film_sum(*splats, c, pixel) / double(light_paths) : mean;
        });
    if (!session_.has("TRAIT_AOV"))
        return image;

    const HostTable features((*tables_)["feature_film"], count, tables_->precision());
    const char *const axes[3] = {"X", "Y", "Z"};
    const auto mean_feature = [&](int column, std::size_t pixel) {
        return over_taken(features.real(column, pixel), pixel);
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
            const double square = over_taken(features.real(feature_film_square_r + c, pixel) +
                                                 features.real(feature_film_square_correction_r + c, pixel),
                                             pixel);
            return taken(pixel) > 1 ? std::max(0.0, square - mean * mean) / (taken(pixel) - 1) : 0.0;
        });
    return image;
}

void Film::half_mean(int half, std::uint64_t samples, int color, float *plane) const {
    const std::size_t count = session_.pixels();
    const HostTable film((*tables_)[half == 0 ? "film" : "odd_film"], count, tables_->precision());
    for (std::size_t pixel = 0; pixel < count; ++pixel) {
        const std::uint64_t all = samples / count + (pixel < samples % count ? 1 : 0);
        const double taken = double((all + (half == 0 ? 1 : 0)) / 2) - film.uint(film_rejected, pixel);
        plane[pixel] = static_cast<float>(taken > 0 ? film_sum(film, color, pixel) / taken : 0.0);
    }
}

} // namespace gradus
