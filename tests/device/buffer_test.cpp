#include "runtime/device/buffer.h"
#include "runtime/device/program.h"
#include "runtime/error.h"

#include <gmock/gmock.h>

#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

namespace gradus {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

std::vector<std::uint32_t> content(const Buffer &buffer) {
    std::vector<std::uint32_t> values(buffer.bytes() / sizeof(std::uint32_t));
    buffer.read(values.data(), values.size() * sizeof(std::uint32_t));
    return values;
}

std::vector<std::uint32_t> counting(std::size_t count) {
    std::vector<std::uint32_t> values(count);
    std::iota(values.begin(), values.end(), 1000u);
    return values;
}

TEST(Buffer, HoldsWhatItWasMadeOf) {
    Device device;
    for (const std::size_t count : {1u, 3u, 4u, 1000u, 1'000'003u}) {
        const std::vector<std::uint32_t> values = counting(count);
        const Buffer buffer(device, "numbers", values.data(), values.size() * sizeof(std::uint32_t));
        EXPECT_TRUE(buffer.valid());
        EXPECT_EQ(buffer.name(), "numbers");
        EXPECT_EQ(content(buffer), values);
    }
}

TEST(Buffer, ReadsNoMoreThanAskedFor) {
    Device device;
    const std::vector<std::uint32_t> values = counting(64);
    const Buffer buffer(device, "numbers", values.data(), 256);
    constexpr std::uint32_t canary = 0xC0FFEE;
    std::vector<std::uint32_t> destination(64, canary);
    buffer.read(destination.data(), 40);
    for (std::size_t i = 0; i < 64; ++i)
        EXPECT_EQ(destination[i], i < 10 ? values[i] : canary) << i;
}

TEST(Buffer, ClearsAllOfItselfAndNothingElse) {
    Device device;
    const std::vector<std::uint32_t> values = counting(1001);
    const std::size_t bytes = values.size() * sizeof(std::uint32_t);
    const Buffer before(device, "before", values.data(), bytes);
    Buffer buffer(device, "between", values.data(), bytes);
    const Buffer after(device, "after", values.data(), bytes);
    buffer.clear();
    EXPECT_THAT(content(buffer), Each(0u));
    EXPECT_EQ(content(before), values);
    EXPECT_EQ(content(after), values);
}

TEST(Buffer, OfNothingHoldsOneElementOfZeros) {
    Device device;
    const Buffer buffer(device, "nothing", nullptr, 0);
    EXPECT_TRUE(buffer.valid());
    ASSERT_GE(buffer.bytes(), 4u);
    EXPECT_THAT(content(buffer), Each(0u));
    EXPECT_FALSE(Buffer().valid());
}

TEST(Buffer, IsSeenThroughAMapping) {
    Device device;
    const std::vector<std::uint32_t> values = counting(100);
    const Buffer buffer(device, "numbers", values.data(), 400);
    {
        const auto view = buffer.map(Access::read_write);
        auto *numbers = view.as<std::uint32_t>();
        EXPECT_EQ(numbers[99], values[99]);
        numbers[99] = 7;
    }
    EXPECT_EQ(content(buffer)[99], 7u);
    EXPECT_EQ(content(buffer)[98], values[98]);
    const auto view = buffer.map(Access::read);
    EXPECT_EQ(view.as<std::uint32_t>()[99], 7u);
}

/// What the system was told of the pages at an address, as /proc/self/smaps lists it: "hg" is MADV_HUGEPAGE.
std::string advice_at(const void *address) {
    std::ifstream smaps("/proc/self/smaps");
    bool is_there = false;
    for (std::string line; std::getline(smaps, line);) {
        std::uintptr_t first = 0, end = 0;
        if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " ", &first, &end) == 2)
            is_there = reinterpret_cast<std::uintptr_t>(address) - first < end - first;
        else if (is_there && line.starts_with("VmFlags:"))
            return line;
    }
    return {};
}

TEST(Buffer, OfATableIsToHaveLargePagesOnACpu) {
    Device device;
    if (!device.description().is_host || !std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"))
        return; // there are none to ask for
    const Buffer buffer(device, "table", 16u << 20);
    const auto view = buffer.map(Access::write);
    EXPECT_THAT(advice_at(view.as<char>() + (8u << 20)), HasSubstr(" hg"));
}

TEST(Buffer, SharesItsMemoryWithItsCopies) {
    Device device;
    const std::vector<std::uint32_t> values = counting(4);
    Buffer buffer(device, "numbers", values.data(), 16);
    const Buffer copy = buffer;
    buffer.clear();
    EXPECT_THAT(content(copy), Each(0u));
}

TEST(Buffer, ThatIsTooLargeIsNamed) {
    Device device;
    const std::uint64_t too_much = device.description().allocation_bytes + 1;
    try {
        const Buffer buffer(device, "vertex", too_much);
        FAIL() << "allocated " << buffer.bytes();
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::device);
        EXPECT_THAT(error.what(), AllOf(HasSubstr("vertex"), HasSubstr("--batch-size")));
    }
}

TEST(Buffer, OverTheHostsMemoryIsThatMemoryWhereItIsLarge) {
    Device device;
    for (const std::size_t count : {1000u, 1'000'000u}) {
        std::vector<float> values(count, 1.5f);
        const Buffer buffer = Buffer::over(device, "values", values.data(), values.size() * sizeof(float));
        EXPECT_EQ(buffer.bytes(), values.size() * sizeof(float));
        const auto mapping = buffer.map(Access::read);
        EXPECT_EQ(mapping.as<float>() == values.data(), device.description().shares_memory && count > 1000);
        EXPECT_EQ(mapping.as<float>()[count - 1], 1.5f);
    }
}

TEST(Buffer, CountsTowardsThePeak) {
    Device device;
    EXPECT_EQ(peak_device_bytes(device), 0u);
    {
        const Buffer first(device, "first", 1000);
        const Buffer second(device, "second", 500);
        EXPECT_EQ(peak_device_bytes(device), 1500u);
    }
    const Buffer third(device, "third", 1200);
    EXPECT_EQ(peak_device_bytes(device), 1500u) << "the first two are gone";
    const Buffer fourth(device, "fourth", 400);
    EXPECT_EQ(peak_device_bytes(device), 1600u);
}

} // namespace
} // namespace gradus
