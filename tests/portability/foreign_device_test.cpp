// Devices that are not the host: tables are copied to the host and back, and work is shared out otherwise. A processor
// that is taken for one gives the same bits.
#include "runtime/device/opencl.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>

#include <filesystem>

namespace gradus::testing {
namespace {

struct ForeignCase {
    const char *method, *scene;
    Precision precision = Precision::single;
};

std::ostream &operator<<(std::ostream &out, const ForeignCase &c) {
    return out << c.method << ' ' << c.scene << (c.precision == Precision::double_ ? " double" : "");
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
    /// Of so many samples that tables are copied in several parts.
    static Rendered image() {
        Scene scene = own_scene(std::string(GetParam().scene) + ".xml", 160, 90);
        scene.settings.samples_per_pixel = 4;
        RenderOptions options;
        options.precision = GetParam().precision;
        return render(scene, options, GetParam().method);
    }

  private:
    DeviceDescription before_;
};

TEST_P(ForeignDevice, GivesTheSameBits) {
    const Rendered own = image();
    take_for_foreign();
    const Rendered foreign = image();
    EXPECT_TRUE(equal_bits(own.image, foreign.image));
    EXPECT_EQ(own.statistics.rays, foreign.statistics.rays);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ForeignDevice,
                         ::testing::Values(ForeignCase{"pt", "textures"}, ForeignCase{"pt", "lanterns"},
                                           ForeignCase{"pt", "../tests/scenes/instances"},
                                           ForeignCase{"gpt", "cornell-box", Precision::double_},
                                           ForeignCase{"sppm", "pool"}, ForeignCase{"gpm", "lamp-in-egg"}),
                         [](const auto &info) {
                             return test_name(fmt::format("{}_{}", info.param.method,
                                                          std::filesystem::path(info.param.scene).stem().string()));
                         });

} // namespace
} // namespace gradus::testing
