#include "runtime/scene/filter_table.h"

#include "kernels/lib/filter_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace gradus {

using namespace lib_float;

namespace {

constexpr double pi = std::numbers::pi;

/// Mitchell and Netravali (1988), equation 8.
double mitchell(double x, double b, double c) {
    x = std::fabs(x);
    if (x < 1)
        return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
    if (x < 2)
        return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6;
    return 0;
}

double sinc(double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); }

/// The filter's value for each pixel around the one that `offset` lies in: of tap t where t - reach pixels further on
/// is the center.
std::vector<double> values_around(const FilmSettings &film, int reach, double offset) {
    std::vector<double> values;
    for (int d = -reach; d <= reach; ++d)
        values.push_back(filter_value(film, offset - d));
    return values;
}

double sum_of(const std::vector<double> &values) { return std::accumulate(values.begin(), values.end(), 0.0); }

} // namespace

double filter_value(const FilmSettings &film, double x) {
    const double radius = film.filter == FilmSettings::Filter::box ? 0.5 : film.filter_radius;
    if (std::fabs(x) >= radius)
        return 0;
    switch (film.filter) {
    case FilmSettings::Filter::box:
        return 1;
    case FilmSettings::Filter::tent:
        return 1 - std::fabs(x) / radius;
    case FilmSettings::Filter::gaussian:
        return std::exp(-0.5 * x * x / (double(film.filter_stddev) * film.filter_stddev));
    case FilmSettings::Filter::mitchell:
        return mitchell(x, film.mitchell_b, film.mitchell_c);
    case FilmSettings::Filter::catmullrom:
        return mitchell(x, 0, 0.5);
    case FilmSettings::Filter::lanczos:
        return sinc(x) * sinc(x / radius);
    }
    return 0;
}

std::uint32_t filter_reach(const FilmSettings &film) {
    // A sample is at most half a pixel from its pixel's center.
    return film.filter == FilmSettings::Filter::box
               ? 0
               : static_cast<std::uint32_t>(std::max(0.0, std::ceil(double(film.filter_radius) + 0.5) - 1));
}

FilterTable make_filter_table(const FilmSettings &film) {
    FilterTable table;
    if (film.filter == FilmSettings::Filter::box)
        return table;
    // Midpoints of a grid so fine that its own error is below that of floats, over the part of the pixel that has any.
    constexpr std::size_t steps = std::size_t(1) << 16;
    const int reach = int(filter_reach(film));
    const std::size_t taps = 2 * std::size_t(reach) + 1;
    const double half = std::min(0.5, double(film.filter_radius)), step = 2 * half / double(steps);
    // Up to each border of the grid, what there is of each tap, and of all.
    std::vector<double> up_to((steps + 1) * taps, 0.0), whole_up_to(steps + 1, 0.0);
    for (std::size_t i = 0; i < steps; ++i) {
        const std::vector<double> values = values_around(film, reach, (double(i) + 0.5) * step - half);
        for (std::size_t tap = 0; tap < taps; ++tap)
            up_to[(i + 1) * taps + tap] = up_to[i * taps + tap] + step * values[tap];
        whole_up_to[i + 1] = whole_up_to[i] + step * sum_of(values);
    }
    const double whole = whole_up_to.back(), of_cell = whole / double(filter_cells);
    table.mean_taps.assign(up_to.end() - std::ptrdiff_t(taps), up_to.end());
    for (double &mean : table.mean_taps)
        mean /= whole;

    std::size_t i = 0;
    double begin = -half;
    std::vector<double> before(taps, 0.0);
    table.offsets.push_back(float(begin));
    for (std::uint32_t cell = 1; cell <= filter_cells; ++cell) {
        const double target = of_cell * cell;
        while (i + 1 < steps && whole_up_to[i + 1] < target)
            ++i;
        const double of_step = whole_up_to[i + 1] - whole_up_to[i];
        const double part =
            cell == filter_cells ? 1 : std::clamp((target - whole_up_to[i]) / std::max(of_step, 1e-300), 0.0, 1.0);
        const double end = cell == filter_cells ? half : (double(i) + part) * step - half;
        const std::vector<double> first = values_around(film, reach, begin), last = values_around(film, reach, end);
        std::vector<double> at[2];
        for (std::size_t tap = 0; tap < taps; ++tap) {
            const double here = cell == filter_cells ? up_to[steps * taps + tap]
                                                     : up_to[i * taps + tap] +
                                                           part * (up_to[(i + 1) * taps + tap] - up_to[i * taps + tap]);
            // Straight lines, from value to value, that hold the cell's share.
            const double scale = (end - begin) / of_cell;
            const double off = (here - before[tap]) / of_cell - 0.5 * scale * (first[tap] + last[tap]);
            at[0].push_back(scale * first[tap] + off);
            at[1].push_back(scale * last[tap] + off);
            before[tap] = here;
        }
        // They sum up to nearly 1, but where the cell is wide beside what the filter has there: there they stay as they
        // are on average.
        if (std::fabs(sum_of(at[0]) - 1) > 0.5)
            for (std::size_t tap = 0; tap < taps; ++tap)
                at[0][tap] = at[1][tap] = 0.5 * (at[0][tap] + at[1][tap]);
        for (const std::vector<double> &weights : at)
            for (const double weight : weights)
                table.taps.push_back(float(weight / sum_of(weights)));
        table.offsets.push_back(float(end));
        begin = end;
    }
    for (std::size_t tap = 0; tap < 2 * taps; ++tap)
        table.taps.push_back(tap % taps == std::size_t(reach) ? 1.0f : 0.0f);
    return table;
}

} // namespace gradus
