#include "runtime/wavefront/film.h"

#include "kernels/shared/tables.h"
#include "runtime/film/replicates.h"
#include "runtime/wavefront/host_table.h"
#include "runtime/wavefront/sample_parts.h"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {

/// What a table of samples or of splats has of a pixel, for one of R, G and B.
double film_sum(const HostTable &table, int color, std::size_t pixel) {
    return table.real(film_sum_r + color, pixel) + table.real(film_correction_r + color, pixel);
}

/// The sums of all parts, on the host, and how many samples they are of. Pixels are those that are sampled.
class FilmSums {
  public:
    FilmSums(const Tables &tables, std::uint32_t parts, std::size_t pixels, std::uint64_t samples)
        : pixels_(pixels), samples_(samples) {
        for (std::uint32_t part = 0; part < parts; ++part)
            films_.emplace_back(tables[name_of_part("film", part)], pixels, tables.precision());
    }

    double samples_of(std::size_t pixel) const { return double(samples_ / pixels_) + (has_more(pixel) ? 1 : 0); }
    std::uint32_t rejected(std::size_t pixel) const {
        std::uint32_t rejected = 0;
        for (const HostTable &film : films_)
            rejected += film.uint(film_rejected, pixel);
        return rejected;
    }
    /// What parts have of a pixel, for one of R, G and B: `step` apart, from `first` on.
    Replicate sum(int color, std::size_t pixel, std::uint32_t first = 0, std::uint32_t step = 1) const {
        Replicate all;
        for (std::uint32_t part = first; part < films_.size(); part += step) {
            const Replicate one = part_of(color, pixel, part);
            all.sum += one.sum;
            all.count += one.count;
        }
        return all;
    }
    double variance(int color, std::size_t pixel) const {
        std::array<Replicate, 1 << replicate_bits> replicates;
        for (std::uint32_t part = 0; part < films_.size(); ++part)
            replicates[part] = part_of(color, pixel, part);
        return variance_of_mean(replicates);
    }
    /// The same of samples that are independent, from their squared deviations from the means of their parts, summed.
    double variance_of_samples(double deviations, int color, std::size_t pixel) const {
        Replicate all;
        for (std::uint32_t part = 0; part < films_.size(); ++part) {
            const Replicate one = part_of(color, pixel, part);
            // Chan et al. 1983: those from the mean of both.
            if (all.count > 0 && one.count > 0)
                deviations += std::pow(one.sum * all.count - all.sum * one.count, 2) /
                              (one.count * all.count * (one.count + all.count));
            all.sum += one.sum;
            all.count += one.count;
        }
        return all.count > 1 ? deviations / (all.count * (all.count - 1)) : 0;
    }

  private:
    bool has_more(std::size_t pixel) const { return pixel < samples_ % pixels_; }
    Replicate part_of(int color, std::size_t pixel, std::uint32_t part) const {
        const auto parts = static_cast<std::uint32_t>(films_.size());
        const auto count = double(count_of_part(samples_ / pixels_ + (has_more(pixel) ? 1 : 0), part, parts));
        return {film_sum(films_[part], color, pixel), count - films_[part].uint(film_rejected, pixel)};
    }
    std::deque<HostTable> films_;
    std::size_t pixels_;
    std::uint64_t samples_;
};

std::vector<std::string> numbers_of_launch(const Session &session) {
    if (session.has_frame())
        return {"first_pixel", "samples_before", "film_samples_before", "filter_x", "filter_y"};
    return {"first_slot", "first_pixel", "samples_before", "film_samples_before"};
}

double mean_of(const Replicate &all) { return all.count > 0 ? all.sum / all.count : 0.0; }

} // namespace

Film::Film(Session &session, Stages &stages, bool halves)
    : session_(session),
      frame_(stages.add({.name = "frame", .is_wanted = session.has_frame(), .numbers = {"first_slot", "first_pixel"}})),
      accumulate_(stages.add({.name = "accumulate", .strict = true, .numbers = numbers_of_launch(session)})),
      parts_(1u << part_bits(session.options, halves)) {}

std::vector<std::string> Film::table_names() const {
    std::vector<std::string> names;
    for (std::uint32_t part = 0; part < parts_; ++part)
        names.push_back(name_of_part("film", part));
    names.emplace_back("feature_film");
    return names;
}

TableList Film::tables() const {
    const bool aov = session_.has("TRAIT_AOV");
    const int feature_sums =
        has_replicates() ? feature_film_deviation_r : feature_film_columns; // deviations are the last
    const auto with_aov = [&](int columns) { return aov ? std::uint32_t(columns) : 0u; };
    TableList list = {{.name = "radiance", .rows = RowsOf::slot, .columns = radiance_columns},
                      {.name = "feature", .rows = RowsOf::slot, .columns = with_aov(feature_columns)},
                      {.name = "frame",
                       .rows = RowsOf::pixel,
                       .columns = session_.has_frame() ? std::uint32_t(aov ? frame_columns : frame_albedo_r) : 0u},
                      {.name = "feature_film", .rows = RowsOf::pixel, .columns = with_aov(feature_sums)}};
    for (std::uint32_t part = 0; part < parts_; ++part)
        list.push_back({.name = name_of_part("film", part), .rows = RowsOf::pixel, .columns = film_columns});
    return list;
}

void Film::attach(Tables &tables) {
    tables_ = &tables;
    clear();
}

void Film::clear(std::uint64_t first_sample) {
    first_sample_ = first_sample;
    std::vector<std::string> names = table_names();
    names.emplace_back("splat_film");
    for (const std::string &name : names)
        if (tables_->has(name))
            (*tables_)[name].clear();
}

void Film::clear_slots() {
    for (const char *table : {"radiance", "feature"})
        if (tables_->has(table))
            (*tables_)[table].clear();
}

void Film::add(std::uint32_t count, std::uint32_t first_pixel, std::uint64_t first_sample) {
    // One launch a sample of each pixel: within a launch no pixel occurs twice, and their rows lie side by side.
    std::uint32_t done = 0;
    for (std::uint32_t slot = 0; slot < count; slot += done, first_pixel = 0, ++first_sample) {
        done = std::min(session_.pixels() - first_pixel, count - slot);
        if (parts_ > 1)
            accumulate_.bind("film",
                             (*tables_)[name_of_part("film", static_cast<std::uint32_t>(first_sample % parts_))]);
        const auto before = static_cast<std::uint32_t>(first_sample - first_sample_), of_film = before / parts_;
        if (!session_.has_frame()) {
            accumulate_.run(done, {{"first_slot", slot},
                                   {"first_pixel", first_pixel},
                                   {"samples_before", before},
                                   {"film_samples_before", of_film}});
            continue;
        }
        frame_.run(done, {{"first_slot", slot}, {"first_pixel", first_pixel}});
        const Range filtered = filtered_pixels(session_, {first_pixel, done});
        const FramePlace place = place_of(first_sample);
        accumulate_.run(filtered.count, {{"first_pixel", filtered.first},
                                         {"samples_before", before},
                                         {"film_samples_before", of_film},
                                         {"filter_x", place.x},
                                         {"filter_y", place.y}});
    }
}

Image Film::image(std::uint64_t samples, std::uint64_t &non_finite, std::uint64_t light_paths) const {
    const std::size_t count = session_.image_pixels(), sampled = session_.pixels();
    const FilmSums films(*tables_, parts_, sampled, session_.filtered_samples(samples));
    std::optional<HostTable> splats;
    if (light_paths > 0 && tables_->has("splat_film"))
        splats.emplace((*tables_)["splat_film"], sampled, tables_->precision());
    Image image;
    image.width = session_.film.crop_width;
    image.height = session_.film.crop_height;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t pixel = session_.sampled_pixel(i);
        non_finite += films.rejected(pixel) + (splats ? splats->uint(film_rejected, pixel) : 0);
    }
    const auto add = [&](const std::string &name, auto mean) {
        Channel channel{name, std::vector<float>(count)};
        for (std::size_t i = 0; i < count; ++i)
            channel.values[i] = static_cast<float>(mean(session_.sampled_pixel(i)));
        image.channels.push_back(std::move(channel));
    };
    const char *const colors[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
        add(colors[c], [&](std::size_t pixel) {
            const double mean = mean_of(films.sum(c, pixel));
            return splats ? mean + film_sum(*splats, c, pixel) / double(light_paths) : mean;
        });
    if (!session_.has("TRAIT_AOV"))
        return image;

    const HostTable features((*tables_)["feature_film"], sampled, tables_->precision());
    const char *const axes[3] = {"X", "Y", "Z"};
    // The film has their mean over all samples; those that were left out do not count.
    const auto mean_feature = [&](int column, std::size_t pixel) {
        return mean_of({features.real(column, pixel) * films.samples_of(pixel), films.sum(0, pixel).count});
    };
    for (int c = 0; c < 3; ++c)
        add(std::string("albedo.") + colors[c],
            [&](std::size_t pixel) { return mean_feature(feature_film_albedo_r + c, pixel); });
    for (int c = 0; c < 3; ++c)
        add(std::string("normal.") + axes[c],
            [&](std::size_t pixel) { return mean_feature(feature_film_normal_x + c, pixel); });
    add("depth.Z", [&](std::size_t pixel) { return mean_feature(feature_film_depth, pixel); });
    if (!tells_variance(session_.options))
        return image;
    // The variance of the pixel's mean.
    for (int c = 0; c < 3; ++c)
        add(std::string("variance.") + colors[c], [&](std::size_t pixel) {
            if (has_replicates())
                return films.variance(c, pixel);
            return films.variance_of_samples(features.real(feature_film_deviation_r + c, pixel), c, pixel);
        });
    return image;
}

void Film::half_mean(int half, std::uint64_t samples, int color, float *plane) const {
    const FilmSums films(*tables_, parts_, session_.pixels(), session_.filtered_samples(samples));
    for (std::size_t i = 0; i < session_.image_pixels(); ++i)
        plane[i] = static_cast<float>(
            mean_of(films.sum(color, session_.sampled_pixel(i), static_cast<std::uint32_t>(half), 2)));
}

} // namespace gradus
