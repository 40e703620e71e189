#include "runtime/direct_light/shared_cells.h"

#include "runtime/direct_light/shared_rays.h"
#include "runtime/scene/filter_table.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

/// Those whose rays count for a pixel, line by line.
template <class Work>
void SharedCells::for_each_cell_of(std::size_t pixel, const Work &work) const {
    const std::size_t first = pixel / std::size_t(width_) * std::size_t(wide_) + pixel % std::size_t(width_);
    for (std::size_t y = 0; y < taps(); ++y)
        for (std::size_t x = 0; x < taps(); ++x)
            work(first + y * std::size_t(wide_) + x);
}

SharedCells::SharedCells(const FilmSettings &film, const EdgePixels &edges, double budget, std::uint32_t least,
                         std::uint32_t most)
    : reach_(int(filter_reach(film))), width_(int(film.crop_width)), height_(int(film.crop_height)),
      wide_(width_ + 2 * reach_), sum_of_(std::size_t(width_) * std::size_t(height_), no_sum) {
    const std::size_t all = std::size_t(wide_) * std::size_t(height_ + 2 * reach_);
    // Each cell needs what the neediest pixel needs that it serves.
    std::vector<float> needs(all, 0.0f);
    for (std::size_t e = 0; e < edges.pixels.size(); ++e)
        for_each_cell_of(edges.pixels[e],
                         [&](std::size_t cell) { needs[cell] = std::max(needs[cell], edges.needs[e]); });
    std::vector<float> needs_of_cells;
    for (std::size_t cell = 0; cell < all; ++cell)
        if (needs[cell] > 0) {
            cells_.push_back(cell);
            needs_of_cells.push_back(needs[cell]);
        }
    const std::vector<std::uint32_t> shares = shared_rays(needs_of_cells, budget, least, most);
    std::vector<char> has_rays(all, 0);
    for (std::size_t i = 0; i < cells_.size(); ++i)
        has_rays[cells_[i]] = shares[i] > 0;
    std::vector<char> serves(all, 0);
    for (const std::size_t pixel : edges.pixels) {
        bool is_there = true;
        for_each_cell_of(pixel, [&](std::size_t cell) { is_there = is_there && has_rays[cell]; });
        if (!is_there)
            continue;
        sum_of_[pixel] = std::uint32_t(pixels_.size());
        pixels_.push_back(pixel);
        for_each_cell_of(pixel, [&](std::size_t cell) { serves[cell] = 1; });
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cells_.size(); ++i)
        if (serves[cells_[i]]) {
            cells_[kept++] = cells_[i];
            rays_.push_back(shares[i]);
        }
    cells_.resize(kept);
    sums_.resize(pixels_.size());
}

void SharedCells::means(std::size_t cell, const rgb *light, const float *of_rays, HalfMeans *to) const {
    std::fill_n(to, pixels_around(), HalfMeans());
    const std::uint32_t count = rays_[cell], middle = count / 2;
    for (std::uint32_t ray = 0; ray < count; ++ray, of_rays += 2 * taps()) {
        const int half = ray < middle ? 0 : 1;
        for (std::size_t y = 0; y < taps(); ++y)
            for (std::size_t x = 0; x < taps(); ++x) {
                const float weight = of_rays[x] * of_rays[taps() + y];
                std::array<double, 3> &sum = to[y * taps() + x][half];
                sum[0] += double(weight) * light[ray].r;
                sum[1] += double(weight) * light[ray].g;
                sum[2] += double(weight) * light[ray].b;
            }
    }
    for (std::size_t i = 0; i < pixels_around(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            to[i][0][c] /= middle;
            to[i][1][c] /= count - middle;
        }
}

void SharedCells::add(std::size_t cell, const HalfMeans *means) {
    const auto [column, row] = place(cell);
    const double share = double(rays_[cell] / 2) / rays_[cell];
    for (int y = -reach_; y <= reach_; ++y)
        for (int x = -reach_; x <= reach_; ++x, ++means) {
            const int to_column = column + x, to_row = row + y;
            if (to_column < 0 || to_column >= width_ || to_row < 0 || to_row >= height_)
                continue;
            const std::uint32_t sum = sum_of_[std::size_t(to_row) * std::size_t(width_) + std::size_t(to_column)];
            if (sum == no_sum)
                continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double apart = (*means)[0][c] - (*means)[1][c];
                sums_[sum][c] += share * (*means)[0][c] + (1 - share) * (*means)[1][c];
                sums_[sum][3 + c] += share * (1 - share) * apart * apart;
            }
        }
}

std::vector<DirectPixel> SharedCells::pixels() const {
    std::vector<DirectPixel> found;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        DirectPixel pixel;
        pixel.pixel = pixels_[i];
        for (std::size_t c = 0; c < 3; ++c) {
            pixel.light[c] = static_cast<float>(sums_[i][c]);
            pixel.variance[c] = static_cast<float>(sums_[i][3 + c]);
        }
        found.push_back(pixel);
    }
    return found;
}

} // namespace gradus
