// What renders are said to take of memory, against what they allocate.
#include "driver/memory_check.h"

#include "planning/make_method.h"
#include "runtime/device/device.h"
#include "tests/methods/reference_scene.h"

#include <fmt/format.h>

#include <memory>
#include <ostream>

namespace gradus::testing {
namespace {

struct MemoryCase {
    const char *method;
    Reconstruction reconstruction = Reconstruction::weighted;
    bool aov = false, error = false;
    std::uint64_t samples = 4; ///< of each pixel
    bool variance = true;      ///< with aov
    SessionOptions::Sampler sampler = SessionOptions::Sampler::sobol;
};

std::ostream &operator<<(std::ostream &out, const MemoryCase &c) {
    return out << c.method << '_' << reconstruction_name(c.reconstruction) << (c.aov ? "_aov" : "")
               << (c.error ? "_error" : "") << '_' << c.samples << (c.variance ? "" : "_no_variance")
               << (c.sampler == SessionOptions::Sampler::sobol ? "" : "_independent");
}

RenderOptions options_of(const MemoryCase &c) {
    RenderOptions options;
    options.reconstruction = c.reconstruction;
    options.aov = c.aov;
    options.error = c.error;
    options.variance = c.variance;
    options.sampler = c.sampler;
    options.batch_size = 2048;
    options.photons = 1000;
    return options;
}

/// At the most at one time, for an image so wide and high: so large that the solver takes one channel after the other.
double allocated(const MemoryCase &c, double side) {
    Scene scene = own_scene("cornell-box.xml", std::uint32_t(side), std::uint32_t(side));
    scene.settings.max_depth = 2;
    scene.settings.samples_per_pixel = c.samples;
    Device device;
    const std::unique_ptr<Method> method = make_method(c.method, device, scene, options_of(c));
    while (method->render_batch()) {
    }
    method->last_image();
    return double(method->statistics().device_bytes);
}

class BytesOfPixel : public ::testing::TestWithParam<MemoryCase> {};

TEST_P(BytesOfPixel, AreWhatRendersAllocate) {
    constexpr double small = 320, large = 384; // of whole tiles of the solver
    const double of_small = allocated(GetParam(), small), of_large = allocated(GetParam(), large);
    const double growth = (of_large - of_small) / (large * large - small * small);
    const auto told = double(bytes_of_pixel(GetParam().method, options_of(GetParam()), GetParam().samples));
    fmt::print("{:.1f} bytes a pixel, {:.1f} each more, told {}\n", of_large / (large * large), growth, told);
    EXPECT_LE(told, of_large / (large * large)) << "renders that fit would be refused";
    // Small images grow by more: by the borders of the solver's planes.
    EXPECT_GE(told, growth * 0.8) << "renders that do not fit would be begun";
}

INSTANTIATE_TEST_SUITE_P(Methods, BytesOfPixel,
                         ::testing::Values(MemoryCase{"pt"}, MemoryCase{"pt", Reconstruction::weighted, true},
                                           MemoryCase{"pt", Reconstruction::weighted, false, true},
                                           MemoryCase{"pt", Reconstruction::guided}, MemoryCase{"gpt"},
                                           MemoryCase{"gpt", Reconstruction::weighted, false, false, 1},
                                           MemoryCase{"gpt", Reconstruction::weighted, true, false, 4, false},
                                           MemoryCase{"sppm"}, MemoryCase{"sppm", Reconstruction::weighted, true},
                                           MemoryCase{"gpm", Reconstruction::weighted, true}));

INSTANTIATE_TEST_SUITE_P(Full, BytesOfPixel,
                         ::testing::Values(MemoryCase{"gpt", Reconstruction::l1},
                                           MemoryCase{"gpt", Reconstruction::guided},
                                           MemoryCase{"gpt", Reconstruction::weighted, true},
                                           MemoryCase{"gpt", Reconstruction::l1, true, false, 4, false},
                                           MemoryCase{"pt", Reconstruction::weighted, true, false, 4, false},
                                           MemoryCase{"pt", Reconstruction::weighted, true, false, 4, true,
                                                      SessionOptions::Sampler::independent},
                                           MemoryCase{"pt", Reconstruction::guided, false, false, 1},
                                           MemoryCase{"sppm", Reconstruction::weighted, true, false, 4, false},
                                           MemoryCase{"gpm", Reconstruction::l1}, MemoryCase{"gpm"},
                                           MemoryCase{"gpm", Reconstruction::guided}));

} // namespace
} // namespace gradus::testing
