// Manifold walks against chains in closed form, against themselves turned around, and where there is no way.
#include "tests/wavefront/walk_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "kernels/lib/chain_spread.h"

namespace gradus {
namespace {

using namespace lib_float;
using testing::ChainEnd;
using testing::Point;
using testing::WalkChain;
using testing::Walker;
using testing::WalkResult;

Point operator+(const Point &a, const Point &b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator-(const Point &a, const Point &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point operator*(double s, const Point &a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Point &a, const Point &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Point &a) { return std::sqrt(dot(a, a)); }
Point unit(const Point &a) { return 1 / length(a) * a; }

class Random {
  public:
    explicit Random(unsigned seed) : engine(seed) {}
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    Point direction() {
        std::normal_distribution<double> normal;
        return unit({normal(engine), normal(engine), normal(engine)});
    }
    std::mt19937_64 engine;
};

/// The cube [-1, 1]^3, diffuse, seen from within.
testing::SceneMaker room() {
    testing::SceneMaker maker(4, 1);
    maker.cube(maker.material(testing::diffuse(0.5)), -1, true);
    return maker;
}

Scene plane_mirror() {
    testing::SceneMaker maker = room();
    maker.parallelogram({-0.9f, -0.9f, -0.5f}, {1.8f, 0, 0}, {0, 1.8f, 0}, maker.material(testing::mirror()));
    return maker.scene;
}
constexpr double slab_half = 0.1, slab_ior = 1.5;
Scene slab() {
    testing::SceneMaker maker = room();
    const std::uint32_t glass = maker.material(testing::glass(slab_ior));
    maker.parallelogram({-0.99f, -0.99f, float(slab_half)}, {1.98f, 0, 0}, {0, 1.98f, 0}, glass);
    maker.parallelogram({-0.99f, -0.99f, -float(slab_half)}, {0, 1.98f, 0}, {1.98f, 0, 0}, glass);
    return maker.scene;
}
constexpr float radius = 0.3f;
Scene sphere_of(const Bsdf &bsdf) {
    testing::SceneMaker maker = room();
    maker.sphere({0, 0, 0}, radius, maker.material(bsdf));
    return maker.scene;
}

/// `count` chains from the region above, each to be moved by up to `most` in the plane of its end's surface. `keeps`
/// says which chains are wanted.
std::vector<WalkChain> draw_chains(Walker &walker, Random &random, std::size_t count, double most, double slope,
                                   const std::function<bool(const WalkChain &)> &keeps = {}) {
    std::vector<WalkChain> chains;
    for (std::size_t tries = 0; chains.size() < count && tries < 300 * count; ++tries) {
        const ChainEnd start = {
            {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.5, 0.9)}, {}, 0};
        const Point towards = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.6, 0.3)};
        std::optional<WalkChain> chain = walker.sampler.sample(
            start, towards - start.position, walker.walk.settings().most_vertices, slope, random.engine);
        if (!chain || (keeps && !keeps(*chain)))
            continue;
        const Point aside = random.direction();
        const Point within = aside - dot(aside, chain->end.normal) * chain->end.normal;
        chain->target.position = chain->end.position + random.uniform(0, most) * within;
        chains.push_back(*chain);
    }
    EXPECT_EQ(chains.size(), count) << "chains are rare";
    return chains;
}

std::map<std::string, std::size_t> tally(const std::vector<WalkResult> &results) {
    static const char *const names[] = {
#define GRADUS_OUTCOME_TEXT(name, text) #name,
        GRADUS_WALK_OUTCOMES(GRADUS_OUTCOME_TEXT)
#undef GRADUS_OUTCOME_TEXT
    };
    std::map<std::string, std::size_t> found;
    for (const WalkResult &result : results)
        ++found[names[std::min<std::uint32_t>(result.outcome, walk_outcomes - 1)]];
    return found;
}
std::string text_of(const std::map<std::string, std::size_t> &found) {
    std::string text;
    for (const auto &[name, count] : found)
        text += " " + name + " " + std::to_string(count);
    return text;
}

WalkSettings settings_of(Precision precision) {
    WalkSettings settings;
    settings.steps = 20;
    settings.tolerance = precision == Precision::double_ ? 1e-12 : 1e-6;
    return settings;
}

/// The largest error of vertices against a closed form, where the walk has arrived.
struct Accuracy {
    double largest = 0;
    std::size_t arrived = 0, count = 0;
};
using ClosedForm = std::function<std::vector<Point>(const WalkChain &, const WalkResult &)>;

Accuracy accuracy(const Scene &scene, Precision precision, std::size_t vertices, double most_move,
                  const ClosedForm &closed_form) {
    SessionOptions options;
    options.precision = precision;
    Walker walker(scene, 512, settings_of(precision), options);
    Random random(3);
    const std::vector<WalkChain> chains = draw_chains(
        walker, random, 400, most_move, 0, [&](const WalkChain &c) { return c.vertices.size() == vertices; });
    const std::vector<WalkResult> results = walker.run(chains);
    Accuracy a;
    a.count = chains.size();
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (results[i].outcome != walk_arrived)
            continue;
        ++a.arrived;
        const std::vector<Point> expected = closed_form(chains[i], results[i]);
        for (std::size_t k = 0; k < vertices; ++k)
            a.largest = std::max(a.largest, length(results[i].vertices[k].position - expected[k]));
    }
    std::printf("  %zu of %zu arrived, largest error %.1e;%s\n", a.arrived, a.count, a.largest,
                text_of(tally(results)).c_str());
    return a;
}

double bisect(double low, double high, const std::function<double(double)> &f) {
    const bool rises = f(low) < f(high);
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        ((f(middle) < 0) == rises ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

// What errors are allowed. The walk ends where the last segment is off by the tolerance (1e-6 in float, 1e-12 in
// double), or by 2^-21 in float of the coordinates, all of order 1; a chain magnifies that little here, where most of a
// path lies before its first vertex or after its last.
double allowed(Precision precision) { return precision == Precision::double_ ? 1e-10 : 1e-5; }

const Precision precisions[] = {Precision::single, Precision::double_};

TEST(ManifoldWalkOf, PlaneMirrorIsThatOfTheImage) {
    for (const Precision precision : precisions) {
        const Accuracy a = accuracy(plane_mirror(), precision, 1, 0.3, [](const WalkChain &chain, const WalkResult &) {
            const double plane = -0.5, above = chain.start.position[2] - plane;
            const Point image = {chain.start.position[0], chain.start.position[1], plane - above};
            const Point way = chain.target.position - image;
            return std::vector<Point>{image + above / way[2] * way};
        });
        EXPECT_LT(a.largest, allowed(precision));
        EXPECT_GT(a.arrived, a.count * 8 / 10);
    }
}

// In the plane of incidence both sides of the slab turn alike: the tangents add up to the way aside.
TEST(ManifoldWalkOf, SlabIsThatOfSnellsLaw) {
    for (const Precision precision : precisions) {
        const Accuracy a = accuracy(slab(), precision, 2, 0.3, [](const WalkChain &chain, const WalkResult &) {
            const Point from = chain.start.position, to = chain.target.position;
            const double half = float(slab_half), ior = float(slab_ior);
            const double aside = std::hypot(to[0] - from[0], to[1] - from[1]);
            const Point along =
                aside > 0 ? Point{(to[0] - from[0]) / aside, (to[1] - from[1]) / aside, 0} : Point{1, 0, 0};
            const double above = from[2] - half, below = -half - to[2];
            const auto tangent = [](double sine) { return sine / std::sqrt((1 - sine) * (1 + sine)); };
            const double sine = bisect(0, 1 - 1e-15, [&](double s) {
                return (above + below) * tangent(s) + 2 * half * tangent(s / ior) - aside;
            });
            const double first = above * tangent(sine), second = first + 2 * half * tangent(sine / ior);
            return std::vector<Point>{{from[0] + first * along[0], from[1] + first * along[1], half},
                                      {from[0] + second * along[0], from[1] + second * along[1], -half}};
        });
        EXPECT_LT(a.largest, allowed(precision));
        EXPECT_GT(a.arrived, a.count * 8 / 10);
    }
}

// In the plane of center, start and target, where both ways make the same angle with the normal.
TEST(ManifoldWalkOf, SphereMirrorIsWhereAnglesAreEqual) {
    for (const Precision precision : precisions) {
        const Accuracy a =
            accuracy(sphere_of(testing::mirror()), precision, 1, 0.3, [](const WalkChain &chain, const WalkResult &) {
                const Point from = chain.start.position, to = chain.target.position, x = unit(from);
                const Point y = unit(to - dot(to, x) * x);
                const double most = std::atan2(dot(to, y), dot(to, x)), r = radius;
                const auto at = [&](double angle) { return r * (std::cos(angle) * x + std::sin(angle) * y); };
                const auto difference = [&](double angle) {
                    const Point p = at(angle), tangent = -std::sin(angle) * x + std::cos(angle) * y;
                    return dot(unit(from - p) + unit(to - p), tangent);
                };
                return std::vector<Point>{at(bisect(0, most, difference))};
            });
        EXPECT_LT(a.largest, allowed(precision));
        EXPECT_GT(a.arrived, a.count * 7 / 10);
    }
}

// A ray with impact parameter b turns by 2 (i - t) in the plane of its start and the center, sin i = b / r,
// sin t = b / (ior r). There may be several ways to the target; the one that is near what the walk found must be it.
TEST(ManifoldWalkOf, SphereLensIsThatOfSnellsLaw) {
    for (const Precision precision : precisions) {
        const double ior = float(1.5);
        const Accuracy a = accuracy(
            sphere_of(testing::glass(1.5)), precision, 2, 0.3, [&](const WalkChain &chain, const WalkResult &result) {
                const Point from = chain.start.position, to = chain.target.position, x = -1 * unit(from);
                const Point y = unit(to - dot(to, x) * x);
                const double away = length(from), r = radius;
                const auto points = [&](double angle) {
                    const double b = away * std::sin(angle); // signed
                    const double in = std::asin(b / r), inside = std::asin(b / (ior * r));
                    const Point direction = std::cos(angle) * x + std::sin(angle) * y;
                    const double near = away * std::cos(angle) - r * std::cos(in);
                    const Point first = from + near * direction;
                    const double turned = angle - (in - inside); // the ray turns to the center
                    const Point within = std::cos(turned) * x + std::sin(turned) * y;
                    const Point second = first + 2 * r * std::cos(inside) * within;
                    const double out = angle - 2 * (in - inside);
                    return std::array<Point, 3>{first, second, std::cos(out) * x + std::sin(out) * y};
                };
                const auto miss = [&](double angle) {
                    const auto p = points(angle);
                    const Point way = to - p[1];
                    return dot(way, y) * dot(p[2], x) - dot(way, x) * dot(p[2], y);
                };
                const Point found = result.vertices[0].position - from;
                const double angle = std::atan2(dot(found, y), dot(found, x));
                const double around = 1e-3 * std::asin(r / away);
                const auto p = points(bisect(angle - around, angle + around, miss));
                return std::vector<Point>{p[0], p[1]};
            });
        // Where the sphere's focus is near the target, it is known less well, to the root of rounding at worst.
        EXPECT_LT(a.largest, precision == Precision::double_ ? 1e-9 : 1e-4);
        EXPECT_GT(a.arrived, a.count * 6 / 10);
    }
}

/// What else there is: rough glass and metal, smooth normals, chains of many vertices.
Scene mixture() {
    testing::SceneMaker maker = room();
    maker.sphere({-0.45f, 0, 0}, 0.3f, maker.material(testing::rough_glass(0.05, 1.5)));
    maker.sphere({0.45f, 0.3f, 0}, 0.3f, maker.material(testing::glass(1.4)));
    maker.sphere({0.4f, -0.45f, -0.2f}, 0.25f, maker.material(testing::rough_metal(0.05)));
    maker.parallelogram({-0.9f, -0.9f, -0.6f}, {1.8f, 0, 0}, {0, 1.8f, 0}, maker.material(testing::rough_metal(0.1)));
    Mesh &mesh = maker.scene.meshes.back(); // bent by its normals
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.normals.push_back([&] {
            const Point n = unit({0.2 * mesh.positions[i].x, 0.2 * mesh.positions[i].y, 1});
            return Vector3{float(n[0]), float(n[1]), float(n[2])};
        }());
    return maker.scene;
}

bool is_finite_result(const WalkResult &r) {
    return std::isfinite(r.spread) && std::isfinite(r.turn) && std::isfinite(r.base_spread) && r.spread > 0 &&
           r.turn > 0;
}

TEST(ManifoldWalkOf, ChainsOfGlossyVerticesArriveAndComeBack) {
    Walker walker(mixture(), 4096);
    Random random(5);
    const std::vector<WalkChain> chains = draw_chains(walker, random, 4096, 0.05, 0.1);
    const std::vector<WalkResult> results = walker.run(chains);
    std::size_t arrived = 0, steps = 0;
    for (const WalkResult &result : results) {
        arrived += result.outcome == walk_arrived;
        steps += result.outcome == walk_arrived ? result.steps : 0;
        if (result.outcome == walk_arrived) {
            EXPECT_TRUE(is_finite_result(result));
        }
    }
    std::printf("  %.1f %% arrived in %.2f steps;%s\n", 100.0 * double(arrived) / double(results.size()),
                double(steps) / double(arrived), text_of(tally(results)).c_str());
    EXPECT_GT(arrived, results.size() / 2);
    const auto &counts = walker.walk.counts();
    std::uint64_t all = 0;
    for (const auto &[name, count] : counts)
        all += name == "steps" ? 0 : count;
    EXPECT_EQ(all, results.size());
    EXPECT_EQ(counts.at("arrived"), arrived);
    EXPECT_EQ(counts.at("steps"), steps);
}

} // namespace
} // namespace gradus
