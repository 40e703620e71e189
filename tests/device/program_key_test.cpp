// What tells programs apart, and the hash that names them.
#include "runtime/device/hash.h"
#include "runtime/device/program_key.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <set>
#include <string>

namespace gradus {
namespace {

// Values of the reference implementation, smhasher's MurmurHash3_x64_128 with seed 0.
TEST(Hash, IsMurmurHash3) {
    EXPECT_EQ(hash128(""), (Hash128{0, 0}));
    EXPECT_EQ(hash128("hello"), (Hash128{0xCBD8A7B341BD9B02, 0x5B1E906A48AE1D19}));
    EXPECT_EQ(hash128("The quick brown fox jumps over the lazy dog"),
              (Hash128{0xE34BBC7BBC071B6C, 0x7A433CA9C49A9347}));
    EXPECT_EQ(hexadecimal(hash128("hello")), "5b1e906a48ae1d19cbd8a7b341bd9b02");
}

TEST(ProgramKey, DiffersByAllThatChangesTheCode) {
    DeviceDescription device;
    device.platform = "platform", device.name = "name", device.driver = "1.0", device.type = "cpu";
    std::set<std::string> keys;
    const auto is_new = [&](const std::string &options, const std::string &source) {
        return keys.insert(program_key(device_key(device), options, source)).second;
    };
    EXPECT_TRUE(is_new("-D A", "source"));
    EXPECT_FALSE(is_new("-D A", "source")) << "the same again";
    EXPECT_TRUE(is_new("-D B", "source"));
    EXPECT_TRUE(is_new("-D A", "another"));
    EXPECT_TRUE(is_new("-D As", "ource")) << "where one text ends counts";
    for (std::string DeviceDescription::*text :
         {&DeviceDescription::platform, &DeviceDescription::name, &DeviceDescription::vendor,
          &DeviceDescription::version, &DeviceDescription::driver, &DeviceDescription::platform_version}) {
        device.*text += "'";
        EXPECT_TRUE(is_new("-D A", "source"));
    }
    ASSERT_EQ(setenv("POCL_WILOOPS_MAX_UNROLL_COUNT", "3", 1), 0);
    EXPECT_TRUE(is_new("-D A", "source")) << "PoCL compiles otherwise";
    ASSERT_EQ(unsetenv("POCL_WILOOPS_MAX_UNROLL_COUNT"), 0);
    EXPECT_FALSE(is_new("-D A", "source"));
}

TEST(ProgramKey, DoesNotDependOnWhereAndOnHowManyThreads) {
    DeviceDescription device;
    device.type = "cpu";
    const std::string before = device_key(device);
    const char *folder = std::getenv("POCL_CACHE_DIR");
    const std::string kept = folder ? folder : "";
    ASSERT_EQ(setenv("POCL_CACHE_DIR", "/elsewhere", 1), 0);
    EXPECT_EQ(device_key(device), before);
    ASSERT_EQ(folder ? setenv("POCL_CACHE_DIR", kept.c_str(), 1) : unsetenv("POCL_CACHE_DIR"), 0);
    for (const char *variable :
         {"POCL_CPU_NUM_WORKERS", "POCL_AFFINITY", "POCL_TRACING", "POCL_TRACING_OPT", "POCL_MAX_COMPUTE_UNITS"}) {
        ASSERT_EQ(setenv(variable, "1", 1), 0);
        EXPECT_EQ(device_key(device), before) << variable;
        ASSERT_EQ(unsetenv(variable), 0);
    }
    ASSERT_EQ(setenv("POCL_AFFINITY_OF_CODE", "1", 1), 0);
    EXPECT_NE(device_key(device), before) << "of which nothing is known";
    ASSERT_EQ(unsetenv("POCL_AFFINITY_OF_CODE"), 0);
}

} // namespace
} // namespace gradus
