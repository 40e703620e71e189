#include "runtime/direct_light/edge_pixels.h"

#include "kernels/lib/filter_table.h"
#include "kernels/lib/random.h"
#include "runtime/film/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace gradus {

using namespace lib_float;

namespace {

constexpr std::uint32_t pilot_side = 2;
/// Rays go by this power of a pixel's relative variance. Of errors that fell as one over the square of the rays the
/// third root would leave least; of 600 lanterns the fourth does: a tenth less than the third, a quarter less than the
/// second. (Where there are rays enough for all pixels, equal shares do as well.)
constexpr double power_of_need = 0.25;

/// How many pixels of any window have what `is(x, y)` says; it is false beyond `all`.
class WindowSums {
  public:
    template <class Predicate>
    WindowSums(const PixelRectangle &all, const Predicate &is)
        : all_(all), sums_(std::size_t(all.width() + 1) * (all.height() + 1), 0) {
        for (std::uint32_t y = all.top; y < all.bottom; ++y) {
            std::uint32_t row = 0;
            for (std::uint32_t x = all.left; x < all.right; ++x) {
                row += is(int(x), int(y)) ? 1 : 0;
                sums_[place(x + 1, y + 1)] = sums_[place(x + 1, y)] + row;
            }
        }
    }
    /// Whether columns [left, right) of rows [top, bottom) have any.
    bool any(int left, int top, int right, int bottom) const {
        const std::uint32_t x0 = clamp(left, all_.left, all_.right), x1 = clamp(right, all_.left, all_.right);
        const std::uint32_t y0 = clamp(top, all_.top, all_.bottom), y1 = clamp(bottom, all_.top, all_.bottom);
        return x0 < x1 && y0 < y1 &&
               sums_[place(x1, y1)] - sums_[place(x0, y1)] != sums_[place(x1, y0)] - sums_[place(x0, y0)];
    }

  private:
    static std::uint32_t clamp(int value, std::uint32_t least, std::uint32_t most) {
        return std::uint32_t(std::clamp<std::int64_t>(value, least, most));
    }
    std::size_t place(std::uint32_t x, std::uint32_t y) const {
        return std::size_t(y - all_.top) * (all_.width() + 1) + (x - all_.left);
    }
    PixelRectangle all_;
    std::vector<std::uint32_t> sums_; ///< over all pixels to the left of and above a place
};

bool differ(rgb a, rgb b) { return a.r != b.r || a.g != b.g || a.b != b.b; }

/// What samples of a pixel weigh along one axis for that pixel and those around it, and the squares of that, on
/// average.
struct MeanTaps {
    std::vector<double> values, squares;

    MeanTaps(const FilterTable &filter, int reach) : values(filter.mean_taps), squares(2 * std::size_t(reach) + 1) {
        const std::size_t taps = squares.size();
        if (filter.offsets.empty())
            values = squares = {1.0};
        else
            for (std::size_t tap = 0; tap < taps; ++tap)
                for (std::size_t cell = 0; cell < filter_cells; ++cell) {
                    const double begin = filter.taps[2 * cell * taps + tap];
                    const double end = filter.taps[(2 * cell + 1) * taps + tap];
                    squares[tap] += (begin * begin + begin * end + end * end) / (3.0 * filter_cells);
                }
    }
};

/// Means of the brightness of pixels' light and of its square; 0 beyond the lit ones. Spread by half a pixel, since of
/// where within a pixel an edge lies pilot rays tell little.
class Moments {
  public:
    explicit Moments(const PixelRectangle &lit)
        : lit_(lit), wide_(lit.width() + 2), values_(std::size_t(wide_) * (lit.height() + 2)) {}
    void add(std::size_t number, double brightness, double weight) {
        constexpr double spread[] = {0.25, 0.5, 0.25};
        for (std::size_t y = 0; y < 3; ++y)
            for (std::size_t x = 0; x < 3; ++x) {
                std::array<float, 2> &to = values_[(number / lit_.width() + y) * wide_ + number % lit_.width() + x];
                to[0] += float(weight * spread[y] * spread[x] * brightness);
                to[1] += float(weight * spread[y] * spread[x] * brightness * brightness);
            }
    }
    std::array<float, 2> at(int x, int y) const {
        const int column = x - int(lit_.left) + 1, row = y - int(lit_.top) + 1;
        if (column < 0 || row < 0 || column >= int(wide_) || row >= int(lit_.height()) + 2)
            return {0, 0};
        return values_[std::size_t(row) * wide_ + std::size_t(column)];
    }

  private:
    PixelRectangle lit_;
    std::size_t wide_;
    std::vector<std::array<float, 2>> values_;
};

} // namespace

EdgePixels edge_pixels(const FilmSettings &film, const FilterTable &filter, const PixelRectangle &lit,
                       DirectRays &rays) {
    const int reach = int(filter_reach(film));
    const MeanTaps taps(filter, reach);
    const int around = std::max(reach, 1); // pixels that may show an edge
    // Of each lit pixel its first light, whether its rays saw another, and means of their brightness and its square.
    constexpr std::size_t pilots = pilot_side * pilot_side;
    std::vector<rgb> seen(std::size_t(lit.width()) * lit.height());
    std::vector<char> mixed(seen.size(), 0);
    Moments moments(lit);
    for (std::size_t begin = 0; begin < seen.size();) {
        const std::size_t end = std::min(seen.size(), begin + most_direct_rays / pilots);
        const std::vector<rgb> &light = rays.trace(pilots * (end - begin), true, [&](std::size_t ray) {
            const std::size_t number = begin + ray / pilots, i = ray % pilots;
            const std::size_t x = film.crop_x + lit.left + number % lit.width();
            const std::size_t y = film.crop_y + lit.top + number / lit.width();
            // Each at a place of the lens of its own.
            const random_bits lens = random_hash(std::uint32_t(x), std::uint32_t(y), std::uint32_t(i), 0x6C656E73u);
            return CameraPlace{float(x) + (float(i % pilot_side) + 0.5f) / pilot_side,
                               float(y) + (float(i / pilot_side) + 0.5f) / pilot_side, random_unit(lens.x),
                               random_unit(lens.y)};
        });
        for (std::size_t number = begin; number < end; ++number) {
            const rgb *first = &light[(number - begin) * pilots];
            seen[number] = *first;
            mixed[number] = std::any_of(first + 1, first + pilots, [&](rgb other) { return differ(other, *first); });
            for (std::size_t i = 0; i < pilots; ++i) {
                // Whose square is a number.
                moments.add(number, std::min(1e15f, (first[i].r + first[i].g + first[i].b) / 3), 1.0 / pilots);
            }
        }
        begin = end;
    }
    const auto number_of = [&](int x, int y) { return std::size_t(y - int(lit.top)) * lit.width() + x - lit.left; };
    const auto seen_at = [&](int x, int y) { return lit.contains(x, y) ? seen[number_of(x, y)] : rgb_gray(0); };
    const auto is_mixed = [&](int x, int y) { return lit.contains(x, y) && mixed[number_of(x, y)]; };
    // A pixel is at an edge where one of its window is mixed, or where two that lie side by side in it differ. Beyond
    // the lit ones all are dark.
    const int width = int(film.crop_width), height = int(film.crop_height);
    const PixelRectangle beside{lit.left - std::min(lit.left, 1u), lit.top - std::min(lit.top, 1u),
                                std::min(lit.right + 1, film.crop_width), std::min(lit.bottom + 1, film.crop_height)};
    const WindowSums mixes(beside, is_mixed);
    const WindowSums across(beside, [&](int x, int y) { return differ(seen_at(x, y), seen_at(x - 1, y)); });
    const WindowSums down(beside, [&](int x, int y) { return differ(seen_at(x, y), seen_at(x, y - 1)); });
    const auto need_of = [&](int x, int y) {
        double mean = 0, variance = 0;
        for (int j = -reach; j <= reach; ++j)
            for (int i = -reach; i <= reach; ++i) {
                // Seen from that pixel, this one lies the other way.
                const std::size_t across = std::size_t(reach - i), down = std::size_t(reach - j);
                const auto [light, square] = moments.at(x + i, y + j);
                const double here = taps.values[across] * taps.values[down] * light;
                mean += here;
                variance += taps.squares[across] * taps.squares[down] * square - here * here;
            }
        return float(std::pow(std::max(variance, 0.0) / (mean * mean + relative_mse_epsilon), power_of_need));
    };
    constexpr float least_need = 1e-6f; // where colours differ and brightness does not
    EdgePixels found;
    for (int y = std::max(int(lit.top) - around, 0); y < std::min(int(lit.bottom) + around, height); ++y)
        for (int x = std::max(int(lit.left) - around, 0); x < std::min(int(lit.right) + around, width); ++x) {
            const int left = std::max(x - around, 0), right = std::min(x + around + 1, width);
            const int top = std::max(y - around, 0), bottom = std::min(y + around + 1, height);
            if (mixes.any(left, top, right, bottom) || across.any(left + 1, top, right, bottom) ||
                down.any(left, top + 1, right, bottom)) {
                found.pixels.push_back(std::size_t(y) * film.crop_width + x);
                found.needs.push_back(std::max(need_of(x, y), least_need));
            }
        }
    return found;
}

} // namespace gradus
