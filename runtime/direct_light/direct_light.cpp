#include "runtime/direct_light/direct_light.h"

#include "runtime/trace/camera_rays.h"

#define TRAIT_LIGHT_TRIANGLE 1
#define TRAIT_LIGHT_SPHERE 1
#define TRAIT_LIGHT_CONSTANT 1
#define TRAIT_LIGHT_ENVIRONMENT 1
#define TRAIT_LIGHT_TEXTURES (2 * textures_of_meshes - 1)
#include "kernels/lib/additive_sequence.h"
#include "kernels/lib/escaped_light.h"
#include "kernels/lib/filter_table.h"
#include "kernels/lib/light_texture.h"
#include "kernels/lib/stratified.h"
#include "kernels/shared/tables.h"
#include "runtime/direct_light/lit_rectangle.h"
#include "runtime/direct_light/shared_rays.h"
#include "runtime/film/metrics.h"
#include "runtime/scene/environment_map.h"
#include "runtime/scene/filter_table.h"

#include <algorithm>
#include <cmath>

namespace gradus {

using namespace lib_float;

namespace {

constexpr std::uint32_t pilot_side = 2;
constexpr double rays_a_sample = 1; // of the image; a sample of a path takes a dozen
/// Rays go by this power of a pixel's relative variance. Of errors that fell as one over the square of the rays the
/// third root would leave least; of 600 lanterns the fourth does: a tenth less than the third, a quarter less than the
/// second. (Where there are rays enough for all pixels, equal shares do as well.)
constexpr double power_of_need = 0.25;
/// Through a pixel at an edge. Their error falls nearly as one over their number and is below a hundredth of the light
/// long before these: more would cost and gain nothing.
constexpr std::uint32_t least_of_most = 256, most_a_sample = 32, most_samples = 4096;
constexpr std::size_t batch = 1 << 16;

/// What camera rays see of lights, a batch at a time.
class DirectRays {
  public:
    DirectRays(const SceneTables &tables, Tracer &tracer, std::uint64_t &rays)
        : tables_(tables), tracer_(tracer), rays_(rays) {}

    /// The light along `count` rays: ray i goes through place(i). `as_one`: an
    /// environment's map is taken for one colour, since it changes everywhere and it is its border that is sought.
    template <class Place>
    const std::vector<rgb> &trace(std::size_t count, bool as_one, const Place &place) {
        rays_ += camera_rays_.trace(tables_, tracer_, count, place);
        light_.resize(count);
        tracer_.in_parallel(count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                light_[i] = light_along(i, as_one);
        });
        return light_;
    }

  private:
    static constexpr std::uint32_t unit = 1; // of FIELD_OF

    rgb light_along(std::size_t i, bool as_one) const {
        const float *lights = tables_.lights.data();
        const std::uint32_t primitive = camera_rays_.primitive(i);
        if (primitive == ray_escaped) {
            if (as_one || !tables_.environment)
                return FIELD_RGB(light, lights, tables_.environment_light, value);
            const EnvironmentMap &map = *tables_.environment;
            return light_escaped(lights, tables_.environment_light, unit, camera_rays_.direction(i), map.texels.data(),
                                 map.cells.data(), map.strips.data(), map.columns, map.rows,
                                 std::uint32_t(map.strips.size() / 2))
                .radiance;
        }
        const std::uint32_t light = tables_.light_of(primitive);
        if (light == no_light)
            return rgb_gray(0);
        const primitive_hit hit = camera_rays_.hit(tables_, i);
        const rgb found = light_found_as(light, lights, tables_.light_count, unit, tables_.triangle_count, primitive,
                                         hit, camera_rays_.origin(i), camera_rays_.direction(i))
                              .radiance;
        return tables_.light_textures.empty() ? found : textured(found, light, primitive, hit, as_one);
    }

    /// The light of a surface that may have a texture; `as_one`: as if it were its mean.
    rgb textured(rgb found, std::uint32_t light, std::uint32_t primitive, const primitive_hit &hit, bool as_one) const {
        if (texture_is_absent(FIELD_OF(light_texture, tables_.light_textures.data(), light, texture)))
            return found;
        const float *mean = &tables_.light_means[std::size_t(light) * 3];
        if (as_one)
            return rgb_max(found) > 0 ? rgb3(mean[0], mean[1], mean[2]) : found;
        const std::uint32_t texture = FIELD_OF(light_texture, tables_.light_textures.data(), light, texture);
        return rgb_mul(found, light_texture_at(tables_.textures.data(), tables_.texture_reals.data(),
                                               tables_.texels.data(), unit, texture, place_of(light, primitive, hit)));
    }

    texture_point place_of(std::uint32_t light, std::uint32_t primitive, const primitive_hit &hit) const {
        if (primitive < tables_.triangle_count) {
            const std::array<float, 6> uv = tables_.texcoords(primitive);
            const std::array<std::uint32_t, 3> corners = tables_.triangle(primitive).corners;
            const triangle_uv of_corners{uv[0], uv[1], uv[2], uv[3], uv[4], uv[5], corners[0], corners[1], corners[2]};
            return point_of_triangle(of_corners, primitive, hit.u, hit.v);
        }
        const float facing = FIELD_OF(light, tables_.lights.data(), light, e1_y);
        return point_of_sphere(sphere_place(tables_.sphere_axes.data(), unit, primitive - tables_.triangle_count,
                                            v3_scale(hit.normal, facing)));
    }

    const SceneTables &tables_;
    Tracer &tracer_;
    std::uint64_t &rays_;
    CameraRays camera_rays_;
    std::vector<rgb> light_;
};

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

/// What of the pixel filter lies over each pixel of a row around its own, `reach` to either side: of its values, and of
/// their magnitudes. Spread by half a pixel, since of where within a pixel an edge lies pilot rays tell little.
struct FilterShares {
    std::vector<double> values, magnitudes;
    double all = 0; ///< magnitudes

    template <class Sampler>
    FilterShares(int reach, const Sampler &from_center) : values(2 * reach + 1), magnitudes(values) {
        constexpr int draws = 1024;
        for (int i = 0; i < draws; ++i) {
            const filter_sample sample = from_center((float(i) + 0.5f) / draws);
            all += std::abs(sample.weight) / draws;
            for (int side : {-1, 0, 0, 1}) {
                const long at = std::clamp(std::lround(sample.offset) + side, long(-reach), long(reach)) + reach;
                values[std::size_t(at)] += 0.25 * sample.weight / draws;
                magnitudes[std::size_t(at)] += 0.25 * std::abs(sample.weight) / draws;
            }
        }
    }
};

struct EdgePixels {
    std::vector<std::size_t> pixels;
    std::vector<float> needs; ///< of rays: by the relative variance of a pilot ray's light; positive
};

/// Pixels of the crop near which the pilot rays see different light. Beyond the `lit` ones all would see none.
EdgePixels edge_pixels(const FilmSettings &film, const PixelRectangle &lit, DirectRays &rays, int reach,
                       const FilterShares &filter) {
    // Of each lit pixel its first light, whether its rays saw another, and means of their brightness and its square.
    constexpr std::size_t pilots = pilot_side * pilot_side;
    std::vector<rgb> seen(std::size_t(lit.width()) * lit.height());
    std::vector<char> mixed(seen.size(), 0);
    std::vector<std::array<float, 2>> moments(seen.size());
    for (std::size_t begin = 0; begin < seen.size();) {
        const std::size_t end = std::min(seen.size(), begin + batch / pilots);
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
                const float brightness = std::min(1e15f, (first[i].r + first[i].g + first[i].b) / 3);
                moments[number][0] += brightness / pilots;
                moments[number][1] += brightness * brightness / pilots;
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
    const PixelRectangle around{lit.left - std::min(lit.left, 1u), lit.top - std::min(lit.top, 1u),
                                std::min(lit.right + 1, film.crop_width), std::min(lit.bottom + 1, film.crop_height)};
    const WindowSums mixes(around, is_mixed);
    const WindowSums across(around, [&](int x, int y) { return differ(seen_at(x, y), seen_at(x - 1, y)); });
    const WindowSums down(around, [&](int x, int y) { return differ(seen_at(x, y), seen_at(x, y - 1)); });
    const auto need_of = [&](int x, int y) {
        double mean = 0, square = 0;
        for (int j = -reach; j <= reach; ++j)
            for (int i = -reach; i <= reach; ++i)
                if (lit.contains(x + i, y + j)) {
                    const auto [of_light, of_square] = moments[number_of(x + i, y + j)];
                    mean += filter.values[reach + i] * filter.values[reach + j] * of_light;
                    square += filter.magnitudes[reach + i] * filter.magnitudes[reach + j] * of_square;
                }
        const double variance = filter.all * filter.all * square - mean * mean;
        return float(std::pow(std::max(variance, 0.0) / (mean * mean + relative_mse_epsilon), power_of_need));
    };
    constexpr float least_need = 1e-6f; // where colours differ and brightness does not
    EdgePixels found;
    for (int y = std::max(int(lit.top) - reach, 0); y < std::min(int(lit.bottom) + reach, height); ++y)
        for (int x = std::max(int(lit.left) - reach, 0); x < std::min(int(lit.right) + reach, width); ++x) {
            const int left = std::max(x - reach, 0), right = std::min(x + reach + 1, width);
            const int top = std::max(y - reach, 0), bottom = std::min(y + reach + 1, height);
            if (mixes.any(left, top, right, bottom) || across.any(left + 1, top, right, bottom) ||
                down.any(left, top + 1, right, bottom)) {
                found.pixels.push_back(std::size_t(y) * film.crop_width + x);
                found.needs.push_back(std::max(need_of(x, y), least_need));
            }
        }
    return found;
}

} // namespace

std::vector<DirectPixel> sample_direct_edges(const SceneTables &tables, const FilmSettings &film, Tracer &tracer,
                                             std::uint64_t seed, std::uint32_t samples, std::uint64_t &rays) {
    const float radius = tables.camera[camera_filter_radius], deviation = tables.camera[camera_filter_stddev];
    const auto from_center = [&](float u) {
        if (is_signed(film.filter))
            return filter_table_sample(tables.camera.data(), 1, u);
        filter_sample drawn;
        drawn.weight = 1;
        drawn.offset = film.filter == FilmSettings::Filter::tent       ? radius * warp_tent(u)
                       : film.filter == FilmSettings::Filter::gaussian ? warp_gaussian(u, radius, deviation)
                                                                       : u - 0.5f;
        return drawn;
    };
    DirectRays direct(tables, tracer, rays);
    const int reach = film.filter == FilmSettings::Filter::box ? 1 : std::max(1, int(std::ceil(radius)));
    const double budget = rays_a_sample * samples * film.crop_width * film.crop_height;
    const double most = std::min<double>(least_of_most + double(most_a_sample) * samples, most_samples);
    const double least = 2.0 * samples; // the paths' own are better than fewer
    if (most < least)
        return {};
    const EdgePixels edges =
        edge_pixels(film, lit_rectangle(tables, film), direct, reach, FilterShares(reach, from_center));
    const std::vector<std::uint32_t> shares =
        shared_rays(edges.needs, budget, std::uint32_t(least), std::uint32_t(most));
    std::vector<std::size_t> pixels; // those that have rays, and how many
    std::vector<std::uint32_t> counts;
    for (std::size_t i = 0; i < shares.size(); ++i)
        if (shares[i] > 0) {
            pixels.push_back(edges.pixels[i]);
            counts.push_back(shares[i]);
        }
    std::vector<DirectPixel> found;
    std::vector<float> weights;    ///< of the filter, by ray
    std::vector<std::size_t> ends; ///< where the rays of a pixel end, by pixel of the batch
    for (std::size_t begin = 0; begin < pixels.size();) {
        ends.clear();
        std::size_t end = begin, all = 0;
        for (; end < pixels.size() && (end == begin || all + counts[end] <= batch); ++end)
            ends.push_back(all += counts[end]);
        weights.resize(all);
        const std::vector<rgb> &light = direct.trace(all, false, [&](std::size_t ray) {
            const std::size_t e = std::size_t(std::ranges::upper_bound(ends, ray) - ends.begin());
            const std::size_t pixel = pixels[begin + e];
            const std::uint32_t x = film.crop_x + static_cast<std::uint32_t>(pixel % film.crop_width);
            const std::uint32_t y = film.crop_y + static_cast<std::uint32_t>(pixel / film.crop_width);
            const auto number = static_cast<std::uint32_t>(ray - (ends[e] - counts[begin + e]));
            // No path has so high a sample number.
            const random_bits start =
                random_key(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), y * film.width + x,
                           0, 0xFFFFFFFFu);
            const point2 place = additive_sequence(start.x, start.y, number);
            const filter_sample across = from_center(place.x), down = from_center(place.y);
            weights[ray] = across.weight * down.weight;
            CameraPlace at{float(x) + 0.5f + across.offset, float(y) + 0.5f + down.offset};
            if (tables.camera_kind == Camera::Kind::thin_lens) {
                const random4 lens = stratified_draw(start.z, number, random_dimension_camera);
                at.lens_1 = lens.a;
                at.lens_2 = lens.b;
            }
            return at;
        });
        for (std::size_t e = begin; e < end; ++e) {
            const std::uint32_t count = counts[e];
            DirectPixel pixel;
            pixel.pixel = pixels[e];
            const std::size_t first = ends[e - begin] - count, middle = first + count / 2, last = first + count;
            const auto add = [&](double(&sum)[3], std::size_t ray, std::size_t end) {
                for (; ray < end; ++ray) {
                    sum[0] += double(weights[ray]) * light[ray].r;
                    sum[1] += double(weights[ray]) * light[ray].g;
                    sum[2] += double(weights[ray]) * light[ray].b;
                }
            };
            double sum[3] = {}, rest[3] = {};
            add(sum, first, middle);
            add(rest, middle, last);
            const double share = double(middle - first) / count;
            for (int c = 0; c < 3; ++c) {
                const double apart = sum[c] / (share * count) - rest[c] / ((1 - share) * count);
                pixel.variance[c] = static_cast<float>(share * (1 - share) * apart * apart);
                pixel.light[c] = static_cast<float>((sum[c] + rest[c]) / count);
            }
            found.push_back(pixel);
        }
        begin = end;
    }
    return found;
}

} // namespace gradus
