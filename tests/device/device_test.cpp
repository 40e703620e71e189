#include "runtime/device/device.h"

#include "runtime/error.h"

#include <gmock/gmock.h>

#include <array>
#include <string>
#include <thread>

namespace gradus {
namespace {

using ::testing::HasSubstr;

TEST(Device, IsFoundByNumberAndByAPartOfItsName) {
    const std::vector<DeviceDescription> devices = list_devices();
    ASSERT_FALSE(devices.empty());
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const Device device(std::to_string(i));
        EXPECT_EQ(device.description().name, devices[i].name);
        EXPECT_EQ(device.description().platform, devices[i].platform);
    }
    std::string part = devices[0].platform.substr(0, 8);
    for (char &c : part)
        c = char(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    EXPECT_EQ(Device(part).description().platform, devices[0].platform) << "in any case";
}

TEST(Device, SaysWhatThereIsWhereNoneMatches) {
    for (const char *selector : {"no such device", "4711", "99999999999999999999"})
        try {
            const Device device(selector);
            FAIL() << selector << " was found: " << device.description().name;
        } catch (const Error &error) {
            EXPECT_EQ(error.code, ExitCode::device);
            EXPECT_THAT(error.what(), HasSubstr(selector));
            for (const DeviceDescription &device : list_devices())
                EXPECT_THAT(error.what(), HasSubstr(device.name));
        }
}

TEST(Device, IsNoPartOfANameWhereANumberIsMeant) {
    DeviceDescription first, second;
    first.name = "AMD Ryzen 9 5950X 16-Core Processor";
    second.name = "NVIDIA GeForce RTX 3060";
    const std::vector<DeviceDescription> found = {first, second};
    EXPECT_EQ(chosen_device(found, "1"), 1u);
    EXPECT_EQ(chosen_device(found, "3060"), 1u);
    EXPECT_EQ(chosen_device(found, "ryzen 9"), 0u);
    for (const char *beyond : {"2", "6", "16", "9"})
        EXPECT_THROW(chosen_device(found, beyond), Error) << beyond;
}

TEST(Device, IsAProcessorUnlessToldOtherwise) {
    const Device device("");
    EXPECT_EQ(device.description().type, "cpu");
    EXPECT_GT(device.description().compute_units, 0u);
    EXPECT_GT(device.description().memory_bytes, 0u);
    EXPECT_GE(device.description().local_bytes, 16384u);
    EXPECT_GT(device.description().allocation_bytes, 0u);
    EXPECT_LE(device.description().allocation_bytes, device.description().memory_bytes);
}

// A process of its own: only the first call of all can go wrong.
TEST(DevicesOfThreads, AreOpenedAtOnce) {
    std::array<std::string, 8> names;
    {
        std::array<std::jthread, names.size()> threads;
        for (std::size_t i = 0; i < names.size(); ++i)
            threads[i] = std::jthread([&name = names[i]] {
                try {
                    name = Device().description().name;
                } catch (const Error &error) {
                    name = error.what();
                }
            });
    }
    for (const std::string &name : names)
        EXPECT_EQ(name, Device().description().name);
}

} // namespace
} // namespace gradus
