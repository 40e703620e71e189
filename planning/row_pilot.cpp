#include "planning/row_pilot.h"

#include "runtime/film/metrics.h"
#include "runtime/scene/traits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace gradus {

namespace {

/// Of the film's 64-bit sample numbers.
constexpr std::uint64_t first_sample = (std::uint64_t(1) << 62) + (std::uint64_t(2) << 32);

/// Launching the pilot's kernels takes as long as so many paths; a render has a pilot if it has so many.
constexpr std::uint64_t paths_like_launches = 50'000, fewest_paths = 400'000;
constexpr std::uint64_t paths_a_path_of_pilot = 64;
constexpr double fewest_rows = 8, most_rows = 64;

/// Columns of a block; its rows are a pair.
constexpr std::size_t block_columns = 16;
constexpr int frequencies = 64;
constexpr double largest_quotient = 1e8; // of variances, where differences have none

// Costs over that of a ray of a path tracer, the vertex that it meets counted in, from measured times of 16 scenes.
// What a ray of an offset path costs, its shift and shading counted in: 1.4 to 1.6 but for large meshes, where tracing
// decides, and less.
constexpr double offset_ray_cost = 1.5;
/// Where lights are chosen from a tree, each offset vertex walks it too.
constexpr double light_tree_cost = 0.8;
/// A vertex whose BSDF has a mirror beside a rough lobe, in `shift`, which does not vectorise.
constexpr double mixed_shift_cost = 5;
/// Looking up textures where a path's ray has met a surface.
constexpr double texture_cost = 1;

/// Means over the channels and the pixels of a block, but for differences that lead out of it.
struct Block {
    double brightness = 0, primal = 0, across = 0, down = 0;
};

class BlockReader {
  public:
    explicit BlockReader(const GradientPathTracer::Rows &rows)
        : width_(rows.image.width), image_(rows.image), primal_(planes(rows.films, GradientFilm::primal)),
          across_(planes(rows.films, GradientFilm::dx)), down_(planes(rows.films, GradientFilm::dy)) {}

    Block block(std::size_t row, std::size_t first, std::size_t columns) const {
        Block block;
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t y = 0; y < 2; ++y)
                for (std::size_t x = first; x < first + columns; ++x) {
                    const std::size_t pixel = (row + y) * width_ + x, value = c * pixels() + pixel;
                    block.brightness += image_.channels[c].values[pixel];
                    block.primal += primal_[value];
                    block.across += x + 1 < width_ ? across_[value] : 0;
                    block.down += y == 0 ? down_[value] : 0;
                }
        const double values = 6 * double(columns);
        block.brightness /= values;
        block.primal /= values;
        block.down /= 0.5 * values;
        // A last column by itself has no difference across.
        const double values_across = values - (first + columns == width_ ? 6 : 0);
        block.across = values_across > 0 ? block.across / values_across : block.down;
        return block;
    }

  private:
    std::size_t pixels() const { return primal_.size() / 3; }
    static std::vector<float> planes(const GradientFilms &films, GradientFilm::Layer layer) {
        std::vector<float> values(3 * films.pixels());
        const PlaneSource variance = films.variance_of_samples(layer);
        for (std::uint32_t c = 0; c < 3; ++c)
            variance(c, values.data() + c * films.pixels());
        return values;
    }

    std::size_t width_;
    const Image &image_;
    std::vector<float> primal_, across_, down_; ///< variances of means
};

PathCosts costs_of(const GradientPathTracer &method, const Statistics &statistics, std::uint64_t beside) {
    const auto rays = [&](const char *kind) {
        const auto found = statistics.rays.find(kind);
        return found == statistics.rays.end() ? 0.0 : double(found->second);
    };
    const double extension = rays("extension") - double(beside);
    PathCosts costs;
    costs.pt = extension + rays("shadow");
    if (method.has("TRAIT_TEXTURED"))
        costs.pt += texture_cost * extension;
    const double offset = rays("offset");
    costs.gpt = costs.pt + (offset_ray_cost + (method.has("TRAIT_LIGHT_TREE") ? light_tree_cost : 0)) * offset;
    for (const StageTime &stage : statistics.stages)
        for (const std::string &kind : all_bsdf_kinds())
            if (bsdf_kind_is_mixed(kind) && stage.name == "shift " + kind)
                costs.gpt += mixed_shift_cost * double(stage.items);
    const double samples = std::max(double(statistics.samples), 1.0);
    return {costs.pt / samples, costs.gpt / samples};
}

/// Rows, in pairs, that so many paths of the pilot make.
std::uint32_t rows_of_paths(double paths, std::uint32_t width, std::uint32_t height) {
    if (height < 2 || width < 2)
        return 0;
    const double rows = std::clamp(paths / (double(pilot_samples) * width), fewest_rows, most_rows);
    return std::min(std::uint32_t(rows), height) / 2 * 2;
}

} // namespace

double part_left(double across, double down) {
    double sum = 0;
    for (int i = 0; i < frequencies; ++i) {
        // Over l the mean is known: of 1 / (c + d (2 - 2 cos l)) it is 1 / sqrt(c (c + 4 d)).
        const double c = 1 + across * (2 - 2 * std::cos((i + 0.5) * M_PI / frequencies));
        sum += 1 / std::sqrt(c * (c + 4 * down));
    }
    return sum / frequencies;
}

std::uint32_t rows_of_pilot(std::uint32_t width, std::uint32_t height, std::uint64_t samples_per_pixel, bool must) {
    const double paths = double(width) * height * double(samples_per_pixel);
    if (paths < double(fewest_paths) && !must)
        return 0;
    return rows_of_paths(paths / double(paths_a_path_of_pilot), width, height);
}

std::uint32_t rows_of_timed_pilot(std::uint32_t width, std::uint32_t height) {
    return rows_of_paths(double(paths_like_launches), width, height);
}

std::uint64_t samples_within(double seconds, const RowPilot &pilot, std::uint32_t rows, std::uint32_t height) {
    const double of_a_sample = pilot.seconds / double(pilot_samples) * double(height) / double(rows);
    return std::uint64_t(std::clamp(seconds / std::max(of_a_sample, 1e-9), 1.0, 0x1p40));
}

RowPilot run_row_pilot(GradientPathTracer &method, std::uint32_t rows) {
    const GradientPathTracer::Rows rendered = method.render_rows(rows, first_sample, pilot_samples);
    const BlockReader reader(rendered);
    double sum = 0, left = 0, pixels = 0;
    const std::size_t width = rendered.image.width;
    for (std::size_t row = 0; row < rows; row += 2)
        for (std::size_t first = 0; first < width; first += block_columns) {
            const std::size_t columns = std::min(block_columns, width - first);
            const Block block = reader.block(row, first, columns);
            // A firefly makes its block brighter, and so counts for less.
            const double error = block.primal / (block.brightness * block.brightness + relative_mse_epsilon);
            const auto quotient = [&](double variance) {
                return variance > 0 ? std::min(block.primal / variance, largest_quotient) : largest_quotient;
            };
            sum += double(columns) * error;
            left += double(columns) * (error > 0 ? error * part_left(quotient(block.across), quotient(block.down)) : 0);
            pixels += double(columns);
        }
    const Statistics statistics = method.statistics();
    RowPilot pilot;
    pilot.error = sum / pixels * double(pilot_samples);
    pilot.left = sum > 0 ? left / sum : 1;
    pilot.costs = costs_of(method, statistics, rendered.primaries_beside);
    pilot.seconds = statistics.render_seconds;
    return pilot;
}

} // namespace gradus
