// The sort against std::stable_sort, and the runs and sums of runs against sums in double.
#include "runtime/wavefront/runs.h"
#include "runtime/wavefront/sort.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>

namespace gradus {
namespace {

using Uints = std::vector<std::uint32_t>;
constexpr std::uint32_t any = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t columns = 2;

/// A sort with its runs, for so many rows.
class Sorter {
  public:
    Sorter(Device &device, std::uint32_t capacity, std::uint32_t work_group_size = 0)
        : session_(device, maker_.scene, options(work_group_size), {}), sort(session_, stages_, "sort", RowsOf::path),
          runs(stages_, sort, columns) {
        TableList list = sort.tables();
        for (const TableDeclaration &table : runs.tables())
            list.push_back(table);
        tables.emplace(device, list, TableRows{capacity, capacity, 16, 4, 1}, Precision::single);
        stages_.build(session_, *tables);
        sort.attach(*tables);
        runs.attach(*tables);
    }

    Buffer buffer(const Uints &values) { return Buffer(session_.device, "keys", values.data(), 4 * values.size()); }
    Buffer buffer(const std::vector<float> &values) {
        return Buffer(session_.device, "values", values.data(), 4 * values.size());
    }
    Uints uints(const char *name, std::size_t count) const {
        Uints values(count);
        if (count > 0)
            (*tables)[name].read(values.data(), 4 * count);
        return values;
    }

  private:
    static SessionOptions options(std::uint32_t work_group_size) {
        SessionOptions options;
        options.work_group_size = work_group_size;
        return options;
    }
    testing::SceneMaker maker_{4, 1};
    Session session_;
    Stages stages_;

  public:
    Sort sort;
    Runs runs;
    std::optional<Tables> tables;
};

class SortTest : public ::testing::Test {
  protected:
    static constexpr std::uint32_t capacity = 600'000;
    static Sorter &sorter() {
        static Device device;
        static Sorter sorter(device, capacity);
        return sorter;
    }

    Uints random_keys(std::size_t count, std::uint32_t highest) {
        std::uniform_int_distribution<std::uint32_t> distribution(0, highest);
        Uints keys(count);
        for (std::uint32_t &key : keys)
            key = distribution(engine);
        return keys;
    }

    static Uints sorted_rows(const Uints &keys, std::uint32_t highest, Uints rows = {}) {
        if (rows.empty()) {
            rows.resize(keys.size());
            std::iota(rows.begin(), rows.end(), 0u);
        }
        const auto key = [&](std::uint32_t row) { return std::min<std::uint64_t>(keys[row], highest + 1ull); };
        std::stable_sort(rows.begin(), rows.end(), [&](auto a, auto b) { return key(a) < key(b); });
        return rows;
    }

    /// Sorts and checks keys, rows and runs.
    static void expect_sorted(const Uints &keys, std::uint32_t highest = any) {
        Sorter &s = sorter();
        const auto count = std::uint32_t(keys.size());
        const Buffer from = s.buffer(keys);
        s.sort.run(from, count, highest);
        s.runs.find(count);
        const Uints expected = sorted_rows(keys, highest), rows = s.uints("sort_index", count);
        const Uints sorted = s.uints("sort_key", count);
        for (std::uint32_t i = 0; i < count; ++i) {
            ASSERT_EQ(rows[i], expected[i]) << "place " << i << " of " << count;
            const std::uint32_t key = keys[expected[i]];
            ASSERT_EQ(sorted[i], key > highest ? highest + 1 : key) << "place " << i;
        }
        Uints unchanged(count);
        if (count > 0)
            from.read(unchanged.data(), 4 * count);
        EXPECT_EQ(unchanged, keys);

        const std::uint32_t runs = s.runs.number();
        const Uints key = s.uints("sort_run_key", runs), begin = s.uints("sort_run_begin", runs),
                    end = s.uints("sort_run_end", runs);
        std::uint32_t i = 0;
        for (std::uint32_t run = 0; run < runs; ++run) {
            ASSERT_EQ(begin[run], i) << "run " << run;
            ASSERT_LT(i, count);
            while (i < count && sorted[i] == sorted[begin[run]])
                ++i;
            ASSERT_EQ(end[run], i) << "run " << run;
            ASSERT_EQ(key[run], sorted[begin[run]]) << "run " << run;
        }
        EXPECT_EQ(i, count);
    }

    std::mt19937 engine{3};
};

/// Tables of runs do not grow with those of the sort.
TEST_F(SortTest, RunsOfMoreRowsThanThereIsRoomForAreRefused) {
    Device device;
    Sorter small(device, 600);
    small.sort.grow(2);
    const Uints keys = random_keys(1200, 7);
    small.sort.run(small.buffer(keys), 600, 7);
    EXPECT_NO_THROW(small.runs.find(600));
    small.sort.run(small.buffer(keys), 1200, 7);
    EXPECT_THROW(small.runs.find(601), std::logic_error);
}

TEST_F(SortTest, OfNoRowsAndOfOne) {
    expect_sorted({});
    expect_sorted({0});
    expect_sorted({any});
    expect_sorted({5}, 0);
    expect_sorted({}); // after one
}

// A chunk has 512 rows at least, and there are 256 to 1024 of them, by the device: more rows need longer ones.
TEST_F(SortTest, AtTheBordersOfChunks) {
    for (const std::uint32_t count :
         {2u, 511u, 512u, 513u, 1023u, 1025u, 32769u, 131'071u, 131'073u, 524'289u, capacity}) {
        SCOPED_TRACE(count);
        expect_sorted(random_keys(count, 7), 7);
        expect_sorted(random_keys(count, any));
    }
}

TEST_F(SortTest, EveryNumberOfBits) {
    for (std::uint32_t bits = 0; bits <= 32; ++bits) {
        SCOPED_TRACE(bits);
        const std::uint32_t highest = bits == 32 ? any : (1u << bits) - 1;
        expect_sorted(random_keys(3000, highest), highest);
        expect_sorted(random_keys(3000, highest), highest > 0 ? highest - 1 : 0); // last takes no further bit
    }
}

TEST_F(SortTest, EqualDifferentAndOrderedKeys) {
    constexpr std::uint32_t count = 70'000;
    expect_sorted(Uints(count, 0));
    expect_sorted(Uints(count, 77), 100);
    expect_sorted(Uints(count, any));
    Uints keys(count);
    std::iota(keys.begin(), keys.end(), any - count + 1);
    expect_sorted(keys);
    std::reverse(keys.begin(), keys.end());
    expect_sorted(keys);
    std::shuffle(keys.begin(), keys.end(), engine);
    expect_sorted(keys);
    for (std::uint32_t row = 0; row < count; ++row) // long runs that end within chunks
        keys[row] = row / 1300 * 3;
    expect_sorted(keys);
}

TEST_F(SortTest, KeysAboveTheHighestComeLast) {
    expect_sorted(random_keys(20'000, 3000), 1000);
    expect_sorted(random_keys(20'000, any), 255);
    expect_sorted(random_keys(20'000, any), 65'534);
    expect_sorted(random_keys(20'000, any), any - 1);
    expect_sorted(Uints(600, 9), 3);
}

TEST_F(SortTest, ByTwoKeys) {
    Sorter &s = sorter();
    for (const std::uint32_t highest : {1u, 200u, 300u, 70'000u, any}) { // an odd and an even number of passes
        const Uints lower = random_keys(40'000, 1000), upper = random_keys(40'000, highest > 50 ? 50 : highest);
        const Buffer lower_keys = s.buffer(lower), upper_keys = s.buffer(upper);
        s.sort.run(lower_keys, 40'000, 900);
        s.sort.again(upper_keys, 40'000, highest);
        EXPECT_EQ(s.uints("sort_index", 40'000), sorted_rows(upper, highest, sorted_rows(lower, 900))) << highest;
    }
}

TEST_F(SortTest, RefusesMoreRowsThanRoom) {
    const Buffer keys = sorter().buffer(Uints(capacity + 1));
    EXPECT_THROW(sorter().sort.run(keys, capacity + 1, 1), std::logic_error);
    EXPECT_THROW(sorter().sort.run(sorter().buffer(Uints(5)), 6, 1), std::logic_error);
    EXPECT_THROW(sorter().runs.sum(keys, 1, 0, columns + 1), std::logic_error);
}

using RunSums = SortTest;

// Of both signs, over nine powers of ten. A compensated sum is off by half of its last place and by some
// n u^2 of the sum of magnitudes: for 1e5 numbers and u = 6e-8, 4e-10 of it. The limit is ten times that, a plain sum
// would be off by more.
TEST_F(RunSums, AreThoseInDouble) {
    constexpr std::uint32_t count = 100'000, stride = count + 5;
    Sorter &s = sorter();
    std::normal_distribution<double> normal;
    for (const std::uint32_t highest : {0u, 3u, 999u, 1'000'000u}) {
        const Uints keys = random_keys(count, highest);
        std::vector<float> values(4 * stride);
        for (float &value : values)
            value = float(normal(engine) * std::pow(10.0, 3 * normal(engine)));
        const Buffer from = s.buffer(keys), value = s.buffer(values);
        s.sort.run(from, count, highest);
        s.runs.find(count);
        s.runs.sum(value, stride, 1, columns);
        const std::uint32_t runs = s.runs.number();
        const Uints key = s.uints("sort_run_key", runs);
        std::vector<float> sums(columns * capacity);
        (*s.tables)["sort_run_sum"].read(sums.data(), 4 * sums.size());
        std::vector<double> sum(highest + 1), magnitude(highest + 1);
        for (std::uint32_t c = 0; c < columns; ++c) {
            std::fill(sum.begin(), sum.end(), 0.0);
            std::fill(magnitude.begin(), magnitude.end(), 0.0);
            for (std::uint32_t row = 0; row < count; ++row) {
                const double x = values[(1 + c) * stride + row];
                sum[keys[row]] += x;
                magnitude[keys[row]] += std::fabs(x);
            }
            for (std::uint32_t run = 0; run < runs; ++run)
                ASSERT_NEAR(sums[c * capacity + run], sum[key[run]],
                            6e-8 * std::fabs(sum[key[run]]) + 4e-9 * magnitude[key[run]])
                    << "run " << run << " of " << runs;
        }
    }
}

TEST_F(RunSums, KeepWhatIsNotFiniteToItself) {
    Sorter &s = sorter();
    const Buffer keys = s.buffer(Uints{2, 1, 2, 1, 3}),
                 values = s.buffer(std::vector<float>{1, 2, NAN, 4, INFINITY, 0, 0, 0, 0, 0});
    s.sort.run(keys, 5, 3);
    s.runs.find(5);
    s.runs.sum(values, 5, 0, 1);
    std::vector<float> sums(3);
    (*s.tables)["sort_run_sum"].read(sums.data(), 12);
    EXPECT_EQ(sums[0], 6);
    EXPECT_FALSE(std::isfinite(sums[1]));
    EXPECT_FALSE(std::isfinite(sums[2]));
}

} // namespace
} // namespace gradus
