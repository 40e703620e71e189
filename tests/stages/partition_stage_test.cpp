// The counting sort against std::stable_sort.
#include "runtime/stages/partition_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/tables.h"

namespace gradus {
namespace {

constexpr std::uint32_t canary = 0xC0FFEE00;
constexpr std::size_t margin = 64; // elements after the end of each table

class Partition : public ::testing::Test {
  protected:
    /// Sorts `bins_of_rows` and checks all that the stage says of the result, and that nothing else was written.
    void expect_sorted(const std::vector<std::uint32_t> &bins_of_rows, std::uint32_t bins, std::uint32_t capacity) {
        const auto count = std::uint32_t(bins_of_rows.size());
        const TraitValues traits = {
            {"TRAIT_REFRACTION", 0}, {"TRAIT_AOV", 0}, {"TRAIT_ANISOTROPIC", 0}, {"TRAIT_SHADING_NORMALS", 0}};
        BatchTables tables(device, capacity, capacity, bins, traits, Precision::single);
        const std::size_t chunks = (capacity + partition_chunk - 1) / partition_chunk;
        const auto with_margin = [&](const char *name, std::size_t size) {
            const std::vector<std::uint32_t> canaries(size + margin, canary);
            return Buffer(device, name, canaries.data(), canaries.size() * sizeof(std::uint32_t));
        };
        tables.index = with_margin("index", capacity);
        tables.offset = with_margin("offset", chunks * bins);
        tables.range = with_margin("range", bins + 1);
        std::vector<std::uint32_t> rows(capacity, 0);
        std::copy(bins_of_rows.begin(), bins_of_rows.end(), rows.begin());
        tables.bin = Buffer(device, "bin", rows.data(), rows.size() * sizeof(std::uint32_t));

        PartitionStage partition(KernelLibrary(device, traits).build(PartitionStage::requests()), tables, bins);
        const std::vector<std::uint32_t> range = partition.run(count);

        std::vector<std::uint32_t> expected;
        for (std::uint32_t row = 0; row < count; ++row)
            if (bins_of_rows[row] < bins)
                expected.push_back(row);
        std::stable_sort(expected.begin(), expected.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return bins_of_rows[a] < bins_of_rows[b]; });
        ASSERT_EQ(range.size(), bins + 1);
        EXPECT_EQ(range[0], 0u);
        for (std::uint32_t b = 0; b < bins; ++b)
            ASSERT_EQ(range[b + 1] - range[b], std::count(bins_of_rows.begin(), bins_of_rows.end(), b)) << "bin " << b;
        std::vector<std::uint32_t> index(capacity + margin);
        tables.index.read(index.data(), index.size() * sizeof(std::uint32_t));
        for (std::size_t i = 0; i < index.size(); ++i)
            ASSERT_EQ(index[i], i < expected.size() ? expected[i] : canary)
                << "place " << i << " of " << expected.size();
        expect_canaries(tables.offset, chunks * bins);
        expect_canaries(tables.range, bins + 1);
    }

    std::vector<std::uint32_t> random_bins(std::size_t count, std::uint32_t bins, double dropped) {
        std::uniform_real_distribution<double> uniform;
        std::uniform_int_distribution<std::uint32_t> bin(0, bins - 1);
        std::vector<std::uint32_t> rows(count);
        for (std::uint32_t &row : rows)
            row = uniform(engine) < dropped ? bin_none : bin(engine);
        return rows;
    }

  private:
    static void expect_canaries(const Buffer &buffer, std::size_t begin) {
        std::vector<std::uint32_t> values(buffer.bytes() / sizeof(std::uint32_t));
        buffer.read(values.data(), buffer.bytes());
        ASSERT_EQ(values.size(), begin + margin);
        for (std::size_t i = begin; i < values.size(); ++i)
            ASSERT_EQ(values[i], canary) << buffer.name() << " was written past its end";
    }
    Device device;
    std::mt19937 engine{3};
};

TEST_F(Partition, KeepsTheOrderWithinABin) {
    for (const std::uint32_t bins : {1u, 2u, 3u, 9u, 17u})
        for (const std::uint32_t count : {1u, 63u, 64u, 255u, 256u, 257u, 1000u, 65'536u, 70'001u})
            for (const double dropped : {0.0, 0.3}) {
                SCOPED_TRACE(::testing::Message() << count << " rows, " << bins << " bins, dropped " << dropped);
                expect_sorted(random_bins(count, bins, dropped), bins, (count + 63) / 64 * 64);
            }
}

TEST_F(Partition, TakesNoRows) { expect_sorted({}, 4, 256); }

TEST_F(Partition, DropsAllRows) { expect_sorted(std::vector<std::uint32_t>(1000, bin_none), 4, 1024); }

TEST_F(Partition, PutsAllRowsInOneBin) {
    for (const std::uint32_t bin : {0u, 2u, 3u})
        expect_sorted(std::vector<std::uint32_t>(1000, bin), 4, 1024);
}

TEST_F(Partition, LeavesRowsBeyondTheCountAlone) { expect_sorted(random_bins(300, 5, 0.1), 5, 4096); }

} // namespace
} // namespace gradus
