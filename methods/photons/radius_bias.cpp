#include "methods/photons/radius_bias.h"

#include "kernels/shared/tables.h"
#include "runtime/film/metrics.h"
#include "runtime/wavefront/host_table.h"

#include <string>

namespace gradus {

using namespace lib_float;

namespace {

constexpr const char *colors[] = {"R", "G", "B"};

StageDeclaration sum_stage(const PhotonPairs &pairs, bool is_wanted) {
    StageDeclaration stage = pairs.sum_stage("bias_sum");
    stage.is_wanted = is_wanted;
    return stage;
}

/// Nothing where the image has no variance.
std::optional<double> relative_variance_of_passes(const Image &image) {
    Image variance;
    variance.width = image.width;
    variance.height = image.height;
    for (const char *color : colors) {
        const Channel *channel = image.find(std::string("variance.") + color);
        if (!channel || channel->values.empty())
            return std::nullopt;
        variance.channels.push_back({color, channel->values});
    }
    return relative_variance(variance, image);
}

} // namespace

void BiasEstimates::add_layer(Image &image) const {
    const std::size_t pixels = mean.size() / 3;
    for (std::size_t c = 0; c < 3; ++c) {
        Channel channel{std::string("bias.") + colors[c], std::vector<float>(pixels)};
        for (std::size_t pixel = 0; pixel < pixels; ++pixel)
            channel.values[pixel] = static_cast<float>(mean[c * pixels + pixel]);
        image.channels.push_back(std::move(channel));
    }
}

double BiasEstimates::relative_square(const Image &image) const {
    const std::size_t pixels = mean.size() / 3;
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float> &values = image.find(colors[c])->values;
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            const std::size_t i = c * pixels + pixel;
            sum += even[i] * odd[i] / (double(values[pixel]) * values[pixel] + relative_mse_epsilon);
        }
    }
    return sum / double(mean.size());
}

void add_pass_errors(const std::optional<BiasEstimates> &bias, Image &image, Statistics &statistics) {
    if (!bias || bias->has_halves) // one pass tells nothing of itself
        statistics.relative_variance = relative_variance_of_passes(image);
    if (!bias)
        return;
    bias->add_layer(image);
    if (bias->has_halves)
        statistics.relative_squared_bias = bias->relative_square(image);
}

RadiusBias::RadiusBias(Session &session, Stages &stages, const PhotonPairs &pairs, const RenderOptions &options,
                       bool by_slot)
    : session_(session), is_wanted_(options.aov || options.bias_layer), by_slot_(by_slot),
      sum_(stages.add(sum_stage(pairs, is_wanted_))),
      add_(stages.add({.name = "bias_add",
                       .definitions = {{"BY_SLOT", by_slot ? "1" : "0"}},
                       .is_wanted = is_wanted_,
                       .strict = true,
                       .numbers = {"first"}})),
      keep_(stages.add(
          {.name = "bias_keep", .is_wanted = is_wanted_, .strict = true, .numbers = {"first_pixel", "half_number"}})) {}

TableList RadiusBias::tables() const {
    if (!is_wanted_)
        return {};
    return {{.name = "gather_inner",
             .rows = by_slot_ ? RowsOf::slot : RowsOf::path,
             .columns = gather_inner_columns,
             .is_cleared = true},
            {.name = "slot_bias", .rows = RowsOf::slot, .columns = slot_bias_columns},
            {.name = "radius_bias", .rows = RowsOf::pixel, .multiple = 2, .columns = radius_bias_columns}};
}

void RadiusBias::attach(Tables &tables) {
    tables_ = &tables;
    if (is_wanted_)
        tables["radius_bias"].clear();
}

void RadiusBias::begin() {
    if (is_wanted_)
        (*tables_)["slot_bias"].clear(); // of slots without a gather point
}

void RadiusBias::sum(const PairWindow &window) {
    if (is_wanted_)
        PhotonPairs::sum(sum_, 1, window);
}

void RadiusBias::add(Range rows) { add_.run(rows.count, {{"first", rows.first}}); }

void RadiusBias::keep(std::uint32_t slots, std::uint32_t first_pixel, std::uint64_t pass) {
    keep_.run(slots, {{"first_pixel", first_pixel}, {"half_number", std::uint32_t(pass % 2)}});
}

std::optional<BiasEstimates> RadiusBias::estimates(std::uint64_t samples) const {
    if (!is_wanted_)
        return std::nullopt;
    const std::size_t pixels = session_.pixels();
    const HostTable table((*tables_)["radius_bias"], 2 * pixels, tables_->precision());
    const std::uint64_t of_all = samples / pixels, with_one_more = samples % pixels;
    BiasEstimates found;
    found.has_halves = of_all >= 2;
    const auto mean_of = [](double sum, std::uint64_t count) { return count > 0 ? sum / double(count) : 0.0; };
    std::vector<double> mean(pixels), of_even(pixels), of_odd(pixels);
    for (int color = 0; color < 3; ++color) {
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            const std::uint64_t passes = of_all + (pixel < with_one_more ? 1 : 0);
            const double even = table.real(radius_bias_value_r + color, pixel);
            const double odd = table.real(radius_bias_value_r + color, pixels + pixel);
            mean[pixel] = mean_of(even + odd, passes);
            of_even[pixel] = mean_of(even, (passes + 1) / 2);
            of_odd[pixel] = mean_of(odd, passes / 2);
        }
        add_filtered(mean, found.mean);
        add_filtered(of_even, found.even);
        add_filtered(of_odd, found.odd);
    }
    return found;
}

/// Adds the image's pixels of what each sampled pixel has, each with what the filter's samples have on average.
void RadiusBias::add_filtered(const std::vector<double> &sampled, std::vector<double> &image) const {
    const std::vector<double> none = {1.0};
    const std::vector<double> &taps = session_.has_frame() ? session_.scene.filter.mean_taps : none;
    const std::size_t width = session_.width();
    for (std::size_t i = 0; i < session_.image_pixels(); ++i) {
        double sum = 0;
        const std::size_t last = session_.sampled_pixel(i) + session_.filter_lag();
        for (std::size_t y = 0; y < taps.size(); ++y)
            for (std::size_t x = 0; x < taps.size(); ++x)
                sum += taps[y] * taps[x] * sampled[last - y * width - x];
        image.push_back(sum);
    }
}

} // namespace gradus
