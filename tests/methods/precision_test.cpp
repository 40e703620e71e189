// Kernels in double and in relaxed arithmetic: the images of float but for rounding, and as independent of batches and
// threads as those.
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"

#include <fmt/format.h>

#include <tuple>

namespace gradus::testing {
namespace {

/// A method's name and an arithmetic that is not the default.
class PrecisionOfKernels : public ::testing::TestWithParam<std::tuple<const char *, Precision>> {
  protected:
    const char *method() const { return std::get<0>(GetParam()); }
    Precision precision() const { return std::get<1>(GetParam()); }
    void SetUp() override {
        if (precision() == Precision::double_ && !shared_device().description().has_double)
            GTEST_SKIP() << shared_device().description().name << " has no double precision";
    }
    Image image_of(const Scene &scene, Precision precision, std::uint64_t seed = 1, std::uint32_t batch_size = 0,
                   int threads = 0) const {
        RenderOptions options;
        options.precision = precision;
        options.seed = seed;
        options.batch_size = batch_size;
        options.threads = threads;
        return render(scene, options, method()).image;
    }
};

/// Root mean square, over blocks of 16 x 16 pixels of R, G and B, of the difference of two images' means there.
double block_difference(const Image &a, const Image &b) {
    constexpr std::uint32_t block = 16;
    double squares = 0, count = 0;
    for (const char *channel : {"R", "G", "B"})
        for (std::uint32_t by = 0; by + block <= a.height; by += block)
            for (std::uint32_t bx = 0; bx + block <= a.width; bx += block) {
                double difference = 0;
                for (std::uint32_t y = by; y < by + block; ++y)
                    for (std::uint32_t x = bx; x < bx + block; ++x)
                        difference += double(pixel(a, x, y, channel)) - pixel(b, x, y, channel);
                squares += difference * difference;
                count += 1;
            }
    return std::sqrt(squares / count) / (block * block);
}

// The random numbers are the same, so a path stays the same until rounding decides otherwise: past an edge, or on with
// Russian roulette. Where a share p of the paths parts, images differ with p times the variance of independent ones. A
// path takes less than a hundred such decisions with errors of some 1e-6, which makes p less than 1e-4; 1e-3 is
// allowed.
TEST_P(PrecisionOfKernels, DecidesFewPaths) {
    Scene scene = own_scene("cornell-box.xml", 128, 128);
    scene.settings.samples_per_pixel = 8;
    const Image single = image_of(scene, Precision::single), other = image_of(scene, precision());
    EXPECT_FALSE(equal_bits(single, other)) << "the arithmetic is the same";
    const double noise = block_difference(single, image_of(scene, Precision::single, 2));
    const double share = std::pow(block_difference(single, other) / noise, 2);
    fmt::print("{}, {} against single: a share of {:.1e} of the paths parts\n", method(), precision_name(precision()),
               share);
    EXPECT_LE(share, 1e-3);
}

TEST_P(PrecisionOfKernels, HasOneImageForAllBatchesAndThreads) {
    Scene scene = own_scene("cornell-box.xml", 48, 36);
    scene.settings.samples_per_pixel = 4;
    const Image image = image_of(scene, precision());
    for (const std::uint32_t batch_size : {64u, 1000u})
        EXPECT_TRUE(equal_bits(image, image_of(scene, precision(), 1, batch_size))) << "batch size " << batch_size;
    for (const int threads : {1, 3})
        EXPECT_TRUE(equal_bits(image, image_of(scene, precision(), 1, 0, threads))) << threads << " threads that trace";
}

std::string name_of_case(const ::testing::TestParamInfo<std::tuple<const char *, Precision>> &info) {
    return fmt::format("{}_{}", std::get<0>(info.param), precision_name(std::get<1>(info.param)));
}
INSTANTIATE_TEST_SUITE_P(Methods, PrecisionOfKernels,
                         ::testing::Values(std::tuple("gpt", Precision::double_), std::tuple("pt", Precision::relaxed)),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Full, PrecisionOfKernels,
                         ::testing::Values(std::tuple("pt", Precision::double_), std::tuple("gpt", Precision::relaxed)),
                         name_of_case);

} // namespace
} // namespace gradus::testing
