// What is allocated, and how large a batch may be.
#include "runtime/wavefront/table.h"

#include "runtime/device/opencl.h"
#include "runtime/error.h"

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <stdexcept>

namespace gradus {
namespace {

/// Tables of all kinds: `all` has more of them.
TableList list(bool all) {
    const std::uint32_t more = all ? 1 : 0;
    return {{.name = "newest", .columns = 7 + more, .alternates = true},
            {.name = "whole", .is_uint = true},
            {.name = "by_offset", .multiple = 8, .columns = 3 * more, .is_cleared = true},
            {.name = "by_slot", .rows = RowsOf::slot, .columns = 3 + 7 * more},
            {.name = "by_chunk", .rows = RowsOf::chunk, .columns = 5, .is_uint = true},
            {.name = "alone", .rows = RowsOf::one, .columns = 6, .is_uint = true},
            {.name = "film", .rows = RowsOf::pixel, .columns = 7},
            {.name = "line", .rows = RowsOf::image_row, .columns = more}};
}

/// A device that says that it has so much memory.
class BatchSize : public ::testing::Test {
  protected:
    DeviceDescription &description() { return device.implementation().description; }
    std::uint32_t choose(std::uint32_t requested, std::uint64_t samples, bool all) {
        return choose_batch_size(device, requested, samples, list(all), Precision::single);
    }
    /// Allocates the tables of a batch; each allocation is checked against what the device says.
    std::uint64_t allocate(std::uint32_t size, bool all) {
        const std::uint64_t before = device.implementation().allocated_bytes;
        const Tables tables(device, list(all), {size, odd_lines(size * batches_a_pass), 8, 4, chunks_of(size)},
                            Precision::single);
        return device.implementation().allocated_bytes - before;
    }
    Device device;
    const std::uint64_t plenty = std::uint64_t(1) << 40;
};

TEST(TablesOf, HaveTheirRowsInTheirPrecision) {
    Device device;
    const TableRows rows = {.paths = 100, .slots = 400, .pixels = 35, .width = 7, .chunks = 3};
    for (const Precision precision : {Precision::single, Precision::double_}) {
        if (precision == Precision::double_ && !device.description().has_double)
            continue;
        const std::size_t real = real_bytes(precision);
        const Tables tables(device, list(true), rows, precision);
        EXPECT_EQ(tables["newest"].bytes(), 100 * 8 * real);
        EXPECT_EQ(tables["whole"].bytes(), 100 * 4u);
        EXPECT_EQ(tables["by_offset"].bytes(), 100 * 8 * 3 * real);
        EXPECT_EQ(tables["by_slot"].bytes(), 400 * 10 * real);
        EXPECT_EQ(tables["by_chunk"].bytes(), 3 * 5 * 4u);
        EXPECT_EQ(tables["alone"].bytes(), 6 * 4u);
        EXPECT_EQ(tables["film"].bytes(), 35 * 7 * real);
        EXPECT_EQ(tables["line"].bytes(), 7 * real);
    }
}

TEST(TablesOf, WithoutColumnsAreNotThere) {
    Device device;
    const Tables tables(device, list(false), {64, 256, 4, 2, 1}, Precision::single);
    for (const char *name : {"by_offset", "line"}) {
        EXPECT_FALSE(tables.has(name)) << name;
        EXPECT_THROW(tables[name], std::logic_error) << name;
    }
    std::set<std::string> arguments;
    tables.for_each([&](const std::string &name, const Buffer &, bool) { arguments.insert(name); });
    EXPECT_THAT(arguments, ::testing::UnorderedElementsAre("newest", "newest_old", "whole", "by_slot", "by_chunk",
                                                           "alone", "film"));
}

TEST(TablesOf, AlternateWhereTheySaySo) {
    Device device;
    Tables tables(device, list(true), {64, 256, 4, 2, 1}, Precision::single);
    const auto memory = [&] {
        std::map<std::string, const void *> memory;
        tables.for_each([&](const std::string &name, const Buffer &buffer, bool alternates) {
            EXPECT_EQ(alternates, name.starts_with("newest")) << name;
            memory[name] = *static_cast<void *const *>(buffer.argument());
        });
        return memory;
    };
    const std::map<std::string, const void *> before = memory();
    EXPECT_NE(before.at("newest"), before.at("newest_old"));
    tables.exchange();
    std::map<std::string, const void *> expected = before;
    std::swap(expected.at("newest"), expected.at("newest_old"));
    EXPECT_EQ(memory(), expected);
    EXPECT_EQ(*static_cast<void *const *>(tables["newest"].argument()), before.at("newest_old"));
}

TEST(TablesOf, AreClearedWhereTheySaySo) {
    Device device;
    const Tables tables(device, list(true), {64, 256, 4, 2, 1}, Precision::single);
    std::vector<std::uint32_t> content(tables["by_offset"].bytes() / sizeof(std::uint32_t), 1);
    tables["by_offset"].read(content.data(), tables["by_offset"].bytes());
    EXPECT_THAT(content, ::testing::Each(0u));
}

TEST(TablesOf, CanBeLetGo) {
    Device device;
    const std::uint64_t before = device.implementation().allocated_bytes;
    Tables tables(device, list(true), {64, 256, 4, 2, 1}, Precision::single);
    tables.release_all_but({"film"});
    EXPECT_TRUE(tables.has("film"));
    EXPECT_FALSE(tables.has("newest"));
    EXPECT_EQ(device.implementation().allocated_bytes - before, tables["film"].bytes());
}

TEST_F(BatchSize, IsWhatIsAskedForInWholeGroups) {
    description().memory_bytes = description().allocation_bytes = plenty;
    EXPECT_EQ(choose(64, plenty, false), 64u);
    EXPECT_EQ(choose(6400, plenty, false), 6400u);
    for (const std::uint32_t requested : {1u, 65u, 1000u, 333'333u}) {
        const std::uint32_t size = choose(requested, plenty, false);
        EXPECT_GE(size, requested);
        EXPECT_LT(size, requested + 64);
        EXPECT_EQ(size % 64, 0u);
    }
}

TEST_F(BatchSize, IsNoMoreThanThereIsToDo) {
    description().memory_bytes = description().allocation_bytes = plenty;
    EXPECT_EQ(choose(0, 100, false), 128u);
    EXPECT_EQ(choose(1'000'000, 1024, false), 1024u);
    EXPECT_EQ(choose(0, 1, false), 64u);
}

TEST_F(BatchSize, IsLargerOnACpuWherePathsAreSmall) {
    description().memory_bytes = description().allocation_bytes = plenty;
    description().is_host = true;
    EXPECT_EQ(choose(0, plenty, false), 2 * default_batch_size(device));
    TableList wide = list(false);
    wide.push_back({.name = "wide", .columns = 100});
    EXPECT_EQ(choose_batch_size(device, 0, plenty, wide, Precision::single), default_batch_size(device));
    description().is_host = false;
    EXPECT_EQ(choose(0, plenty, false), default_batch_size(device));
}

TEST_F(BatchSize, GrowsWithTheCoresOfACpu) {
    description().memory_bytes = description().allocation_bytes = plenty;
    description().is_host = true;
    TableList wide = list(false);
    wide.push_back({.name = "wide", .columns = 100});
    const auto default_of = [&](unsigned cores, const TableList &tables) {
        description().compute_units = cores;
        return choose_batch_size(device, 0, plenty, tables, Precision::single);
    };
    EXPECT_EQ(default_of(1, wide), default_of(2, wide));
    EXPECT_EQ(default_of(8, wide), 4 * default_of(2, wide));
    EXPECT_EQ(default_of(8, list(false)), 4 * default_of(2, list(false)));
    // But not memory without end; a path of `wide` takes more than its 400 bytes.
    EXPECT_LE(400u * std::uint64_t(default_of(1000, wide)), std::uint64_t(1) << 30);
    EXPECT_GT(default_of(1000, wide), default_of(8, wide));
    wide.push_back({.name = "wider", .columns = 5000});
    EXPECT_EQ(default_of(1000, wide), default_of(2, list(false)) / 2) << "not less than two cores have";
}

TEST_F(BatchSize, HasABoundWhateverIsAsked) {
    description().memory_bytes = description().allocation_bytes = plenty;
    EXPECT_LE(choose(0xFFFFFFFF, plenty, true), 1u << 24);
}

TEST_F(BatchSize, FitsHalfTheMemory) {
    for (const bool all : {false, true}) {
        description().allocation_bytes = plenty;
        description().memory_bytes = 50'000'000;
        const std::uint32_t size = choose(1 << 24, plenty, all);
        description().memory_bytes = plenty;
        EXPECT_LE(allocate(size, all), 26'000'000u) << "all " << all;
        EXPECT_GE(allocate(size, all), 24'000'000u) << "all " << all << ": memory is left unused";
    }
}

TEST_F(BatchSize, FitsTheLargestAllocation) {
    for (const bool all : {false, true})
        for (const std::uint64_t limit : {20'000u, 100'003u, 1'000'000u, 8'000'001u}) {
            description().memory_bytes = plenty;
            description().allocation_bytes = limit;
            const std::uint32_t size = choose(1 << 24, plenty, all);
            EXPECT_NO_THROW(allocate(size, all)) << "all " << all << ", limit " << limit << ", " << size;
        }
}

TEST_F(BatchSize, ThatDoesNotFitIsAnError) {
    description().memory_bytes = 10'000;
    description().allocation_bytes = plenty;
    EXPECT_THROW(choose(0, plenty, false), Error);
    description().memory_bytes = plenty;
    description().allocation_bytes = 1000;
    EXPECT_THROW(choose(0, plenty, false), Error);
}

} // namespace
} // namespace gradus
