// The same image from one thread and from two, whatever the batches: runs of the program, for the number of threads is
// settled once a process.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>

#include <cstring>

namespace gradus {
namespace {

/// A scene and a precision.
class Threads : public ProgramTest, public ::testing::WithParamInterface<std::pair<const char *, const char *>> {
  protected:
    Image render(const std::string &scene, const std::vector<std::string> &settings, const std::string &output,
                 const std::string &threads, const std::string &batch_size) const {
        std::vector<std::string> arguments = {"render",  fmt::format("{}/scenes/{}.xml", GRADUS_ROOT, scene),
                                              "-o",      output,
                                              "--seed",  "11",
                                              "--quiet", "--nthreads",
                                              threads,   "--batch-size",
                                              batch_size};
        arguments.insert(arguments.end(), settings.begin(), settings.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return read_image(at(output));
    }
    void expect_one_photon_image(const std::string &scene, const std::string &precision) const {
        expect_one_image(scene, {"--method", "sppm", "--size", "96x72", "--spp", "2", "--photons", "20000",
                                 "--precision", precision});
    }
    void expect_one_image(const std::string &scene, const std::vector<std::string> &settings) const {
        const Image one = render(scene, settings, "one.exr", "1", "0");
        for (const char *batch_size : {"0", "1000"}) {
            const Image two = render(scene, settings, "two.exr", "2", batch_size);
            EXPECT_EQ(one.metadata.at("method"), two.metadata.at("method"));
            ASSERT_EQ(one.channels.size(), two.channels.size());
            for (const Channel &channel : one.channels)
                EXPECT_EQ(std::memcmp(channel.values.data(), two.find(channel.name)->values.data(),
                                      sizeof(float) * channel.values.size()),
                          0)
                    << channel.name << ", batch size " << batch_size;
        }
    }
};

class FullThreads : public Threads {};

TEST_P(Threads, DoNotChangeTheImage) {
    const auto [scene, precision] = GetParam();
    for (const char *method : {"pt", "gpt"})
        expect_one_image(scene, {"--method", method, "--size", "96x72", "--spp", "4", "--precision", precision});
    if (testing::is_full())
        expect_one_photon_image(scene, precision);
}

TEST_F(Threads, DoNotChangePhotons) { expect_one_photon_image("cornell-box", "single"); }

/// Enough samples for a pilot.
TEST_F(FullThreads, DoNotChangeWhichMethodIsChosen) {
    expect_one_image("cornell-box", {"--size", "48x36", "--spp", "240", "--method", "auto"});
}

std::string name_of_threads(const ::testing::TestParamInfo<std::pair<const char *, const char *>> &info) {
    return testing::test_name(std::string(info.param.first) + "_" + info.param.second);
}

INSTANTIATE_TEST_SUITE_P(Program, Threads, ::testing::Values(std::pair{"materials", "single"}), name_of_threads);
INSTANTIATE_TEST_SUITE_P(Full, Threads,
                         ::testing::Values(std::pair{"cornell-box", "single"}, std::pair{"cornell-box", "double"},
                                           std::pair{"plates", "single"}, std::pair{"textures", "single"},
                                           std::pair{"sundial", "single"}),
                         name_of_threads);

} // namespace
} // namespace gradus
