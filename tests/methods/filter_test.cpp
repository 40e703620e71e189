// Pixel filters: an edge that the camera sees against the filters' integrals, and a whole image against a fine one that
// is filtered afterwards.
#include "runtime/scene/filter_table.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <fmt/format.h>

#include <array>
#include <functional>
#include <numeric>

namespace gradus::testing {
namespace {

struct FilterCase {
    std::string name;
    FilmSettings::Filter filter;
    float radius, stddev;

    void set(FilmSettings &film) const {
        film.filter = filter;
        film.filter_radius = radius;
        film.filter_stddev = stddev;
    }
    /// Share of the filter left of x.
    double below(double x) const {
        switch (filter) {
        case FilmSettings::Filter::box:
            return std::clamp(x + 0.5, 0.0, 1.0);
        case FilmSettings::Filter::tent: {
            const double t = std::clamp(x / radius, -1.0, 1.0);
            return t < 0 ? 0.5 * (1 + t) * (1 + t) : 1 - 0.5 * (1 - t) * (1 - t);
        }
        case FilmSettings::Filter::gaussian: {
            const double t = std::clamp(x, -double(radius), double(radius)), scale = std::sqrt(2.0) * stddev;
            return 0.5 + 0.5 * std::erf(t / scale) / std::erf(radius / scale);
        }
        default:
            return integral(x) / integral(radius);
        }
    }
    /// Of the filter up to x, by the midpoint rule.
    double integral(double x) const {
        constexpr int steps = 20000;
        FilmSettings film;
        set(film);
        const double width = (std::clamp(x, -double(radius), double(radius)) + radius) / steps;
        double sum = 0;
        for (int i = 0; i < steps; ++i)
            sum += width * filter_value(film, (i + 0.5) * width - radius);
        return sum;
    }
};

void PrintTo(const FilterCase &c, std::ostream *out) { *out << c.name; }

class Filter : public ::testing::TestWithParam<FilterCase> {};

TEST_P(Filter, SpreadsAnEdgeByItsIntegral) {
    constexpr std::uint32_t size = 16;
    constexpr std::uint64_t samples = 1024;
    constexpr double edge = 7.3; // pixels from the left, or from the top
    for (const bool upright : {true, false}) {
        SceneMaker maker(size, samples);
        maker.look({0, 0, 0}, {0, 0, 1}, 90); // at z = 1 the film is 2 wide; +x is to the left, +y up
        GetParam().set(maker.scene.film);
        maker.scene.settings.max_depth = 1;
        const std::uint32_t black = maker.material(diffuse(0));
        const std::int32_t emitter = maker.emitter(Emitter::Kind::area, {1, 1, 1});
        const float at = float(1 - 2 * edge / size);
        // Right of the edge, or below it; faces the camera.
        if (upright)
            maker.parallelogram({at - 10, -5, 1}, {0, 10, 0}, {10, 0, 0}, black, emitter);
        else
            maker.parallelogram({-5, at - 10, 1}, {0, 10, 0}, {10, 0, 0}, black, emitter);
        const Image image = render(maker.scene).image;
        for (std::uint32_t i = 0; i < size; ++i) {
            double mean = 0;
            for (std::uint32_t j = 0; j < size; ++j)
                mean += pixel(image, upright ? i : j, upright ? j : i) / size;
            const double expected = 1 - GetParam().below(edge - (i + 0.5));
            // All pixels of a row or column have the same places, in a sequence that fills the pixel evenly.
            EXPECT_NEAR(mean, expected, 3.0 / double(samples) + 2e-5) << (upright ? "column " : "row ") << i;
        }
    }
}

/// A wall of two grays under light from everywhere, whose paths have no noise but their places in the pixel.
TEST_P(Filter, IsThatOfGradientsToo) {
    constexpr std::uint32_t width = 16, height = 4;
    constexpr std::size_t seeds = 8;
    constexpr double edge = 7.3, light = 0.8, dark = 0.2;
    SceneMaker maker(width, 512);
    maker.look({0, 0, 0}, {0, 0, 1}, 90); // at z = 1 the film is 2 wide; +x is to the left, +y up
    GetParam().set(maker.scene.film);
    maker.scene.film.height = height;
    maker.scene.settings.max_depth = 2;
    maker.environment(1);
    const float at = float(1 - 2 * edge / width);
    maker.parallelogram({at - 10, -5, 1}, {0, 10, 0}, {10, 0, 0}, maker.material(diffuse(dark)));
    maker.parallelogram({at, -5, 1}, {0, 10, 0}, {10, 0, 0}, maker.material(diffuse(light)));
    RenderOptions options;
    options.strategy = RenderOptions::Strategy::bsdf;
    const std::vector<Image> images = render_seeds(maker.scene, seeds, options, 1, "gpt");
    const auto expected = [&](double x) { return dark + (light - dark) * (1 - GetParam().below(x + 0.5 - edge)); };
    for (std::uint32_t x = 0; x + 1 < width; ++x) {
        std::vector<double> primals, steps;
        for (const Image &image : images) {
            primals.push_back(pixel(image, x, 1, "primal.G"));
            steps.push_back(pixel(image, x, 1, "dx.G"));
        }
        // Six of seven degrees of freedom: one test in 4000 fails by chance if none of them has a bias.
        const Spread primal = spread_of(primals), step = spread_of(steps);
        EXPECT_NEAR(primal.mean, expected(x), 6 * primal.standard_error + 1e-3) << x;
        EXPECT_NEAR(step.mean, expected(x + 1) - expected(x), 6 * step.standard_error + 1e-3) << x;
    }
}

/// At its edges too: samples around it are those of the whole image.
TEST_P(Filter, OfACropIsThatOfTheWhole) {
    Scene scene = own_scene("cornell-box.xml", 24, 18);
    scene.settings.samples_per_pixel = 4;
    GetParam().set(scene.film);
    RenderOptions options;
    options.aov = true;
    const Image whole = render(scene, options).image;
    for (const auto &[x, y, width, height] : {std::array{0u, 0u, 5u, 4u}, {19u, 14u, 5u, 4u}, {7u, 3u, 1u, 9u}}) {
        scene.film.crop_x = x;
        scene.film.crop_y = y;
        scene.film.crop_width = width;
        scene.film.crop_height = height;
        const Image crop = render(scene, options).image;
        for (const char *name : {"R", "albedo.G", "depth.Z", "variance.B"})
            for (std::uint32_t row = 0; row < height; ++row)
                for (std::uint32_t column = 0; column < width; ++column)
                    ASSERT_EQ(crop.find(name)->values[row * width + column],
                              whole.find(name)->values[(y + row) * whole.width + x + column])
                        << name << " at " << x + column << ", " << y + row;
    }
}

TEST_P(Filter, EqualsAFineImageFilteredAfterwards) {
    constexpr std::uint32_t size = 36, fine = 8, margin = 2; // pixels, parts of each, and what is left out around
    constexpr std::uint32_t inner = size - 2 * margin;
    constexpr std::size_t seeds = 10;
    if (GetParam().radius > margin)
        return; // the edge shows it
    Scene coarse_scene = own_scene("cornell-box.xml", size, size);
    coarse_scene.settings.samples_per_pixel = 64;
    GetParam().set(coarse_scene.film);
    // The same for all filters.
    static const std::vector<Image> fine_images = [] {
        Scene scene = own_scene("cornell-box.xml", size * fine, size * fine);
        scene.settings.samples_per_pixel = 1;
        return render_seeds(scene, seeds, {}, 100);
    }();

    // Weights of the fine pixels around the center of a coarse one.
    constexpr std::uint32_t reach = (2 * margin + 1) * fine;
    std::vector<double> weights(reach);
    for (std::uint32_t i = 0; i < reach; ++i) {
        const double left = double(i) / fine - margin - 0.5;
        weights[i] = GetParam().below(left + 1.0 / fine) - GetParam().below(left);
    }
    const auto inner_image = [](const Image &image,
                                const std::function<std::vector<float>(const std::vector<float> &)> &inner_part) {
        Image result;
        result.width = result.height = inner;
        for (const Channel &channel : image.channels)
            result.channels.push_back({channel.name, inner_part(channel.values)});
        return result;
    };
    const auto cropped = [](const std::vector<float> &values) {
        std::vector<float> part;
        for (std::uint32_t y = margin; y < margin + inner; ++y)
            part.insert(part.end(), &values[y * size + margin], &values[y * size + margin + inner]);
        return part;
    };
    // Along rows, then along columns: a filter is a product of two.
    const auto convolved_and_cropped = [&weights](const std::vector<float> &values) {
        std::vector<double> narrow;
        for (std::uint32_t row = 0; row < size * fine; ++row)
            for (std::uint32_t x = 0; x < inner; ++x)
                narrow.push_back(
                    std::inner_product(weights.begin(), weights.end(), &values[(row * size + x) * fine], 0.0));
        std::vector<float> part;
        for (std::uint32_t y = 0; y < inner; ++y)
            for (std::uint32_t x = 0; x < inner; ++x) {
                double sum = 0;
                for (std::uint32_t j = 0; j < reach; ++j)
                    sum += weights[j] * narrow[(y * fine + j) * inner + x];
                part.push_back(float(sum));
            }
        return part;
    };
    std::vector<Image> filtered, convolved;
    for (const Image &image : render_seeds(coarse_scene, seeds, {}, 1))
        filtered.push_back(inner_image(image, cropped));
    for (const Image &image : fine_images)
        convolved.push_back(inner_image(image, convolved_and_cropped));
    // In this order: neighbours are correlated where one fine image served both, which only the first may be.
    EXPECT_TRUE(agree("filter-" + GetParam().name, convolved, filtered, 64));
}

std::string name_of_filter(const ::testing::TestParamInfo<FilterCase> &info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Film, Filter,
                         ::testing::Values(FilterCase{"box", FilmSettings::Filter::box, 0.5f, 0.5f},
                                           FilterCase{"tent", FilmSettings::Filter::tent, 1, 0.5f},
                                           FilterCase{"gaussian", FilmSettings::Filter::gaussian, 2, 0.5f},
                                           FilterCase{"mitchell", FilmSettings::Filter::mitchell, 2, 0.5f},
                                           FilterCase{"lanczos", FilmSettings::Filter::lanczos, 3, 0.5f}),
                         name_of_filter);
INSTANTIATE_TEST_SUITE_P(Full, Filter,
                         ::testing::Values(FilterCase{"wide_tent", FilmSettings::Filter::tent, 1.7f, 0.5f},
                                           FilterCase{"cut_gaussian", FilmSettings::Filter::gaussian, 1.2f, 0.8f},
                                           FilterCase{"catmullrom", FilmSettings::Filter::catmullrom, 2, 0.5f}),
                         name_of_filter);

/// However few samples there are.
TEST(ConstantImage, StaysUnderAnyFilter) {
    using Filter = FilmSettings::Filter;
    for (const auto filter : {Filter::box, Filter::tent, Filter::gaussian, Filter::mitchell, Filter::lanczos}) {
        for (const std::uint64_t samples : {1, 4, 5}) {
            SceneMaker maker(16, samples);
            maker.look({0, 0, 0}, {0, 0, 1}, 90);
            maker.scene.film.filter = filter;
            maker.scene.film.filter_radius = filter == Filter::lanczos ? 3 : 2;
            maker.sphere({0, 0, -5}, 0.1f, maker.material(diffuse(0.5))); // behind the camera
            maker.environment(0.75);
            const Spread spread = spread_of(render(maker.scene).image);
            const double rounding = filter == Filter::box ? 0 : 1e-6; // of weights
            EXPECT_NEAR(spread.least, 0.75, rounding) << samples;
            EXPECT_NEAR(spread.most, 0.75, rounding) << samples;
        }
    }
}

} // namespace
} // namespace gradus::testing
