// Devices that are not the host: tables are copied to the host and back, and work is shared out otherwise. A processor
// that is taken for one gives the same bits, but for what is reconstructed: the solver's tiles have another shape
// there, and products are summed tile by tile.
#include "runtime/device/opencl.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <vector>

namespace gradus::testing {
namespace {

struct ForeignCase {
    const char *method, *scene;
    Precision precision = Precision::single;
};

std::ostream &operator<<(std::ostream &out, const ForeignCase &c) {
    return out << c.method << ' ' << c.scene << (c.precision == Precision::double_ ? " double" : "");
}

double relative_difference(const std::vector<float> &values, const std::vector<float> &expected) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        difference += std::pow(double(values[i]) - expected[i], 2);
        size += std::pow(double(expected[i]), 2);
    }
    return std::sqrt(difference / size);
}

class ForeignDevice : public ::testing::TestWithParam<ForeignCase> {
  protected:
    void SetUp() override {
        DeviceDescription &d = shared_device().implementation().description;
        before_ = d;
        ASSERT_TRUE(d.is_host && d.shares_memory) << "these tests compare with the host's processor";
    }
    void TearDown() override { shared_device().implementation().description = before_; }

    static void take_for_foreign() {
        DeviceDescription &d = shared_device().implementation().description;
        d.is_host = d.shares_memory = false;
    }
    static bool is_reconstructed() { return GetParam().method[0] == 'g'; }
    /// Of so many samples that tables are copied in several parts.
    static Rendered image() {
        Scene scene = own_scene(std::string(GetParam().scene) + ".xml", 160, 90);
        scene.settings.samples_per_pixel = 4;
        RenderOptions options;
        options.precision = GetParam().precision;
        options.layers = is_reconstructed();
        return render(scene, options, GetParam().method);
    }

  private:
    DeviceDescription before_;
};

TEST_P(ForeignDevice, GivesTheSameBits) {
    const Rendered own = image();
    take_for_foreign();
    const Rendered foreign = image();
    ASSERT_EQ(own.image.channels.size(), foreign.image.channels.size());
    for (std::size_t c = 0; c < own.image.channels.size(); ++c) {
        const std::vector<float> &expected = own.image.channels[c].values, &values = foreign.image.channels[c].values;
        SCOPED_TRACE(own.image.channels[c].name);
        if (is_reconstructed() && c < 3)
            EXPECT_LE(relative_difference(values, expected), 1e-4);
        else
            EXPECT_EQ(expected, values);
    }
    EXPECT_EQ(own.statistics.rays, foreign.statistics.rays);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ForeignDevice,
                         ::testing::Values(ForeignCase{"pt", "textures"}, ForeignCase{"gpt", "lanterns"},
                                           ForeignCase{"gpt", "cornell-box", Precision::double_},
                                           ForeignCase{"sppm", "../tests/scenes/instances"},
                                           ForeignCase{"gpm", "torus-smooth-glass"}),
                         [](const auto &info) {
                             return test_name(fmt::format("{}_{}", info.param.method,
                                                          std::filesystem::path(info.param.scene).stem().string()));
                         });

} // namespace
} // namespace gradus::testing
