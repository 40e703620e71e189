// The search for photons near gather points against all pairs one by one.
#include "tests/methods/photon_search_fixture.h"
#include "tests/support/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

namespace gradus::testing {
namespace {

struct Case {
    const char *name;
    Vector3 low, high;
    float radius; ///< the largest
    double edge;  ///< of cells
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

double squared_distance(const SyntheticGatherPoint &point, const SyntheticPhoton &photon) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double difference = double(photon.position[axis]) - point.position[axis];
        sum += difference * difference;
    }
    return sum;
}

/// All pairs, without those so close to the radius that rounding decides; these are counted in `close`.
struct BruteForce {
    std::vector<FoundPair> sure;
    std::vector<FoundPair> close;
};

BruteForce brute_force(const std::vector<SyntheticPhoton> &photons, const std::vector<SyntheticGatherPoint> &points) {
    BruteForce found;
    for (std::uint32_t g = 0; g < points.size(); ++g)
        for (std::uint32_t p = 0; p < photons.size(); ++p) {
            if (photons[p].depth > points[g].deepest)
                continue;
            double facing = 0;
            for (std::size_t axis = 0; axis < 3; ++axis)
                facing += double(photons[p].normal[axis]) * points[g].normal[axis];
            if (facing <= 0.1)
                continue;
            const double ratio =
                squared_distance(points[g], photons[p]) / (double(points[g].radius) * points[g].radius);
            // Differences of coordinates are exact to some last places of the distance, so their squares are too.
            if (std::fabs(ratio - 1) < 1e-6)
                found.close.push_back({g, p});
            else if (ratio < 1)
                found.sure.push_back({g, p});
        }
    return found;
}

void expect_the_same(std::vector<FoundPair> found, const BruteForce &expected) {
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "a pair was found twice";
    std::vector<FoundPair> missed, surplus;
    std::set_difference(expected.sure.begin(), expected.sure.end(), found.begin(), found.end(),
                        std::back_inserter(missed));
    std::set_difference(found.begin(), found.end(), expected.sure.begin(), expected.sure.end(),
                        std::back_inserter(surplus));
    EXPECT_TRUE(missed.empty()) << missed.size() << " pairs of " << expected.sure.size() << " were not found";
    EXPECT_TRUE(std::includes(expected.close.begin(), expected.close.end(), surplus.begin(), surplus.end()))
        << surplus.size() << " pairs too many";
}

class Search : public ::testing::TestWithParam<Case> {};

/// Positions on a lattice of cells as often as between them; normals along the axes; some beyond the box.
struct Scattered {
    std::vector<SyntheticPhoton> photons;
    std::vector<SyntheticGatherPoint> points;
};

Scattered scattered(const Case &c, std::size_t photons, std::size_t points) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    const std::array<float, 3> low = {c.low.x, c.low.y, c.low.z}, high = {c.high.x, c.high.y, c.high.z};
    const auto position = [&] {
        std::array<float, 3> p{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float size = high[axis] - low[axis];
            p[axis] = low[axis] + (1.02f * unit(random) - 0.01f) * size;
            if (unit(random) < 0.3f) // on the border of cells
                p[axis] = float(low[axis] + c.edge * std::floor((p[axis] - low[axis]) / c.edge));
        }
        return p;
    };
    const auto normal = [&] {
        std::array<float, 3> n{};
        n[std::size_t(unit(random) * 2)] = unit(random) < 0.5f ? 1.0f : -1.0f;
        return n;
    };
    Scattered all;
    for (std::size_t i = 0; i < photons; ++i)
        all.photons.push_back({position(), normal(), 1 + std::uint32_t(unit(random) * 4)});
    for (std::size_t i = 0; i < points; ++i) {
        SyntheticGatherPoint point{position(), normal(), c.radius * (0.1f + 0.9f * unit(random)), 0};
        if (unit(random) < 0.2f) // exactly on a photon, on its surface
            point.position = all.photons[i % photons].position, point.normal = all.photons[i % photons].normal;
        point.deepest = std::uint32_t(unit(random) * 6);
        all.points.push_back(point);
    }
    return all;
}

TEST_P(Search, FindsWhatBruteForceFinds) {
    const Case &c = GetParam();
    constexpr std::uint32_t photons = 20000;
    const Scattered all = scattered(c, photons, 700);
    PhotonSearch search(shared_device(), c.low, c.high, photons, 768);
    search.place(all.photons, all.points);
    const std::vector<FoundPair> found = search.find(c.edge);
    EXPECT_EQ(found.size(), search.total);
    EXPECT_TRUE(std::ranges::is_sorted(found, {}, &FoundPair::gather)) << "pairs of a gather point are apart";
    const BruteForce expected = brute_force(all.photons, all.points);
    EXPECT_GT(expected.sure.size(), 1000u) << "too few to tell";
    expect_the_same(found, expected);
}

INSTANTIATE_TEST_SUITE_P(
    Photons, Search,
    ::testing::Values(Case{"cells_of_the_radius", {-1, -1, -1}, {1, 1, 1}, 0.3f, 0.3},
                      Case{"small_cells", {-1, -1, -1}, {1, 1, 1}, 0.3f, 0.07},
                      Case{"large_cells", {-1, -1, -1}, {1, 1, 1}, 0.3f, 1.7},
                      Case{"one_cell", {-1, -1, -1}, {1, 1, 1}, 0.3f, 50},
                      // So many cells that lines of them are hashed to the same keys.
                      Case{"hashed_cells", {-1, -1, -1}, {1, 1, 1}, 0.3f, 0.012},
                      // So many lines that all photons are looked at.
                      Case{"many_cells_a_radius", {-1, -1, -1}, {1, 1, 1}, 0.5f, 0.012},
                      Case{"more_lines_than_numbers", {-1, -1, -1}, {1, 1, 1}, 0.3f, 1e-9},
                      Case{"small_scene", {1e-3f, -2e-3f, 0}, {2e-3f, -1e-3f, 1e-3f}, 1.5e-4f, 1e-4},
                      Case{"large_scene", {-1e4f, -1e4f, -1e4f}, {1e4f, 1e4f, 1e4f}, 3e3f, 2e3},
                      Case{"far_from_the_origin", {9e3f, 9e3f, -9e3f}, {9002, 9002, -8998}, 0.3f, 0.3},
                      Case{"flat_scene", {-1, -1, 0}, {1, 1, 0}, 0.1f, 0.1}),
    [](const auto &info) { return info.param.name; });

// Of the pairs of strangers that hashing brings together none may be taken: all photons in two lines of one key.
TEST(PhotonHash, DoesNotCountPhotonsTwice) {
    const Bounds box{{-1, -1, -1}, {1, 1, 1}};
    const double edge = 0.012;
    const PhotonGrid grid(box, edge, 1u << 21);
    ASSERT_NE(grid.line_shift, 0u) << "not hashed";
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    Scattered all;
    constexpr std::uint32_t photons = 200003, points = 4; // more photons than lines within reach, which are looked at
    for (std::uint32_t i = 0; i < photons; ++i)           // within the reach of all
        all.photons.push_back({{0.2f * unit(random), 0.2f * unit(random), 0.2f * unit(random)}, {0, 0, 1}, 1});
    for (std::uint32_t i = 0; i < points; ++i)
        all.points.push_back({{0.1f * unit(random), 0.1f * unit(random), 0.1f * unit(random)}, {0, 0, 1}, 0.9f, 5});
    PhotonSearch search(shared_device(), {-1, -1, -1}, {1, 1, 1}, photons, 64);
    search.place(all.photons, all.points);
    expect_the_same(search.find(edge), brute_force(all.photons, all.points));
    EXPECT_EQ(search.total, photons * points);
    EXPECT_GT(search.windows, points * photons / PhotonPairs::pair_rows(64));
}

// What listing looks at goes by the photons near gather points, not by the windows times these: a search of hundreds of
// windows looks once at each, and once more at those of the block in which a window ends.
TEST(PhotonSearch, LooksAtEachPhotonOnceWhateverTheWindows) {
    constexpr std::uint32_t block = 32; // PHOTON_BLOCK of kernels/stages/photon_pairs.cl
    const Case c{"", {-1, -1, -1}, {1, 1, 1}, 0.8f, 0.3};
    Scattered all = scattered(c, 6000, 64);
    for (SyntheticGatherPoint &point : all.points)
        point.radius = 5; // all photons of its direction
    std::vector<FoundPair> found[2];
    std::uint64_t looked[2];
    std::size_t windows[2];
    for (int i = 0; i < 2; ++i) {
        PhotonSearch search(shared_device(), c.low, c.high, 6000, i == 0 ? 64 : 65536);
        search.place(all.photons, all.points);
        found[i] = search.find(c.edge);
        looked[i] = search.looked_at();
        windows[i] = search.windows;
    }
    fmt::print("{} windows: {} photons looked at; {} window: {}\n", windows[0], looked[0], windows[1], looked[1]);
    EXPECT_GT(windows[0], 200u);
    EXPECT_EQ(windows[1], 1u);
    EXPECT_EQ(found[0], found[1]);
    EXPECT_GE(looked[1], found[1].size());
    EXPECT_LE(looked[0], looked[1] + block * windows[0]);
}

// Windows of any size give the same sums, bit for bit; one gather point has more pairs than a window has room for.
TEST(PhotonSums, DoNotDependOnWindows) {
    const Case c{"", {-1, -1, -1}, {1, 1, 1}, 0.8f, 0.3};
    Scattered all = scattered(c, 6000, 64);
    all.points[40].radius = 5; // all photons
    const auto value = [](std::uint32_t photon) { return 0.1f + float(photon % 97) / 91.0f; };
    std::vector<float> sums[2];
    std::size_t windows[2];
    for (int i = 0; i < 2; ++i) {
        PhotonSearch search(shared_device(), c.low, c.high, 6000, i == 0 ? 64 : 65536);
        search.place(all.photons, all.points);
        sums[i] = search.sums(c.edge, value);
        windows[i] = search.windows;
    }
    EXPECT_GT(windows[0], 10u);
    EXPECT_EQ(windows[1], 1u);
    EXPECT_EQ(sums[0], sums[1]);
}

TEST(PhotonSearch, OfNoPhotonsFindsNone) {
    PhotonSearch search(shared_device(), {-1, -1, -1}, {1, 1, 1}, 1, 64);
    search.place({}, {{{0, 0, 0}, {0, 0, 1}, 1, 5}});
    EXPECT_TRUE(search.find(0.1).empty());
    search.place({{{0, 0, 0.5f}, {0, 0, 1}, 1}}, {{{0, 0, 0}, {0, 0, 1}, 1, 5}, {{0, 0, 1.6f}, {0, 0, 1}, 1, 5}});
    EXPECT_EQ(search.find(0.1), (std::vector<FoundPair>{{0, 0}}));
}

} // namespace
} // namespace gradus::testing
