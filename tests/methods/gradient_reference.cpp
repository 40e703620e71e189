#include "tests/methods/gradient_reference.h"

#include "runtime/film/metrics.h"
#include "tests/support/gradient_layers.h"

#include <algorithm>

namespace gradus::testing {
namespace {

/// The reference of differences, and both images' values times the signs that they have in a third, independent image:
/// a shift whose differences are too small everywhere shows in every block.
class SignedDifferences {
  public:
    SignedDifferences(const ReferenceScene &reference, const Image &independent, bool right)
        : signs_(differences(independent, "", right)), right_(right), expected_(reference) {
        expected_.name += right ? "-dx" : "-dy";
        expected_.mean = signed_by(differences(reference.mean, "", right));
        const Image &variance = reference.variance;
        const Layer of(variance, "");
        expected_.variance = image_of(variance.width, variance.height, [&](int c, std::uint32_t x, std::uint32_t y) {
            const std::uint32_t to_x = right ? x + 1 : x, to_y = right ? y : y + 1;
            return to_x < variance.width && to_y < variance.height ? of(c, to_x, to_y) + of(c, x, y) : 0.0;
        });
        expected_.samples_per_pixel = 0; // the noise of differences is none of the reference's
    }
    std::vector<Image> of(const std::vector<Image> &images) const {
        std::vector<Image> ours;
        for (const Image &image : images)
            ours.push_back(signed_by(whole_differences(image, right_)));
        return ours;
    }
    const ReferenceScene &expected() const { return expected_; }

  private:
    Image signed_by(const Image &image) const {
        const Layer of(image, ""), signs(signs_, "");
        return image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
            return of(c, x, y) * (signs(c, x, y) < 0 ? -1 : 1);
        });
    }

    Image signs_;
    bool right_;
    ReferenceScene expected_;
};

std::vector<Image> wholes(const std::vector<Image> &images) {
    std::vector<Image> primals;
    for (const Image &image : images)
        primals.push_back(whole(image));
    return primals;
}

/// The images, and 0 in some of their layers.
std::vector<Image> without_layers(std::vector<Image> images, const std::vector<std::string> &layers) {
    for (Image &image : images)
        for (Channel &channel : image.channels)
            for (const std::string &layer : layers)
                if (channel.name.starts_with(layer + "."))
                    std::fill(channel.values.begin(), channel.values.end(), 0.0f);
    return images;
}

/// The least share of `planted` by which images may be too small, and are seen to be; 0: none. What is tested goes
/// linearly from `images` to `without`, in which all of it is missing.
double least_seen(const std::vector<double> &planted, const std::vector<Image> &images,
                  const std::vector<Image> &without, double samples_per_pixel, const ReferenceScene &expected) {
    for (const double share : planted) {
        std::vector<Image> wrong = images;
        for (std::size_t i = 0; i < wrong.size(); ++i)
            for (std::size_t c = 0; c < wrong[i].channels.size(); ++c) {
                std::vector<float> &values = wrong[i].channels[c].values;
                for (std::size_t j = 0; j < values.size(); ++j)
                    values[j] += float(share * (without[i].channels[c].values[j] - values[j]));
            }
        if (!is_met(wrong, samples_per_pixel, expected))
            return share;
    }
    return 0;
}

} // namespace

double expect_gradients(const ReferenceScene &reference, const std::vector<Image> &images, double samples_per_pixel,
                        RenderOptions options, const std::vector<double> &planted) {
    Scene scene = reference.scene;
    scene.settings.samples_per_pixel = 32;
    options.seed = 4711;
    const Image independent = render(scene, options).image;
    double score = 0;
    // `of` makes what is tested of the layers.
    const auto expect = [&](const auto &of, const std::vector<std::string> &missing, const ReferenceScene &expected) {
        const std::vector<Image> ours = of(images);
        EXPECT_TRUE(agrees(ours, samples_per_pixel, expected));
        score = std::max(score, largest_score(ours, samples_per_pixel, expected));
        if (planted.empty())
            return;
        const double seen = least_seen(planted, ours, of(without_layers(images, missing)), samples_per_pixel, expected);
        std::printf(seen > 0 ? "%s: %g %% too little would be seen, in some block\n"
                             : "%s: not even %g %% too little would be seen: blunt\n",
                    expected.name.c_str(), 100 * (seen > 0 ? seen : planted.back()));
    };
    ReferenceScene expected = reference;
    expected.name += "-primal";
    expect(wholes, {"primal"}, expected);
    for (const bool right : {true, false}) {
        const SignedDifferences changes(reference, independent, right);
        expect([&](const std::vector<Image> &layers) { return changes.of(layers); }, {"dx", "dy"}, changes.expected());
    }
    return score;
}

double noise_left_by_reconstruction(const ReferenceScene &reference, const std::vector<Image> &images) {
    const double count = double(images.size());
    double ours = 0, plain = 0;
    std::vector<double> ratios;
    for (const Image &image : images) {
        const Layer reconstructed(image, "");
        const Image final = image_of(image.width, image.height,
                                     [&](int c, std::uint32_t x, std::uint32_t y) { return reconstructed(c, x, y); });
        ratios.push_back(compare_means(final, whole(image)).ratio);
        ours += relative_mse(final, reference.mean) / count;
        plain += relative_mse(whole(image), reference.mean) / count;
    }
    const Spread ratio = spread_of(ratios);
    std::printf("%s: relMSE reconstructed %.2e, primal %.2e: %.1f times less; mean over the primal's %.5f +- %.5f\n",
                reference.name.c_str(), ours, plain, plain / ours, ratio.mean, ratio.standard_error);
    EXPECT_NEAR(ratio.mean, 1, std::max(0.01, 4 * ratio.standard_error));
    return ours / plain;
}

void crop(ReferenceScene &reference, std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height) {
    FilmSettings &film = reference.scene.film;
    film.crop_x = x;
    film.crop_y = y;
    film.crop_width = width;
    film.crop_height = height;
    for (Image *image : {&reference.mean, &reference.variance})
        *image = image_of(width, height, [from = *image, x, y](int c, std::uint32_t to_x, std::uint32_t to_y) {
            return layer(from, "", c, x + to_x, y + to_y);
        });
}

} // namespace gradus::testing
