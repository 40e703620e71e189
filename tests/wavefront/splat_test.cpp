// Splats: their sums, what is left out, and that they are the same bits always.
#include "tests/driver/child_process.h"
#include "tests/wavefront/splat_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradus {
namespace {

using namespace testing;
using namespace lib_float;

Device &device() {
    static Device device;
    return device;
}

constexpr std::uint32_t side = 37, pixels = side * side, room = 50'000;

// A pixel gets up to 2000 splats; a compensated sum is off by less than its last place, 6e-8, and the image rounds
// once more.
TEST(SplatTest, AddsToEachPixelItsOwn) {
    const std::vector<SplatRow> rows = random_splats(room, pixels);
    for (const Precision precision : {Precision::single, Precision::relaxed, Precision::double_}) {
        if (precision == Precision::double_ && !device().description().has_double)
            continue;
        SessionOptions options;
        options.precision = precision;
        SplatFilm film(device(), side, room, Splats::Order::rows, options);
        film.add(rows);
        std::vector<std::array<double, 3>> expected(pixels);
        for (const SplatRow &row : rows)
            for (std::size_t c = 0; c < 3 && row.pixel != splat_none; ++c)
                expected[row.pixel][c] += row.value[c];
        std::uint64_t non_finite = 0;
        const Image image = film.film.image(0, non_finite, 7);
        EXPECT_EQ(non_finite, 0u);
        const char *const colors[] = {"R", "G", "B"};
        for (std::size_t c = 0; c < 3; ++c)
            for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
                ASSERT_NEAR(image.find(colors[c])->values[pixel], expected[pixel][c] / 7,
                            1.3e-7 * expected[pixel][c] / 7)
                    << colors[c] << " of pixel " << pixel;
    }
}

TEST(SplatTest, LeavesOutAndCountsWhatIsNotFinite) {
    SplatFilm film(device(), 2, 10);
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    film.add({{0, {1, 2, 3}},
              {1, {1, 2, nan}},
              {1, {1, 2, 3}},
              {3, {-infinity, 0, 0}},
              {splat_none, {nan, nan, nan}},
              {0, {1, infinity, 3}},
              {4, {5, 5, 5}}, // beyond the film
              {0, {10, 20, 30}}});
    film.add({});
    std::uint64_t non_finite = 0;
    const Image image = film.film.image(0, non_finite, 1);
    EXPECT_EQ(non_finite, 3u);
    const std::vector<float> red = {11, 1, 0, 0}, blue = {33, 3, 0, 0};
    EXPECT_EQ(image.find("R")->values, red);
    EXPECT_EQ(image.find("B")->values, blue);
}

TEST(SplatTest, AreAddedToTheMeansOfSamples) {
    SplatFilm film(device(), 2, 10);
    const auto radiance = [&](std::vector<float> values) {
        values.resize((*film.tables)["radiance"].bytes() / sizeof(float));
        const auto view = (*film.tables)["radiance"].map(Access::write);
        std::copy(values.begin(), values.end(), view.as<float>());
    };
    radiance({1, 2, 3});
    film.film.add(3, 0);
    radiance({3});
    film.film.add(1, 0);
    film.add({{0, {8, 0, 0}}, {3, {16, 0, 0}}, {0, {8, 0, 0}}});
    std::uint64_t non_finite = 0;
    const auto red = [&](std::uint64_t light_paths) { // of 8 samples, two of each pixel
        return film.film.image(8, non_finite, light_paths).find("R")->values;
    };
    EXPECT_EQ(red(8), (std::vector<float>{2 + 2, 1, 1.5, 2}));
    EXPECT_EQ(red(0), (std::vector<float>{2, 1, 1.5, 0}));
    film.film.clear();
    EXPECT_EQ(red(8), (std::vector<float>{0, 0, 0, 0}));
}

// A million of 1e-3 on 1e4: a plain float sum is off by more than a tenth of it (tests/stages/film_stage_test.cpp).
TEST(SplatTest, LoseNothingToRounding) {
    constexpr std::uint32_t many = 1'000'000;
    SplatFilm film(device(), 2, many);
    film.add({{3, {1e4, 1e4, 1e4}}});
    film.add(std::vector<SplatRow>(many, {3, {1e-3, 1e-3, 1e-3}}));
    std::uint64_t non_finite = 0;
    const double expected = 1e4 + many * double(1e-3f);
    const Image image = film.film.image(0, non_finite, 1);
    for (const Channel &channel : image.channels)
        EXPECT_NEAR(channel.values[3], expected, 1.2e-7 * expected);
}

std::vector<std::uint32_t> bits_of(const std::vector<SplatRow> &rows, std::size_t batch, std::uint32_t work_group_size,
                                   Splats::Order order = Splats::Order::rows) {
    SessionOptions options;
    options.work_group_size = work_group_size;
    SplatFilm film(device(), side, room, order, options);
    for (std::size_t first = 0; first < rows.size(); first += batch)
        film.add(rows, first, std::min(batch, rows.size() - first));
    return film.bits();
}

TEST(SplatTest, AreTheSameBitsInAnyBatchesAndWorkGroups) {
    std::vector<SplatRow> rows = random_splats(room, pixels);
    rows[1000].value[1] = NAN;
    const std::vector<std::uint32_t> expected = bits_of(rows, room, 0);
    for (const std::size_t batch : {1001, 4096, 49'999})
        EXPECT_EQ(bits_of(rows, batch, 0), expected) << "batches of " << batch;
    for (const std::uint32_t work_group_size : {16u, 256u})
        EXPECT_EQ(bits_of(rows, room, work_group_size), expected) << "work-groups of " << work_group_size;
    std::reverse(rows.begin(), rows.end()); // bits depend on the order: there is something to get wrong
    EXPECT_NE(bits_of(rows, room, 0), expected);
}

/// The splats of paths with one to nine bounces as a wavefront leaves them: passes of so many paths, in each of which
/// all paths make their first bounce, in any order, then those that are left the next.
std::vector<std::vector<SplatRow>> wavefront_of(const std::vector<SplatRow> &splats, std::uint32_t paths,
                                                std::uint32_t pass, std::mt19937 &engine) {
    std::vector<std::vector<SplatRow>> passes;
    for (std::uint32_t first = 0; first < paths; first += pass) {
        std::vector<std::uint32_t> alive(std::min(pass, paths - first));
        std::iota(alive.begin(), alive.end(), first);
        std::vector<SplatRow> rows;
        for (std::uint32_t bounce = 0; !alive.empty(); ++bounce) {
            std::shuffle(alive.begin(), alive.end(), engine);
            for (const std::uint32_t path : alive) {
                rows.push_back(splats[path * 9 + bounce]);
                rows.back().path = path - first;
            }
            std::erase_if(alive, [&](std::uint32_t path) { return bounce == path * 7 % 9; });
        }
        passes.push_back(rows);
    }
    return passes;
}

TEST(SplatTest, OfPathsAreTheSameBitsHoweverPathsAreMixed) {
    constexpr std::uint32_t paths = 5000;
    const std::vector<SplatRow> splats = random_splats(paths * 9, pixels);
    std::mt19937 engine(7);
    const auto bits = [&](std::uint32_t pass, Splats::Order order) {
        SplatFilm film(device(), side, room, order);
        for (const std::vector<SplatRow> &rows : wavefront_of(splats, paths, pass, engine))
            film.add(rows);
        return film.bits();
    };
    const std::vector<std::uint32_t> expected = bits(paths, Splats::Order::paths);
    for (const std::uint32_t pass : {paths, 4999u, 1000u, 64u})
        EXPECT_EQ(bits(pass, Splats::Order::paths), expected) << "passes of " << pass;
    EXPECT_NE(bits(paths, Splats::Order::rows), expected); // that is what the order is for
}

class SplatProcess : public ProgramTest {
  protected:
    /// What splat_digest says of so many splats, run by `command`. GRADUS_PROGRAM is `env` here.
    Outcome digest(std::vector<std::string> command, const std::string &splats, const std::string &threads) const {
        command.insert(command.end(), {GRADUS_SPLAT_DIGEST, splats, threads});
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome;
    }
};

TEST_F(SplatProcess, GivesTheSameBitsWithAnyNumberOfThreads) {
    const Outcome one = digest({}, "100000", "1");
    EXPECT_GT(one.out.size(), 8u);
    for (const std::string threads : {"2", "3"}) {
        const Outcome more = digest({}, "100000", threads);
        EXPECT_NE(more.err.find(threads + " compute units"), std::string::npos) << more.err;
        EXPECT_EQ(more.out, one.out) << threads << " threads";
    }
}

/// As in tests/portability/oclgrind_test.cpp, which shows that these options find what they are to find; but without
/// reads of uninitialised memory: oclgrind 21.10 reports such of keys that sort_begin has just written.
TEST_F(SplatProcess, IsCleanUnderOclgrind) {
    if (!has_oclgrind())
        GTEST_SKIP() << "needs oclgrind (apt install oclgrind; Debian 13 has none)";
    const Outcome outcome = digest({"oclgrind", "--data-races", "--uniform-writes", "--check-api", "--log",
                                    at("report.txt"), "--build-options", "-cl-opt-disable -D GRADUS_FN=static"},
                                   "1100", "1");
    EXPECT_NE(outcome.err.find("Oclgrind"), std::string::npos) << outcome.err;
    EXPECT_EQ(text_of("report.txt").substr(0, 4000), "");
    EXPECT_EQ(outcome.out, digest({}, "1100", "1").out); // and the same bits as on another implementation
}

} // namespace
} // namespace gradus
