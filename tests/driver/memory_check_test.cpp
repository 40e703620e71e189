// What renders are said to take of memory, against what they allocate.
#include "driver/memory_check.h"

#include "planning/make_method.h"
#include "runtime/device/device.h"
#include "tests/methods/reference_scene.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <ostream>
#include <string>

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
    options.batch_size = 4096;
    options.photons = 1000;
    return options;
}

/// At the most at one time, for an image so wide and high: so large that the solver takes one channel after the other.
/// `radius`: of a tent filter; 0: a box.
double allocated(const MemoryCase &c, double side, float radius = 0) {
    Scene scene = own_scene("cornell-box.xml", std::uint32_t(side), std::uint32_t(side));
    if (radius > 0) {
        scene.film.filter = FilmSettings::Filter::tent;
        scene.film.filter_radius = radius;
    }
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

/// Where samples are taken around the image.
TEST(BytesAround, AreWhatFiltersAllocate) {
    constexpr double side = 320;
    for (const float radius : {2.0f, 20.0f}) {
        Scene scene = own_scene("cornell-box.xml", std::uint32_t(side), std::uint32_t(side));
        scene.film.filter = FilmSettings::Filter::tent;
        scene.film.filter_radius = radius;
        const MemoryCase c{"pt"};
        const double more = allocated(c, side, radius) - allocated(c, side);
        const auto told = double(bytes_around(scene, c.method, options_of(c)));
        fmt::print("radius {}: {:.0f} bytes more, told {:.0f}\n", radius, more, told);
        EXPECT_NEAR(told / more, 1, 0.15);
    }
    EXPECT_EQ(bytes_around(own_scene("cornell-box.xml", 8, 8), "gpt", {}), 0u);
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

class ContainerBytes : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "gradus-groups-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    void write(const std::string &file, const std::string &text) const {
        std::filesystem::create_directories((folder / file).parent_path());
        std::ofstream(folder / file) << text << '\n';
    }
    std::uint64_t left() const { return container_bytes(folder / "groups", folder / "trees"); }

    std::filesystem::path folder;
    const std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
};

TEST_F(ContainerBytes, AreTheLeastOfAllGroupsThatTheProcessIsIn) {
    EXPECT_EQ(left(), unlimited) << "no group at all";
    write("groups", "4:cpu:/a/b\n0::/user.slice/job.scope/step");
    EXPECT_EQ(left(), unlimited);
    write("trees/user.slice/memory.max", "5000");
    write("trees/user.slice/memory.current", "1000");
    EXPECT_EQ(left(), 4000u);
    write("trees/user.slice/job.scope/memory.max", "3000");
    write("trees/user.slice/job.scope/memory.current", "900");
    write("trees/user.slice/job.scope/memory.stat", "anon 300\ninactive_file 500\nactive_file 100");
    EXPECT_EQ(left(), 2600u) << "without the files that were read";
    write("trees/user.slice/job.scope/step/memory.max", "max");
    write("trees/user.slice/job.scope/step/memory.current", "10");
    EXPECT_EQ(left(), 2600u);
    write("trees/a/b/memory.max", "1");
    write("trees/a/b/memory.current", "1");
    EXPECT_EQ(left(), 2600u) << "of others";
    write("trees/memory.max", "2000");
    write("trees/memory.current", "1900");
    EXPECT_EQ(left(), 100u) << "the root of a container is a group as others are";
}

TEST_F(ContainerBytes, AreToldByTheFirstVersionOfGroupsToo) {
    write("groups", "4:memory:/slurm/job\n0::/");
    write("trees/memory/slurm/job/memory.limit_in_bytes", "9223372036854771712");
    write("trees/memory/slurm/job/memory.usage_in_bytes", "1000");
    EXPECT_GT(left(), 1u << 30);
    write("trees/memory/slurm/memory.limit_in_bytes", "3000");
    write("trees/memory/slurm/memory.usage_in_bytes", "2000");
    write("trees/memory/slurm/memory.stat", "inactive_file 1\ntotal_inactive_file 700");
    EXPECT_EQ(left(), 1700u);
}

} // namespace
} // namespace gradus::testing
