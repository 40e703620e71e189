// How large a batch may be.
#include "runtime/stages/batch_tables.h"

#include "runtime/device/opencl.h"
#include "runtime/error.h"

#include <gmock/gmock.h>

namespace gradus {
namespace {

/// A device that says that it has so much memory.
class BatchSize : public ::testing::Test {
  protected:
    DeviceDescription &description() { return device.implementation().description; }
    std::uint32_t choose(std::uint32_t requested, std::uint64_t samples, const TraitMap &traits) {
        return choose_batch_size(device, requested, samples, traits, Precision::single);
    }
    static TraitMap traits(int value) {
        return {{"TRAIT_REFRACTION", value},
                {"TRAIT_AOV", value},
                {"TRAIT_ANISOTROPIC", value},
                {"TRAIT_SHADING_NORMALS", value}};
    }
    /// Allocates the tables of a batch; each allocation is checked against what the device says.
    std::uint64_t allocate(std::uint32_t size, const TraitMap &traits) {
        const std::uint64_t before = device.implementation().allocated_bytes;
        const BatchTables tables(device, size, size * batches_a_pass, 3, traits, Precision::single);
        return device.implementation().allocated_bytes - before;
    }
    Device device;
    const std::uint64_t plenty = std::uint64_t(1) << 40;
};

TEST_F(BatchSize, IsWhatIsAskedForInWholeGroups) {
    description().memory_bytes = description().allocation_bytes = plenty;
    EXPECT_EQ(choose(64, plenty, traits(0)), 64u);
    EXPECT_EQ(choose(6400, plenty, traits(0)), 6400u);
    for (const std::uint32_t requested : {1u, 65u, 1000u, 333'333u}) {
        const std::uint32_t size = choose(requested, plenty, traits(0));
        EXPECT_GE(size, requested);
        EXPECT_LT(size, requested + 64);
        EXPECT_EQ(size % 64, 0u);
    }
}

TEST_F(BatchSize, IsNoMoreThanThereIsToDo) {
    description().memory_bytes = description().allocation_bytes = plenty;
    EXPECT_EQ(choose(0, 100, traits(0)), 128u);
    EXPECT_EQ(choose(1'000'000, 1024, traits(0)), 1024u);
    EXPECT_EQ(choose(0, 1, traits(0)), 64u);
}

TEST_F(BatchSize, HasABoundWhateverIsAsked) {
    description().memory_bytes = description().allocation_bytes = plenty;
    EXPECT_LE(choose(0xFFFFFFFF, plenty, traits(1)), 1u << 24);
}

TEST_F(BatchSize, FitsHalfTheMemory) {
    for (const int all : {0, 1}) {
        description().allocation_bytes = plenty;
        description().memory_bytes = 50'000'000;
        const std::uint32_t size = choose(1 << 24, plenty, traits(all));
        description().memory_bytes = plenty;
        EXPECT_LE(allocate(size, traits(all)), 26'000'000u) << "traits " << all;
        EXPECT_GE(allocate(size, traits(all)), 24'000'000u) << "traits " << all << ": memory is left unused";
    }
}

TEST_F(BatchSize, FitsTheLargestAllocation) {
    for (const int all : {0, 1})
        for (const std::uint64_t limit : {20'000u, 100'003u, 1'000'000u, 8'000'001u}) {
            description().memory_bytes = plenty;
            description().allocation_bytes = limit;
            const std::uint32_t size = choose(1 << 24, plenty, traits(all));
            EXPECT_NO_THROW(allocate(size, traits(all))) << "traits " << all << ", limit " << limit << ", " << size;
        }
}

TEST_F(BatchSize, ThatDoesNotFitIsAnError) {
    description().memory_bytes = 10'000;
    description().allocation_bytes = plenty;
    EXPECT_THROW(choose(0, plenty, traits(0)), Error);
    description().memory_bytes = plenty;
    description().allocation_bytes = 1000;
    EXPECT_THROW(choose(0, plenty, traits(0)), Error);
}

} // namespace
} // namespace gradus
