#include "runtime/direct_light/direct_light.h"

#include "runtime/direct_light/direct_rays.h"
#include "runtime/direct_light/edge_pixels.h"
#include "runtime/direct_light/shared_cells.h"

#include "kernels/lib/additive_sequence.h"
#include "kernels/lib/filter_table.h"
#include "kernels/lib/stratified.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

namespace {

constexpr double rays_a_sample = 1; // of the image; a sample of a path takes a dozen
/// Through a pixel at an edge. Their error falls nearly as one over their number and is below a hundredth of the light
/// long before these: more would cost and gain nothing.
constexpr std::uint32_t least_of_most = 256, most_a_sample = 32, most_samples = 4096;

/// Where within a pixel a ray goes along one axis, and what it weighs for the pixels around.
class FilterDraws {
  public:
    FilterDraws(const FilterTable &filter, int reach) : filter_(filter), reach_(std::uint32_t(reach)) {}
    std::size_t taps() const { return 2 * reach_ + 1; }
    std::size_t taps_of_both() const { return 2 * taps(); }
    /// The offset from the pixel's center; leaves the taps.
    float draw(float u, float *to) const {
        if (filter_.offsets.empty()) {
            *to = 1;
            return u - 0.5f;
        }
        const filter_place place = filter_place_of(u);
        for (std::uint32_t tap = 0; tap < taps(); ++tap)
            to[tap] = filter_tap(filter_.taps.data(), reach_, place, tap);
        return filter_offset(filter_.offsets.data(), place);
    }

  private:
    const FilterTable &filter_;
    std::uint32_t reach_;
};

} // namespace

std::vector<DirectPixel> sample_direct_edges(const SceneTables &tables, const FilmSettings &film, Tracer &tracer,
                                             std::uint64_t seed, std::uint32_t samples, std::uint64_t &rays) {
    DirectRays direct(tables, tracer, rays);
    const int reach = int(filter_reach(film));
    // Rays that serve many pixels take longer, and fewer are needed.
    const double taps_of_usual = 49, taps_of_this = (2.0 * reach + 1) * (2 * reach + 1);
    const double budget =
        rays_a_sample * samples * film.crop_width * film.crop_height * std::min(taps_of_usual / taps_of_this, 1.0);
    const double most = std::min<double>(least_of_most + double(most_a_sample) * samples, most_samples);
    // The paths' own are better than fewer; half as many where cells around make up for each other, which paths, whose
    // places all pixels share, do not.
    const double least = reach == 0 ? 2.0 * samples : std::max<double>(samples, 2);
    if (most < least)
        return {};
    const EdgePixels edges = edge_pixels(film, tables.filter, lit_rectangle(tables, film), direct);
    SharedCells cells(film, edges, budget, std::uint32_t(least), std::uint32_t(most));
    std::vector<float> taps;       ///< by ray
    std::vector<std::size_t> ends; ///< where the rays of a cell end, by cell of the batch
    std::vector<SharedCells::HalfMeans> means;
    const std::size_t most_cells = std::max<std::size_t>(most_direct_rays / cells.pixels_around(), 1);
    const FilterDraws filter(tables.filter, reach);
    for (std::size_t begin = 0; begin < cells.count();) {
        ends.clear();
        std::size_t end = begin, all = 0;
        while (end < cells.count() && end - begin < most_cells &&
               (end == begin || all + cells.rays(end) <= most_direct_rays))
            ends.push_back(all += cells.rays(end++));
        taps.resize(all * filter.taps_of_both());
        const std::vector<rgb> &light = direct.trace(all, false, [&](std::size_t ray) {
            const std::size_t e = std::size_t(std::ranges::upper_bound(ends, ray) - ends.begin());
            const auto [x, y] = cells.place(begin + e);
            const auto number = static_cast<std::uint32_t>(ray - (ends[e] - cells.rays(begin + e)));
            // No path has so high a sample number. Cells beyond the film have numbers of their own.
            const std::uint32_t cell = std::uint32_t(y + std::int64_t(film.crop_y) + reach) * (film.width + 2 * reach) +
                                       std::uint32_t(x + std::int64_t(film.crop_x) + reach);
            const random_bits start = random_key(static_cast<std::uint32_t>(seed),
                                                 static_cast<std::uint32_t>(seed >> 32), cell, 0, 0xFFFFFFFFu);
            const point2 place = additive_sequence(start.x, start.y, number);
            float *of_ray = &taps[ray * filter.taps_of_both()];
            CameraPlace at{float(film.crop_x) + float(x) + 0.5f + filter.draw(place.x, of_ray),
                           float(film.crop_y) + float(y) + 0.5f + filter.draw(place.y, of_ray + filter.taps())};
            if (tables.camera_kind == Camera::Kind::thin_lens) {
                const random4 lens = stratified_draw(start.z, number, random_dimension_camera);
                at.lens_1 = lens.a;
                at.lens_2 = lens.b;
            }
            return at;
        });
        means.resize((end - begin) * cells.pixels_around());
        tracer.in_parallel(end - begin, [&](std::size_t first, std::size_t last) {
            for (std::size_t e = first; e < last; ++e) {
                const std::size_t of_cell = ends[e] - cells.rays(begin + e);
                cells.means(begin + e, &light[of_cell], &taps[of_cell * filter.taps_of_both()],
                            &means[e * cells.pixels_around()]);
            }
        });
        for (std::size_t e = 0; e < end - begin; ++e)
            cells.add(begin + e, &means[e * cells.pixels_around()]);
        begin = end;
    }
    return cells.pixels();
}

} // namespace gradus
