#include "runtime/scene/environment_map.h"

#include "runtime/scene/light_table.h"
#include "runtime/scene/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

// After TBB, which has template parameters of the names of its macros.
#include "kernels/lib/environment.h"

namespace gradus {

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint32_t strip_length = environment_strip;
/// Where the largest number of a map is put within [2^-31, 2^33): all that may be far below it is to be told, too.
constexpr int largest_exponent = 31;

/// The code of lib_float::environment_number() nearest to a number below 2^33.
std::uint32_t code_of(float number) {
    const std::uint32_t bits =
        std::bit_cast<std::uint32_t>(number) + 0x0FFFu + (std::bit_cast<std::uint32_t>(number) >> 13 & 1u);
    return bits < 0x30000000u ? 0u : std::min((bits - 0x30000000u) >> 13, 0xFFFFu);
}

/// The power of two that takes the largest of a map's numbers to its place, as far as its inverse is a number.
float unit_of(float largest) {
    return largest > 0 ? std::ldexp(1.0f, std::max(std::ilogb(largest) - largest_exponent, -126)) : 1.0f;
}

/// What a row of texels has of the sphere, times the columns: the integral of its hat function over the angles.
double row_share(std::uint32_t row, std::uint32_t rows) {
    const double step = pi / rows;
    const double share =
        row == 0 || row == rows ? 1 - std::sin(step) / step : std::sin(step * row) * (2 - 2 * std::cos(step)) / step;
    return 2 * pi * share;
}

/// Fewer are not worth another thread.
constexpr std::size_t rows_at_once = 16;

float importance_at(const EnvironmentMap &map, std::uint32_t row, std::uint32_t column) {
    const std::size_t texel = std::size_t(row) * (map.columns + 1) + column;
    return lib_float::environment_number(map.texels[2 * texel + 1] >> 16);
}

std::uint32_t strips_of_row(std::uint32_t columns) { return columns / strip_length + (columns % strip_length != 0); }

/// The entries of a strip whose cells have these weights, by Vose's method in fixed point: the threshold of a cell that
/// keeps all that is drawn is out of reach of 24 bits, so its alias is itself.
void make_strip(const std::array<float, strip_length> &weights, double total, std::uint32_t *entries) {
    std::array<double, strip_length> scaled;
    std::array<std::uint8_t, strip_length> small, large;
    std::uint32_t small_count = 0, large_count = 0;
    for (std::uint32_t i = 0; i < strip_length; ++i) {
        scaled[i] = total > 0 ? weights[i] / total * strip_length : 1;
        entries[i] = i;
        if (scaled[i] < 1)
            small[small_count++] = std::uint8_t(i);
        else
            large[large_count++] = std::uint8_t(i);
    }
    while (small_count > 0 && large_count > 0) {
        const std::uint32_t low = small[--small_count], high = large[large_count - 1];
        entries[low] = std::min(std::uint32_t(scaled[low] * 0x1p24 + 0.5), 0xFFFFFFu) << 8 | high;
        scaled[high] -= 1 - scaled[low];
        if (scaled[high] < 1) {
            --large_count;
            small[small_count++] = std::uint8_t(high);
        }
    }
}

/// Fills a row of texels; returns the sums of its colours.
std::array<double, 3> make_row(EnvironmentMap &map, std::uint32_t row, const std::array<const float *, 3> &from,
                               double importance_unit) {
    const float to_number = 1 / map.unit;
    const double share = row_share(row, map.rows);
    std::uint32_t *to = &map.texels[std::size_t(row) * (map.columns + 1) * 2];
    std::array<double, 3> sums{};
    for (std::uint32_t column = 0; column < map.columns; ++column) {
        std::uint32_t code[3];
        float value[3];
        for (int c = 0; c < 3; ++c) {
            code[c] = code_of(from[c][column] * to_number);
            value[c] = lib_float::environment_number(code[c]);
            sums[c] += value[c];
        }
        const double bright = luminance(value[0], value[1], value[2]);
        std::uint32_t importance = code_of(float(bright * share / importance_unit));
        if (bright > 0)
            importance = std::max(importance, 1u); // whatever shines is found
        to[2 * column] = code[0] | code[1] << 16;
        to[2 * column + 1] = code[2] | importance << 16;
    }
    to[2 * map.columns] = to[0];
    to[2 * map.columns + 1] = to[1];
    return sums;
}

} // namespace

EnvironmentMap make_environment_map(std::uint32_t width, std::uint32_t height, std::span<const float> red,
                                    std::span<const float> green, std::span<const float> blue) {
    EnvironmentMap map;
    map.columns = width;
    map.rows = std::max(height, 2u) - 1;
    map.texels.resize(std::size_t(map.columns + 1) * (map.rows + 1) * 2);
    float largest = 0;
    for (const std::span<const float> &plane : {red, green, blue})
        largest = std::max(largest, *std::max_element(plane.begin(), plane.end()));
    map.unit = unit_of(largest);
    // Luminances are at most 2^32, and shares at most 2 pi.
    constexpr double importance_unit = 8;

    std::vector<std::array<double, 3>> sums(map.rows + 1);
    for_each_in_parallel(
        map.rows + 1,
        [&](std::size_t row) {
            const std::size_t from = std::min<std::size_t>(row, height - 1) * width;
            sums[row] = make_row(map, std::uint32_t(row), {&red[from], &green[from], &blue[from]}, importance_unit);
        },
        rows_at_once);
    std::array<double, 3> integral{};
    for (std::uint32_t row = 0; row <= map.rows; ++row)
        for (int c = 0; c < 3; ++c)
            integral[c] += sums[row][c] * row_share(row, map.rows) / map.columns * map.unit;
    map.integral = {float(integral[0]), float(integral[1]), float(integral[2])};

    const std::uint32_t strips_a_row = strips_of_row(map.columns);
    const std::size_t strips = std::size_t(strips_a_row) * map.rows;
    map.cells.resize(strips * strip_length);
    std::vector<double> weights(strips);
    for_each_in_parallel(
        map.rows,
        [&](std::size_t at) {
            const auto row = std::uint32_t(at);
            for (std::uint32_t s = 0; s < strips_a_row; ++s) {
                std::array<float, strip_length> cells{};
                double total = 0;
                for (std::uint32_t i = 0; i < strip_length && s * strip_length + i < map.columns; ++i) {
                    const std::uint32_t column = s * strip_length + i;
                    cells[i] = 0.25f * (importance_at(map, row, column) + importance_at(map, row, column + 1) +
                                        importance_at(map, row + 1, column) + importance_at(map, row + 1, column + 1));
                    total += cells[i];
                }
                const std::size_t strip = std::size_t(row) * strips_a_row + s;
                weights[strip] = total;
                make_strip(cells, total, &map.cells[strip * strip_length]);
            }
        },
        rows_at_once);
    double total = 0;
    for (const double weight : weights)
        total += weight;
    map.strips.resize(strips * 2);
    if (!(total > 0))
        return map; // black
    map.scale = float(double(map.columns) * map.rows / (2 * pi * pi * total));
    const AliasTable alias = make_alias_table(weights);
    for (std::size_t i = 0; i < strips; ++i) {
        // What keeps all that is drawn has itself as its alias.
        map.strips[2 * i] = std::uint32_t(std::min(double(alias.threshold[i]) * 0x1p32, 0x1p32 - 1));
        map.strips[2 * i + 1] = alias.alias[i];
    }
    return map;
}

std::uint64_t most_environment_rows(std::uint32_t width) {
    constexpr std::uint64_t of_any = std::uint64_t(1) << 18, most_strips = (std::uint64_t(1) << 22) - 1;
    const std::uint64_t strips_a_row = strips_of_row(width);
    // Strips of a quarter of their length at least.
    const std::uint64_t of_texels = most_environment_texels / std::max<std::uint64_t>(width, 1);
    return width < strip_length / 4 ? of_any : std::min(of_texels, most_strips / strips_a_row);
}

std::size_t environment_bytes(const EnvironmentMap &map) {
    return 4 * (map.texels.size() + map.cells.size() + map.strips.size());
}

EnvironmentMap no_environment_map() {
    EnvironmentMap map;
    map.texels.resize(8);
    map.cells.resize(strip_length);
    map.strips.resize(2);
    return map;
}

} // namespace gradus
