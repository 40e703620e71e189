// The counting sort against std::stable_sort, by the bins of `classify`.
#include "runtime/wavefront/grouping.h"
#include "runtime/wavefront/wavefront.h"

#include "runtime/device/opencl.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/material.h"
#include "kernels/shared/tables.h"

namespace gradus {
namespace {

using namespace lib_float;

constexpr std::uint32_t canary = 0xC0FFEE00;

/// Of each table of the partition, twice the rows or a column more than it needs: what lies behind must stay.
TableList with_margins(TableList list) {
    for (TableDeclaration &table : list) {
        if (table.name == "index" || table.name == "bin")
            table.multiple = 2;
        if (table.name == "chunk_offset" || table.name == "range")
            ++table.columns;
    }
    return list;
}

/// A sphere of each of so many BSDF kinds that does not emit, and one that does, before an environment.
Scene scene_of(std::uint32_t kinds) {
    testing::SceneMaker maker(4, 1);
    for (std::uint32_t kind = 0; kind < kinds; ++kind) {
        Bsdf bsdf;
        bsdf.kind = BsdfKind(kind);
        const std::uint32_t material = maker.material(bsdf);
        maker.sphere({3.0f * float(kind), 0, 0}, 1, material);
        maker.sphere({3.0f * float(kind), 3, 0}, 1, material, maker.emitter(Emitter::Kind::area, {1, 1, 1}));
    }
    maker.environment(1);
    return maker.scene;
}

/// Whether the device is taken for the host's processor or for another one, on which many lanes scan.
class Partition : public ::testing::TestWithParam<bool> {
  protected:
    void SetUp() override { device.implementation().description.is_host = GetParam(); }

    /// Sorts rows whose rays met `primitives` and checks all that is said of the result, and that nothing else was
    /// written.
    void expect_sorted(const std::vector<std::uint32_t> &primitives, std::uint32_t kinds, std::uint32_t capacity) {
        const auto count = std::uint32_t(primitives.size());
        Session session(device, scene_of(kinds), {}, {});
        ASSERT_EQ(session.scene.kinds.size(), kinds);
        Stages stages;
        const BinLayout layout = {.kinds = kinds};
        Wavefront paths(session, stages, layout);
        Tables tables(device, with_margins(paths.tables()), {capacity, capacity, 16, 4, chunks_of(capacity)},
                      Precision::single);
        session.numbers["capacity"] = capacity;
        stages.build(session, tables);
        paths.attach(tables);
        const char *const names[] = {"bin", "index", "chunk_offset", "range"};
        for (const char *name : names) {
            const std::vector<std::uint32_t> canaries(tables[name].bytes() / sizeof(canary), canary);
            std::copy(canaries.begin(), canaries.end(), tables[name].map(Access::write).as<std::uint32_t>());
        }
        {
            const auto rays = tables["ray"].map(Access::read_write);
            std::copy(primitives.begin(), primitives.end(),
                      rays.as<std::uint32_t>() + std::size_t(ray_primitive) * capacity);
        }
        paths.begin_pass(count);
        std::uint32_t slot = 1;
        const Range fresh = paths.refill(slot);
        EXPECT_EQ(slot, 0u);
        EXPECT_EQ(fresh.first, 0u);
        EXPECT_EQ(fresh.count, count);
        const Hits &hits = paths.partition();

        const std::uint32_t bins = layout.bins();
        const auto bin_of = [&](std::uint32_t row) {
            const std::uint32_t primitive = primitives[row];
            return primitive == ray_escaped         ? 0
                   : primitive >= ray_first_special ? bin_none
                                                    : session.scene.primitive_bin[primitive];
        };
        std::vector<std::uint32_t> expected, size(bins, 0);
        for (std::uint32_t row = 0; row < count; ++row)
            if (bin_of(row) < bins) {
                expected.push_back(row);
                ++size[bin_of(row)];
            }
        std::stable_sort(expected.begin(), expected.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return bin_of(a) < bin_of(b); });

        const auto content = [&](const char *name) {
            std::vector<std::uint32_t> values(tables[name].bytes() / sizeof(canary));
            tables[name].read(values.data(), tables[name].bytes());
            return values;
        };
        const std::vector<std::uint32_t> range = content("range");
        ASSERT_EQ(range.size(), bins + 2);
        EXPECT_EQ(range[0], 0u);
        for (std::uint32_t b = 0; b < bins; ++b)
            ASSERT_EQ(range[b + 1] - range[b], size[b]) << "bin " << b;
        const std::vector<std::uint32_t> index = content("index");
        for (std::size_t i = 0; i < index.size(); ++i)
            ASSERT_EQ(index[i], i < expected.size() ? expected[i] : canary)
                << "place " << i << " of " << expected.size();
        expect_canaries("bin", content("bin"), count);
        expect_canaries("chunk_offset", content("chunk_offset"), std::size_t(chunks_of(capacity)) * bins);
        expect_canaries("range", range, bins + 1);

        // Where the host finds them.
        EXPECT_EQ(hits.escaped().first, 0u);
        EXPECT_EQ(hits.escaped().count, size[0]);
        EXPECT_EQ(hits.count(), expected.size() - size[0]);
        EXPECT_EQ(hits.phase(0).count, hits.count());
        std::uint32_t row = 0;
        for (std::uint32_t kind = 0; kind < kinds; ++kind) {
            const std::uint32_t alone = size[1 + 2 * kind], emitting = size[2 + 2 * kind];
            EXPECT_EQ(hits.kind(0, kind).first, row) << kind;
            EXPECT_EQ(hits.kind(0, kind).count, alone + emitting) << kind;
            EXPECT_EQ(hits.emitting(0, kind).first, row + alone) << kind;
            EXPECT_EQ(hits.emitting(0, kind).count, emitting) << kind;
            EXPECT_EQ(hits.place(row), size[0] + row);
            row += alone + emitting;
        }
        paths.advance();
        EXPECT_EQ(paths.vertices(), hits.count());
        EXPECT_EQ(paths.rays(), hits.count());
    }

    std::vector<std::uint32_t> random_hits(std::size_t count, std::uint32_t kinds, double dropped) {
        std::uniform_real_distribution<double> uniform;
        std::uniform_int_distribution<std::uint32_t> hit(0, 2 * kinds);
        std::vector<std::uint32_t> primitives(count);
        for (std::uint32_t &primitive : primitives) {
            primitive = hit(engine);
            if (primitive == 2 * kinds)
                primitive = ray_escaped;
            if (uniform(engine) < dropped)
                primitive = ray_none;
        }
        return primitives;
    }

  private:
    static void expect_canaries(const char *name, const std::vector<std::uint32_t> &values, std::size_t begin) {
        ASSERT_LT(begin, values.size());
        for (std::size_t i = begin; i < values.size(); ++i)
            ASSERT_EQ(values[i], canary) << name << " was written past its end";
    }
    Device device;
    std::mt19937 engine{3};
};

TEST_P(Partition, KeepsTheOrderWithinABin) {
    for (const std::uint32_t kinds : {1u, 2u, 3u, 5u, std::uint32_t(bsdf_kind_count)})
        for (const std::uint32_t count : {1u, 63u, 64u, 255u, 256u, 257u, 1000u, 65'536u, 70'001u})
            for (const double dropped : {0.0, 0.3}) {
                SCOPED_TRACE(::testing::Message() << count << " rows, " << kinds << " kinds, dropped " << dropped);
                expect_sorted(random_hits(count, kinds, dropped), kinds, (count + 63) / 64 * 64);
            }
}

TEST_P(Partition, TakesNoRows) { expect_sorted({}, 2, 256); }

TEST_P(Partition, DropsAllRows) { expect_sorted(std::vector<std::uint32_t>(1000, ray_none), 2, 1024); }

TEST_P(Partition, PutsAllRowsInOneBin) {
    for (const std::uint32_t primitive : {0u, 1u, 3u, ray_escaped})
        expect_sorted(std::vector<std::uint32_t>(1000, primitive), 2, 1024);
}

TEST_P(Partition, LeavesRowsBeyondTheCountAlone) { expect_sorted(random_hits(300, 3, 0.1), 3, 4096); }

INSTANTIATE_TEST_SUITE_P(Devices, Partition, ::testing::Bool(),
                         [](const auto &info) { return info.param ? "processor" : "elsewhere"; });

/// However few rows: counts of all bins of a chunk, as in a crop of one pixel of a scene of many BSDF kinds.
TEST(GroupingOf, FewRowsHasRoomForManyBins) {
    Device device;
    Session session(device, scene_of(1), {}, {});
    for (const std::uint32_t bins : {2u, 17u, 19u, 100u})
        for (const std::uint32_t multiple : {1u, 4u})
            for (const std::uint32_t rows : {odd_lines(1), odd_lines(partition_chunk + 1), odd_lines(100000)}) {
                Stages stages;
                for (const TableDeclaration &table :
                     Grouping(session, stages, "group", bins, RowsOf::slot, multiple).tables())
                    if (table.name == "group_chunk_offset") {
                        EXPECT_GE(rows * table.multiple, bins * chunks_of(rows * multiple))
                            << bins << " bins of " << multiple << " x " << rows << " rows";
                    }
            }
}

// Phases are bins of kinds, one after the other, behind those of paths that escaped.
TEST(HitsOf, PhasesLieBehindEachOther) {
    const BinLayout layout = {.escaped = 2, .phases = 3, .kinds = 2};
    ASSERT_EQ(layout.bins(), 14u);
    // Bin b has b + 1 rows.
    std::vector<std::uint32_t> ranges = {0};
    for (std::uint32_t bin = 0; bin < layout.bins(); ++bin)
        ranges.push_back(ranges.back() + bin + 1);
    const Hits hits(layout, ranges);
    EXPECT_EQ(hits.escaped(0).count, 1u);
    EXPECT_EQ(hits.escaped(1).first, 1u);
    EXPECT_EQ(hits.escaped(1).count, 2u);
    EXPECT_EQ(hits.place(0), 3u);
    EXPECT_EQ(hits.count(), ranges.back() - 3);
    EXPECT_EQ(hits.phase(0).first, 0u);
    EXPECT_EQ(hits.phase(0).count, 3u + 4 + 5 + 6);
    EXPECT_EQ(hits.phase(1).first, hits.phase(0).end());
    EXPECT_EQ(hits.phase(2).end(), hits.count());
    EXPECT_EQ(hits.phases(1, 3).first, hits.phase(1).first);
    EXPECT_EQ(hits.phases(1, 3).end(), hits.phase(2).end());
    EXPECT_EQ(hits.phases(1, 1).count, 0u);
    EXPECT_EQ(hits.kind(1, 1).first, hits.kind(1, 0).end());
    EXPECT_EQ(hits.kind(1, 1).count, 9u + 10);
    EXPECT_EQ(hits.emitting(1, 1).first, hits.kind(1, 1).first + 9);
    EXPECT_EQ(hits.emitting(1, 1).count, 10u);
}

TEST(HitsOf, NothingAreEmpty) {
    const Hits hits;
    EXPECT_EQ(hits.count(), 0u);
    EXPECT_EQ(hits.phase(0).count, 0u);
    EXPECT_EQ(hits.kind(0, 0).count, 0u);
    EXPECT_EQ(hits.escaped().count, 0u);
}

// New paths take the rows behind the newest vertices until the pass has begun all of its own.
TEST(WavefrontOf, RefillsWhatThereIsRoomFor) {
    Device device;
    Session session(device, scene_of(1), {}, {});
    Stages stages;
    Wavefront paths(session, stages, {.kinds = 1});
    Tables tables(device, paths.tables(), {64, 256, 16, 4, 1}, Precision::single);
    session.numbers["capacity"] = 64;
    stages.build(session, tables);
    paths.attach(tables);
    const auto meet = [&](std::uint32_t hits, std::uint32_t rows) {
        const auto rays = tables["ray"].map(Access::read_write);
        for (std::uint32_t row = 0; row < rows; ++row)
            rays.as<std::uint32_t>()[std::size_t(ray_primitive) * 64 + row] = row < hits ? 0 : ray_none;
    };
    std::uint32_t slot = 0;
    const auto refill = [&] { return paths.refill(slot); };
    paths.begin_pass(100);
    Range fresh = refill();
    EXPECT_EQ(fresh.first, 0u);
    EXPECT_EQ(fresh.count, 64u);
    EXPECT_EQ(slot, 0u);
    EXPECT_EQ(paths.vertices(), 0u);
    EXPECT_EQ(paths.rays(), 64u);
    meet(40, 64);
    paths.partition();
    const int before = tables.newest();
    paths.advance();
    EXPECT_NE(tables.newest(), before);
    EXPECT_EQ(paths.vertices(), 40u);
    fresh = refill();
    EXPECT_EQ(fresh.first, 40u);
    EXPECT_EQ(fresh.count, 24u);
    EXPECT_EQ(slot, 64u);
    EXPECT_EQ(paths.rays(), 64u);
    meet(1, 64);
    paths.partition();
    paths.advance();
    fresh = refill();
    EXPECT_EQ(fresh.first, 1u);
    EXPECT_EQ(fresh.count, 12u);
    EXPECT_EQ(slot, 88u);
    EXPECT_TRUE(paths.is_alive());
    paths.drop();
    refill();
    EXPECT_FALSE(paths.is_alive());
}

} // namespace
} // namespace gradus
