// The same image from one thread and from two, whatever the batches: runs of the program, for the number of threads is
// settled once a process.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"

#include <cstring>

namespace gradus {
namespace {

/// A scene and a precision.
class Threads : public ProgramTest, public ::testing::WithParamInterface<std::pair<const char *, const char *>> {};

TEST_P(Threads, DoNotChangeTheImage) {
    const auto [scene, precision] = GetParam();
    const auto render = [&](const std::string &output, const std::string &threads, const std::string &batch_size) {
        const Outcome outcome = run({"render", std::string(GRADUS_ROOT) + "/scenes/" + scene + ".xml", "-o", output,
                                     "--size", "160x120", "--spp", "4", "--seed", "11", "--quiet", "--precision",
                                     precision, "--nthreads", threads, "--batch-size", batch_size});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return read_image(at(output));
    };
    const Image one = render("one.exr", "1", "0");
    for (const char *batch_size : {"0", "1000"}) {
        const Image two = render("two.exr", "2", batch_size);
        ASSERT_EQ(one.channels.size(), two.channels.size());
        for (const Channel &channel : one.channels)
            EXPECT_EQ(std::memcmp(channel.values.data(), two.find(channel.name)->values.data(),
                                  sizeof(float) * channel.values.size()),
                      0)
                << channel.name << ", batch size " << batch_size;
    }
}

INSTANTIATE_TEST_SUITE_P(Program, Threads,
                         ::testing::Values(std::pair{"cornell-box", "single"}, std::pair{"plates", "single"},
                                           std::pair{"materials", "single"}, std::pair{"materials", "double"}),
                         [](const auto &info) {
                             std::string name = std::string(info.param.first) + "_" + info.param.second;
                             for (char &c : name)
                                 c = c == '-' ? '_' : c;
                             return name;
                         });

} // namespace
} // namespace gradus
