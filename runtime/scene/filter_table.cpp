#include "runtime/scene/filter_table.h"

#include "kernels/lib/filter_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

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

/// Shares of what cells go by that are of widths alone, among lobes and within one: less, and the cells of small lobes
/// and beside zeros are so wide that the filter is no straight line in them; more, and weights differ more.
constexpr double share_by_width = 0.1, evenness = 0.1;

/// Between two zeros.
struct Lobe {
    std::size_t begin, end; ///< steps of the grid
    double mass;            ///< its integral, signed
};

} // namespace

bool is_signed(FilmSettings::Filter filter) {
    return filter == FilmSettings::Filter::mitchell || filter == FilmSettings::Filter::catmullrom ||
           filter == FilmSettings::Filter::lanczos;
}

double signed_filter(const FilmSettings &film, double x) {
    if (std::fabs(x) >= film.filter_radius)
        return 0;
    if (film.filter == FilmSettings::Filter::mitchell)
        return mitchell(x, film.mitchell_b, film.mitchell_c);
    if (film.filter == FilmSettings::Filter::catmullrom)
        return mitchell(x, 0, 0.5);
    return sinc(x) * sinc(x / film.filter_radius);
}

std::vector<float> make_filter_table(const FilmSettings &film) {
    if (!is_signed(film.filter))
        return {};
    // Midpoints of a grid so fine that its own error is below that of floats.
    constexpr std::size_t steps = std::size_t(1) << 16;
    const double radius = film.filter_radius, step = 2 * radius / double(steps);
    std::vector<double> masses(steps);
    std::vector<Lobe> lobes;
    double whole = 0, of_both_signs = 0;
    for (std::size_t i = 0; i < steps; ++i) {
        masses[i] = step * signed_filter(film, (double(i) + 0.5) * step - radius);
        whole += masses[i];
        of_both_signs += std::fabs(masses[i]);
        if (lobes.empty() || (masses[i] < 0) != (lobes.back().mass < 0))
            lobes.push_back({i, i, 0});
        lobes.back().end = i + 1;
        lobes.back().mass += masses[i];
    }
    // To each lobe cells by its mass and its width, and to the largest what rounding leaves.
    std::vector<std::size_t> cells;
    std::size_t left = filter_cells;
    for (const Lobe &lobe : lobes) {
        const double by_width = double(lobe.end - lobe.begin) / double(steps);
        const double share = double(filter_cells) *
                             (share_by_width * by_width + (1 - share_by_width) * std::fabs(lobe.mass) / of_both_signs);
        cells.push_back(std::max<std::size_t>(1, std::size_t(share)));
        left -= cells.back();
    }
    cells[std::size_t(std::max_element(cells.begin(), cells.end()) - cells.begin())] += left;

    std::vector<float> table, weights;
    for (std::size_t l = 0; l < lobes.size(); ++l) {
        const Lobe &lobe = lobes[l];
        // Evenly by the filter and a little by width: or the cells beside its zeros would be wide.
        const double least = evenness * std::fabs(lobe.mass) / double(lobe.end - lobe.begin);
        const double of_cell = (1 + evenness) * std::fabs(lobe.mass) / double(cells[l]);
        double even = 0, mass = 0, mass_before = 0, value_before = 0; // up to step i, and up to the cell
        std::size_t i = lobe.begin;
        for (std::size_t cell = 0; cell <= cells[l]; ++cell) {
            const double target = of_cell * double(cell);
            for (; i < lobe.end && even + std::fabs(masses[i]) + least <= target; ++i) {
                even += std::fabs(masses[i]) + least;
                mass += masses[i];
            }
            const bool is_end = i == lobe.end || cell == cells[l];
            const double part = is_end ? 0 : std::clamp((target - even) / (std::fabs(masses[i]) + least), 0.0, 1.0);
            const double up_to_here = is_end ? lobe.mass : mass + part * masses[i];
            const double place = (double(is_end ? lobe.end : i) + part) * step - radius;
            const double value = is_end ? 0 : signed_filter(film, place); // of one sign, and none at a lobe's ends
            if (cell > 0) {
                // Straight lines that hold the cell's share.
                const double height = (up_to_here - mass_before) * double(filter_cells) / whole;
                const double sum = value_before + value;
                weights.push_back(float(sum != 0 ? 2 * height * value_before / sum : height));
                weights.push_back(float(sum != 0 ? 2 * height * value / sum : height));
            }
            if (cell < cells[l])
                table.push_back(float(place));
            mass_before = up_to_here;
            value_before = cell == 0 && i == lobe.begin ? 0 : value;
        }
    }
    table.push_back(float(radius));
    table.insert(table.end(), weights.begin(), weights.end());
    return table;
}

} // namespace gradus
