#include "solver/fill.h"

#include "kernels/shared/solver_shared.h"

#include <cstddef>
#include <vector>

namespace gradus::solver {

namespace {

enum class Pixel : unsigned char { outside, missing, in_ring, known };

template <class Real>
void fill(const Grid &grid, std::uint32_t channels, const Real *valid, Real *image) {
    std::vector<Pixel> pixels(grid.plane, Pixel::outside);
    std::vector<std::size_t> ring, next;
    // Pixels next to this one that are missing are of the next ring.
    const auto reach = [&](std::size_t at) {
        for (const std::size_t beside : {at - 1, at + 1, at - grid.row, at + grid.row})
            if (pixels[beside] == Pixel::missing) {
                pixels[beside] = Pixel::in_ring;
                next.push_back(beside);
            }
    };
    const auto first_of_row = [&](std::uint32_t y) { return (std::size_t(y) + 1) * grid.row + SOLVER_MARGIN; };
    for (std::uint32_t y = 0; y < grid.height; ++y)
        for (std::size_t at = first_of_row(y); at < first_of_row(y) + grid.width; ++at)
            pixels[at] = valid[at] > 0 ? Pixel::known : Pixel::missing;
    for (std::uint32_t y = 0; y < grid.height; ++y)
        for (std::size_t at = first_of_row(y); at < first_of_row(y) + grid.width; ++at)
            if (pixels[at] == Pixel::known)
                reach(at);
    while (!next.empty()) {
        ring.swap(next);
        next.clear();
        for (const std::size_t at : ring) {
            const auto is_known = [&](std::size_t beside) { return Real(pixels[beside] == Pixel::known ? 1 : 0); };
            const Real left = is_known(at - 1), right = is_known(at + 1), up = is_known(at - grid.row),
                       down = is_known(at + grid.row);
            for (std::uint32_t channel = 0; channel < channels; ++channel) {
                Real *const here = image + std::size_t(channel) * grid.plane + at;
                const Real sum = (left * here[-1] + right * here[1]) +
                                 (up * here[-std::ptrdiff_t(grid.row)] + down * here[grid.row]);
                *here = sum / ((left + right) + (up + down));
            }
        }
        for (const std::size_t at : ring)
            pixels[at] = Pixel::known;
        for (const std::size_t at : ring)
            reach(at);
    }
}

} // namespace

void fill_missing(Precision precision, const Grid &grid, std::uint32_t channels, const Buffer &valid, Buffer &image) {
    const auto from = valid.map(Access::read), to = image.map(Access::read_write);
    if (precision == Precision::double_)
        fill(grid, channels, from.as<double>(), to.as<double>());
    else
        fill(grid, channels, from.as<float>(), to.as<float>());
}

} // namespace gradus::solver
