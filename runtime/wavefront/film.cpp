#include "runtime/wavefront/film.h"

#include "kernels/shared/tables.h"
#include "runtime/film/replicates.h"
#include "runtime/wavefront/host_table.h"
#include "runtime/wavefront/sample_parts.h"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>

namespace gradus {

using namespace lib_float;

namespace {

/// What a table of samples or of splats has of a pixel, for one of R, G and B.
double film_sum(const HostTable &table, int color, std::size_t pixel) {
    return table.real(film_sum_r + color, pixel) + table.real(film_correction_r + color, pixel);
}

/// The sums of all parts, on the host, and how many samples they are of.
class FilmSums {
  public:
    FilmSums(const Tables &tables, std::uint32_t parts, std::size_t pixels, std::uint64_t samples,
             const SharedWeights &weights)
        : pixels_(pixels), samples_(samples) {
        const std::uint64_t frames = samples / pixels;
        for (std::uint32_t part = 0; part < parts; ++part) {
            films_.emplace_back(tables[name_of_part("film", part)], pixels, tables.precision());
            for (const std::uint64_t more : {0, 1})
                weights_[more].push_back(weights.of_samples(frames + more, part, parts));
        }
    }

    double samples_of(std::size_t pixel) const { return double(samples_ / pixels_) + (has_more(pixel) ? 1 : 0); }
    std::uint32_t rejected(std::size_t pixel) const {
        std::uint32_t rejected = 0;
        for (std::uint32_t part = 0; part < films_.size(); ++part)
            rejected += rejected_of(part, pixel);
        return rejected;
    }
    /// What parts have of a pixel, for one of R, G and B: `step` apart, from `first` on. Counts are what samples weigh.
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
    /// The same of samples that are independent and weigh 1, from the sum of their squares: (mean of squares - square
    /// of mean) / (n - 1).
    double variance_of_samples(double square, int color, std::size_t pixel) const {
        const Replicate all = sum(color, pixel);
        const double n = all.count;
        return n > 1 ? std::max(0.0, square - all.sum * all.sum / n) / (n * (n - 1)) : 0;
    }
    /// The same of samples that weigh other than 1, from the sum of the squared deviations that all parts have.
    double variance_of_weighted_samples(double deviations, int color, std::size_t pixel) const {
        double sum_before = 0;
        SampleWeights before;
        for (std::uint32_t part = 0; part < films_.size(); ++part) {
            const double count = count_of(part, pixel), kept = count - rejected_of(part, pixel);
            if (kept <= 0)
                continue;
            SampleWeights here = weights_of(part, pixel);
            for (double *weight : {&here.of_mean, &here.squares, &here.of_deviations})
                *weight *= kept / count;
            const double sum = film_sum(films_[part], color, pixel);
            const double off = sum * before.of_mean - sum_before * here.of_mean;
            if (const double apart = before.apart(here); apart > 0)
                deviations += off * off / apart;
            before.add(here);
            sum_before += sum;
        }
        const double count = sum(color, pixel).count;
        return before.of_deviations > 0 ? deviations * before.squares / (before.of_deviations * count * count) : 0;
    }

  private:
    std::uint32_t rejected_of(std::uint32_t part, std::size_t pixel) const {
        return films_[part].uint(film_rejected, pixel);
    }
    const SampleWeights &weights_of(std::uint32_t part, std::size_t pixel) const {
        return weights_[has_more(pixel) ? 1 : 0][part];
    }
    bool has_more(std::size_t pixel) const { return pixel < samples_ % pixels_; }
    /// Samples, those that were rejected too.
    double count_of(std::uint32_t part, std::size_t pixel) const {
        const auto parts = static_cast<std::uint32_t>(films_.size());
        return double(count_of_part(samples_ / pixels_ + (has_more(pixel) ? 1 : 0), part, parts));
    }
    Replicate part_of(int color, std::size_t pixel, std::uint32_t part) const {
        const double count = count_of(part, pixel), of_one = count > 0 ? weights_of(part, pixel).of_mean / count : 1;
        return {film_sum(films_[part], color, pixel), of_one * (count - rejected_of(part, pixel))};
    }
    std::deque<HostTable> films_;
    std::array<std::vector<SampleWeights>, 2> weights_; ///< of each part, and with a frame more
    std::size_t pixels_;
    std::uint64_t samples_;
};

/// The arguments of accumulate that say what the samples before in a film weigh.
constexpr const char *film_samples_before = "film_samples_before", *weights_before = "weights_before",
                     *squares_before = "squares_before";

double mean_of(const Replicate &all) { return all.count > 0 ? all.sum / all.count : 0.0; }

} // namespace

Film::Film(Session &session, Stages &stages, bool halves)
    : session_(session), stages_(stages), weights_(session),
      accumulate_(stages.add(
          {.name = "accumulate", .strict = true, .numbers = {"first_slot", "first_pixel", "samples_before"}})),
      parts_(1u << part_bits(session.options, halves)) {
    for (const char *name : {film_samples_before, weights_before, squares_before})
        session.reals[name] = 0; // add() says them
}

std::vector<std::string> Film::table_names() const {
    std::vector<std::string> names;
    for (std::uint32_t part = 0; part < parts_; ++part)
        names.push_back(name_of_part("film", part));
    names.emplace_back("feature_film");
    return names;
}

TableList Film::tables() const {
    const bool aov = session_.has("TRAIT_AOV");
    const int feature_sums = has_replicates() ? feature_film_square_r : feature_film_columns; // squares are the last
    const auto with_aov = [&](int columns) { return aov ? std::uint32_t(columns) : 0u; };
    TableList list = {
        {.name = "radiance", .rows = RowsOf::slot, .columns = radiance_columns},
        {.name = "filtered", .rows = RowsOf::slot, .columns = session_.has("TRAIT_FILTER_SIGNED") ? 1u : 0u},
        {.name = "feature", .rows = RowsOf::slot, .columns = with_aov(feature_columns)},
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
    weights_.begin_at(first_sample);
    std::vector<std::string> names = table_names();
    names.emplace_back("splat_film");
    for (const std::string &name : names)
        if (tables_->has(name))
            (*tables_)[name].clear();
}

void Film::clear_slots() {
    for (const char *table : {"radiance", "feature", "filtered"})
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
        const std::uint64_t before = first_sample - first_sample_;
        if (weights_.are_there() && session_.has("TRAIT_AOV") && !has_replicates()) {
            const auto part = static_cast<std::uint32_t>(before % parts_);
            const SharedWeights::Sums weighed = weights_.sums(before, part, parts_);
            stages_.set_real(film_samples_before, double(count_of_part(before, part, parts_)));
            stages_.set_real(weights_before, weighed.weights);
            stages_.set_real(squares_before, weighed.squares);
        }
        accumulate_.run(done, {{"first_slot", slot},
                               {"first_pixel", first_pixel},
                               {"samples_before", static_cast<std::uint32_t>(before)}});
    }
}

Image Film::image(std::uint64_t samples, std::uint64_t &non_finite, std::uint64_t light_paths) const {
    const std::size_t count = session_.pixels();
    const FilmSums films(*tables_, parts_, count, samples, weights_);
    std::optional<HostTable> splats;
    if (light_paths > 0 && tables_->has("splat_film"))
        splats.emplace((*tables_)["splat_film"], count, tables_->precision());
    Image image;
    image.width = session_.film.crop_width;
    image.height = session_.film.crop_height;
    for (std::size_t pixel = 0; pixel < count; ++pixel)
        non_finite += films.rejected(pixel) + (splats ? splats->uint(film_rejected, pixel) : 0);
    const auto add = [&](const std::string &name, auto mean) {
        Channel channel{name, std::vector<float>(count)};
        for (std::size_t pixel = 0; pixel < count; ++pixel)
            channel.values[pixel] = static_cast<float>(mean(pixel));
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

    const HostTable features((*tables_)["feature_film"], count, tables_->precision());
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
            const double square = features.real(feature_film_square_r + c, pixel) +
                                  features.real(feature_film_square_correction_r + c, pixel);
            return weights_.are_there() ? films.variance_of_weighted_samples(square, c, pixel)
                                        : films.variance_of_samples(square, c, pixel);
        });
    return image;
}

void Film::half_mean(int half, std::uint64_t samples, int color, float *plane) const {
    const std::size_t count = session_.pixels();
    const FilmSums films(*tables_, parts_, count, samples, weights_);
    for (std::size_t pixel = 0; pixel < count; ++pixel)
        plane[pixel] = static_cast<float>(mean_of(films.sum(color, pixel, static_cast<std::uint32_t>(half), 2)));
}

} // namespace gradus
