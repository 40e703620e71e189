// Manifold walks against chains in closed form, against themselves turned around, and where there is no way.
#include "tests/support/worse.h"
#include "tests/wavefront/walk_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "kernels/lib/chain_spread.h"

namespace gradus {
namespace {

using testing::worse;

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

constexpr double slab_ior = 1.5;

/// The cube [-1, 1]^3, diffuse, seen from within. What chains go by in any of these scenes is outside as well: so all
/// need the same kernels, which are compiled once.
testing::SceneMaker room() {
    testing::SceneMaker maker(4, 1);
    maker.cube(maker.material(testing::diffuse(0.5)), -1, true);
    float x = -1;
    for (const Bsdf &bsdf : {testing::mirror(), testing::glass(slab_ior), testing::rough_glass(0.05, slab_ior),
                             testing::rough_metal(0.05)}) {
        const std::uint32_t material = maker.material(bsdf);
        maker.sphere({x, 0, 1.2f}, 0.1f, material);
        maker.parallelogram({x, 0.5f, 1.2f}, {0.1f, 0, 0}, {0, 0.1f, 0}, material);
        x += 0.5f;
    }
    return maker;
}

Scene plane_mirror() {
    testing::SceneMaker maker = room();
    maker.parallelogram({-0.9f, -0.9f, -0.5f}, {1.8f, 0, 0}, {0, 1.8f, 0}, maker.material(testing::mirror()));
    return maker.scene;
}
constexpr double slab_half = 0.1;
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

/// Chains start at a point, or at infinity, where their rays stay parallel.
enum class From { point, infinity };

/// Kernels know of chains from infinity where there is light from there.
Scene lit_from(From from, Scene scene) {
    if (from == From::infinity) {
        scene.emitters.emplace_back();
        scene.emitters.back().kind = Emitter::Kind::directional;
        scene.emitters.back().value = {1, 1, 1};
        scene.emitters.back().direction = {0, 0, -1};
    }
    return scene;
}
bool has_far_light(const Walker &walker) { return walker.session.has("TRAIT_LIGHT_DIRECTIONAL"); }

/// `count` chains from the region above, each to be moved by up to `most` in the plane of its end's surface. `keeps`
/// says which chains are wanted. They start at infinity where the scene has light from there.
std::vector<WalkChain> draw_chains(Walker &walker, Random &random, std::size_t count, double most, double slope,
                                   const std::function<bool(const WalkChain &)> &keeps = {}) {
    std::vector<WalkChain> chains;
    for (std::size_t tries = 0; chains.size() < count && tries < 300 * count; ++tries) {
        ChainEnd start = {{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.5, 0.9)}, {}, 0};
        const Point towards = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.6, 0.3)};
        if (has_far_light(walker)) {
            start.normal = unit(towards - start.position);
            start.offset = double(chain_start_at_infinity);
        }
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
                  const ClosedForm &closed_form, const std::function<bool(const WalkChain &)> &keeps = {}) {
    SessionOptions options;
    options.precision = precision;
    Walker walker(scene, 512, settings_of(precision), options);
    Random random(3);
    const std::vector<WalkChain> chains = draw_chains(walker, random, 400, most_move, 0, [&](const WalkChain &c) {
        return c.vertices.size() == vertices && (!keeps || keeps(c));
    });
    const std::vector<WalkResult> results = walker.run(chains);
    Accuracy a;
    a.count = chains.size();
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (results[i].outcome != walk_arrived)
            continue;
        ++a.arrived;
        const std::vector<Point> expected = closed_form(chains[i], results[i]);
        for (std::size_t k = 0; k < vertices; ++k)
            a.largest = worse(a.largest, length(results[i].vertices[k].position - expected[k]));
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
const std::pair<From, Precision> starts[] = {{From::point, Precision::single},
                                             {From::point, Precision::double_},
                                             {From::infinity, Precision::single},
                                             {From::infinity, Precision::double_}};

TEST(ManifoldWalkOf, PlaneMirrorIsThatOfTheImage) {
    for (const auto &[from, precision] : starts) {
        const auto closed_form = [](const WalkChain &chain, const WalkResult &) {
            const double plane = -0.5, above = chain.start.position[2] - plane;
            const Point to = chain.target.position, d = chain.start.normal, mirrored = {d[0], d[1], -d[2]};
            if (chain.start.is_far())
                return std::vector<Point>{to - (to[2] - plane) / mirrored[2] * mirrored};
            const Point image = {chain.start.position[0], chain.start.position[1], plane - above};
            const Point way = to - image;
            return std::vector<Point>{image + above / way[2] * way};
        };
        const Accuracy a = accuracy(lit_from(from, plane_mirror()), precision, 1, 0.3, closed_form);
        EXPECT_LT(a.largest, allowed(precision));
        EXPECT_GT(a.arrived, a.count * 8 / 10);
    }
}

// In the plane of incidence both sides of the slab turn alike: the tangents add up to the way aside.
TEST(ManifoldWalkOf, SlabIsThatOfSnellsLaw) {
    for (const Precision precision : precisions) {
        const Accuracy a = accuracy(
            slab(), precision, 2, 0.3,
            [](const WalkChain &chain, const WalkResult &) {
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
            },
            [](const WalkChain &chain) { // through, not out between its rims
                return chain.end.position[2] < -slab_half;
            });
        EXPECT_LT(a.largest, allowed(precision));
        EXPECT_GT(a.arrived, a.count * 8 / 10);
    }
}

// In the plane of center, start and target, where both ways make the same angle with the normal.
TEST(ManifoldWalkOf, SphereMirrorIsWhereAnglesAreEqual) {
    for (const auto &[where, precision] : starts) {
        const auto closed_form = [](const WalkChain &chain, const WalkResult &) {
            const bool is_far = chain.start.is_far();
            const Point from = chain.start.position, to = chain.target.position;
            const Point x = is_far ? -1 * chain.start.normal : unit(from), y = unit(to - dot(to, x) * x);
            const double most = std::atan2(dot(to, y), dot(to, x)), r = radius;
            const auto at = [&](double angle) { return r * (std::cos(angle) * x + std::sin(angle) * y); };
            const auto difference = [&](double angle) {
                const Point p = at(angle), tangent = -std::sin(angle) * x + std::cos(angle) * y;
                return dot((is_far ? x : unit(from - p)) + unit(to - p), tangent);
            };
            return std::vector<Point>{at(bisect(0, most, difference))};
        };
        const Accuracy a = accuracy(lit_from(where, sphere_of(testing::mirror())), precision, 1, 0.3, closed_form);
        EXPECT_LT(a.largest, allowed(precision));
        EXPECT_GT(a.arrived, a.count * 7 / 10);
    }
}

// A ray with impact parameter b turns by 2 (i - t) in the plane of its start and the center, sin i = b / r,
// sin t = b / (ior r). Its own angle to the line from start to center is that of b, or 0 from infinity. There may be
// several ways to the target; the one that is near what the walk found must be it.
TEST(ManifoldWalkOf, SphereLensIsThatOfSnellsLaw) {
    for (const auto &[where, precision] : starts) {
        const double ior = float(1.5);
        const Accuracy a =
            accuracy(lit_from(where, sphere_of(testing::glass(1.5))), precision, 2, 0.3,
                     [&](const WalkChain &chain, const WalkResult &result) {
                         const bool is_far = chain.start.is_far();
                         const Point from = chain.start.position, to = chain.target.position;
                         const Point x = is_far ? chain.start.normal : -1 * unit(from), y = unit(to - dot(to, x) * x);
                         const double away = length(from), r = radius;
                         const auto points = [&](double b) { // signed
                             const double in = std::asin(b / r), inside = std::asin(b / (ior * r));
                             const double angle = is_far ? 0 : std::asin(b / away);
                             const Point direction = std::cos(angle) * x + std::sin(angle) * y;
                             // The foot of the center on the ray, less the way from there.
                             const Point foot = b * (std::cos(angle) * y - std::sin(angle) * x);
                             const Point first = foot - r * std::cos(in) * direction;
                             const double turned = angle - (in - inside); // the ray turns to the center
                             const Point within = std::cos(turned) * x + std::sin(turned) * y;
                             const Point second = first + 2 * r * std::cos(inside) * within;
                             const double out = angle - 2 * (in - inside);
                             return std::array<Point, 3>{first, second, std::cos(out) * x + std::sin(out) * y};
                         };
                         const auto miss = [&](double b) {
                             const auto p = points(b);
                             const Point way = to - p[1];
                             return dot(way, y) * dot(p[2], x) - dot(way, x) * dot(p[2], y);
                         };
                         const Point vertex = result.vertices[0].position, found = vertex - from;
                         const double b = is_far ? dot(vertex, y) : away * dot(found, y) / length(found);
                         const auto p = points(bisect(b - 1e-3 * r, b + 1e-3 * r, miss));
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

/// The chain that a walk has found, asked to go back.
WalkChain turned_around(const WalkChain &chain, const WalkResult &result) {
    return {chain.start, chain.target, chain.end, result.vertices};
}

// The walk back finds the first chain, and both know the same spreads.
TEST(ManifoldWalkOf, TurnedAroundChainsHaveTheSameSpreads) {
    SessionOptions options;
    options.precision = Precision::double_;
    WalkSettings settings = settings_of(Precision::double_);
    settings.comes_back = false;
    Walker walker(mixture(), 1024, settings, options);
    Random random(6);
    const std::vector<WalkChain> chains = draw_chains(walker, random, 1000, 0.05, 0.1);
    std::vector<WalkChain> there, back;
    std::vector<WalkResult> found;
    const std::vector<WalkResult> results = walker.run(chains);
    for (std::size_t i = 0; i < chains.size(); ++i)
        if (results[i].outcome == walk_arrived) {
            there.push_back(chains[i]);
            found.push_back(results[i]);
            back.push_back(turned_around(chains[i], results[i]));
        }
    const std::vector<WalkResult> returned = walker.run(back);
    std::size_t came_back = 0;
    for (std::size_t i = 0; i < back.size(); ++i) {
        if (returned[i].outcome != walk_arrived ||
            length(returned[i].vertices[0].position - there[i].vertices[0].position) > 1e-6)
            continue; // another chain to the same end
        ++came_back;
        // Known to the tolerance, 1e-12, times what the chain magnifies it by.
        EXPECT_NEAR(returned[i].spread / found[i].base_spread, 1, 1e-6);
        EXPECT_NEAR(returned[i].base_spread / found[i].spread, 1, 1e-6);
        EXPECT_NEAR(returned[i].turn / found[i].base_turn, 1, 1e-6);
        EXPECT_NEAR(returned[i].base_turn / found[i].turn, 1, 1e-6);
        for (std::size_t k = 0; k < there[i].vertices.size(); ++k)
            EXPECT_LT(length(returned[i].vertices[k].position - there[i].vertices[k].position), 1e-6);
    }
    std::printf("  %zu of %zu came back\n", came_back, back.size());
    EXPECT_GT(came_back, back.size() * 97 / 100);
}

// The Jacobian of a shift that moves the end by a constant, by walks from three chains beside each other.
// From infinity by area across the rays, else by solid angle.
TEST(ManifoldWalkOf, JacobiansAreThoseOfDifferences) {
    std::vector<Scene> scenes;
    for (const From from : {From::point, From::infinity})
        for (const Scene &scene : {slab(), sphere_of(testing::mirror()), sphere_of(testing::glass(1.5))})
            scenes.push_back(lit_from(from, scene));
    for (const Scene &scene : scenes) {
        SessionOptions options;
        options.precision = Precision::double_;
        Walker walker(scene, 1024, settings_of(Precision::double_), options);
        Random random(7);
        const std::vector<WalkChain> chains = draw_chains(walker, random, 150, 0.1, 0);
        // Places across the rays are as near as 1e-3 to the silhouette of a sphere, where derivatives go by its root.
        const double h = has_far_light(walker) ? 2e-6 : 1e-5;
        std::vector<WalkChain> asked;
        for (const WalkChain &chain : chains) {
            const bool is_far = chain.start.is_far();
            const Point direction =
                is_far ? chain.start.normal : unit(chain.vertices[0].position - chain.start.position);
            const Point s = unit(std::fabs(direction[0]) < 0.5 ? Point{0, direction[2], -direction[1]}
                                                               : Point{direction[2], 0, -direction[0]});
            const Point t = {direction[1] * s[2] - direction[2] * s[1], direction[2] * s[0] - direction[0] * s[2],
                             direction[0] * s[1] - direction[1] * s[0]};
            const Point move = chain.target.position - chain.end.position;
            for (const auto &[along_s, along_t] : {std::array{h, 0.0}, {-h, 0.0}, {0.0, h}, {0.0, -h}, {0.0, 0.0}}) {
                std::mt19937_64 events(1);
                // The same events: by trying, until the chain has the same primitives.
                const Point step = along_s * s + along_t * t;
                ChainEnd start = chain.start;
                if (is_far)
                    start.position = start.position + step;
                std::optional<WalkChain> beside;
                for (int tries = 0; tries < 200; ++tries) {
                    beside = walker.sampler.sample(start, is_far ? direction : direction + step, 8, 0, events);
                    if (beside && beside->vertices.size() == chain.vertices.size() &&
                        length(beside->end.position - chain.end.position) < 0.05)
                        break;
                    beside.reset();
                }
                asked.push_back(beside ? *beside : WalkChain{});
                if (beside) {
                    asked.back().target = chain.target;
                    asked.back().target.position = beside->end.position + move;
                }
            }
        }
        const std::vector<WalkResult> results = walker.run(asked);
        std::size_t compared = 0;
        double largest = 0;
        for (std::size_t i = 0; i < chains.size(); ++i) {
            const WalkResult *five = &results[5 * i];
            if (std::any_of(five, five + 5, [](const WalkResult &r) { return r.outcome != walk_arrived; }))
                continue;
            const Point d = chains[i].start.is_far() ? chains[i].start.normal
                                                     : unit(five[4].vertices[0].position - chains[i].start.position);
            const auto beside = [&](std::size_t j) { // a direction, or a place across the rays
                const Point way = five[j].vertices[0].position - chains[i].start.position;
                return chains[i].start.is_far() ? way : unit(way);
            };
            const auto by = [&](std::size_t more) { return 0.5 / h * (beside(more) - beside(more + 1)); };
            const Point a = by(0), b = by(2);
            const double measured = std::fabs(d[0] * (a[1] * b[2] - a[2] * b[1]) + d[1] * (a[2] * b[0] - a[0] * b[2]) +
                                              d[2] * (a[0] * b[1] - a[1] * b[0]));
            const double computed = double(
                chain_jacobian(float(five[4].base_spread), float(five[4].base_turn), float(five[4].spread), 1.0f));
            // Near a focus the second derivative is some 1e5 times the first: with the step, 1e-10 of that; walks end
            // within 1e-12 of their targets, 1e-7 of the step, which a lens magnifies.
            const double error = std::fabs(measured / computed - 1);
            if (computed > 0.1 && computed < 10) {
                ++compared;
                largest = worse(largest, error);
                EXPECT_LT(error, 2e-4) << "chain " << i;
            }
        }
        std::printf("  %zu compared, largest error %.1e\n", compared, largest);
        EXPECT_GT(compared, chains.size() / 2);
    }
}

/// A chain over the mirror below, from above to above.
WalkChain over_the_mirror(Walker &walker, const Point &start, const Point &vertex) {
    std::mt19937_64 random(1);
    const std::optional<WalkChain> chain = walker.sampler.sample({start, {}, 0}, vertex - start, 8, 0, random);
    EXPECT_TRUE(chain);
    return *chain;
}

TEST(ManifoldWalkOf, ChainsWithoutAWayFailAndAreCounted) {
    const auto outcome = [](Walker &walker, const WalkChain &chain) { return walker.run({chain})[0].outcome; };
    {
        // The way would be over the mirror's rim, where the room's diffuse wall is.
        Walker walker(plane_mirror(), 64);
        WalkChain chain = over_the_mirror(walker, {0, 0, 0.5}, {0.2, 0, -0.5});
        EXPECT_EQ(outcome(walker, chain), walk_arrived) << "a move of nothing";
        chain.target.position = {4, 0, -0.4};
        EXPECT_EQ(outcome(walker, chain), walk_kinds);
        // A target below the mirror: the plane of the end has no point there that a mirrored ray meets.
        chain = over_the_mirror(walker, {0, 0, 0.5}, {0.6, 0, -0.5});
        chain.target.position = chain.end.position - Point{0, 0, 5};
        EXPECT_NE(outcome(walker, chain), walk_arrived);
        // Nothing is asked; more vertices than there is room for; an end where the chain does not lead.
        chain = over_the_mirror(walker, {0, 0, 0.5}, {0.2, 0, -0.5});
        WalkChain none = chain;
        none.vertices.clear();
        EXPECT_EQ(outcome(walker, none), walk_none);
        WalkChain astray = chain;
        astray.end.position = astray.end.position + Point{0, 0.5, 0.3};
        EXPECT_EQ(outcome(walker, astray), walk_base);
        WalkChain many = chain;
        many.vertices.resize(9, chain.vertices[0]);
        EXPECT_EQ(outcome(walker, many), walk_base);
        const auto &counts = walker.walk.counts();
        EXPECT_GE(counts.at("kinds"), 1u);
        EXPECT_EQ(counts.at("base"), 2u);
        EXPECT_FALSE(counts.contains("none"));
    }
    {
        // Total reflection: from within glass, ever flatter.
        testing::SceneMaker maker = room();
        maker.parallelogram({-0.99f, -0.99f, 0}, {1.98f, 0, 0}, {0, 1.98f, 0}, maker.material(testing::glass(1.5)));
        Walker walker(maker.scene, 64);
        std::mt19937_64 random(2);
        const ChainEnd start = {{0, 0, -0.8}, {}, 0};
        std::optional<WalkChain> chain;
        while (!chain || chain->end.position[2] < 0)
            chain = walker.sampler.sample(start, {0.4, 0, 1}, 8, 0, random);
        EXPECT_EQ(outcome(walker, *chain), walk_arrived);
        chain->target.position = chain->end.position + Point{30, 0, 0};
        const std::uint32_t found = outcome(walker, *chain);
        EXPECT_TRUE(found == walk_event || found == walk_diverged || found == walk_unfinished || found == walk_kinds ||
                    found == walk_nothing)
            << found;
    }
    {
        // The silhouette: a lens that does not turn rays so far.
        Walker walker(sphere_of(testing::glass(1.5)), 64);
        std::mt19937_64 random(3);
        std::optional<WalkChain> chain;
        while (!chain || chain->vertices.size() != 2)
            chain = walker.sampler.sample({{0, 0, 0.9}, {}, 0}, {0.05, 0, -1}, 8, 0, random);
        EXPECT_EQ(outcome(walker, *chain), walk_arrived);
        chain->target.position = {0, 20, chain->end.position[2]};
        EXPECT_NE(outcome(walker, *chain), walk_arrived);
    }
    {
        // Something stands before the target, which no ray of the walk has met.
        testing::SceneMaker maker = room();
        const std::uint32_t chalk = maker.material(testing::diffuse(0.5));
        maker.parallelogram({-0.9f, -0.9f, -0.5f}, {1.8f, 0, 0}, {0, 1.8f, 0}, maker.material(testing::mirror()));
        maker.parallelogram({0.4f, -0.9f, 0.2f}, {0.4f, 0, 0}, {0, 1.8f, 0}, chalk);
        Walker walker(maker.scene, 64);
        WalkChain chain = over_the_mirror(walker, {0, 0, 0.5}, {0.1, 0, -0.5});
        chain.target.position = {0.7, 0, 1};
        EXPECT_EQ(outcome(walker, chain), walk_hidden);
    }
}

// Facets are planes, each with a chain of its own: from one to the next the end jumps, and between the two there is
// none. What arrives is right all the same, and the rest is counted.
TEST(ManifoldWalkOf, CoarseFacetsFailOrArrive) {
    testing::SceneMaker maker = room();
    const std::uint32_t metal = maker.material(testing::mirror());
    for (int i = -4; i < 4; ++i) { // a ridged mirror
        const float x = 0.2f * float(i), up = i % 2 ? 0.02f : -0.02f;
        maker.parallelogram({x, -0.9f, -0.5f + up}, {0.2f, 0, -2 * up}, {0, 1.8f, 0}, metal);
    }
    Walker walker(maker.scene, 2048);
    Random random(8);
    const std::vector<WalkChain> chains = draw_chains(walker, random, 2000, 0.3, 0);
    const std::vector<WalkResult> results = walker.run(chains);
    std::printf(" %s\n", text_of(tally(results)).c_str());
    std::size_t arrived = 0;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (results[i].outcome != walk_arrived)
            continue;
        ++arrived;
        EXPECT_TRUE(is_finite_result(results[i]));
        const auto &v = results[i].vertices;
        const Point before = v.size() > 1 ? v[v.size() - 2].position : chains[i].start.position;
        const Point n = walker.sampler.truth(before, v.back()).normal;
        // Both ways make the same angle: the half vector is n, to the tolerance and rounding of positions.
        const Point half = unit(unit(before - v.back().position) + unit(chains[i].target.position - v.back().position));
        EXPECT_GT(std::fabs(dot(half, n)), 1 - 1e-8);
    }
    EXPECT_GT(arrived, 200u);
    EXPECT_LT(arrived, 1900u);
    // Steps over to another facet lead away, and are not taken.
    EXPECT_GT(tally(results)["diverged"], 50u);
}

bool same_bits(const WalkResult &a, const WalkResult &b) {
    bool same = a.outcome == b.outcome && a.steps == b.steps && a.vertices.size() == b.vertices.size();
    for (std::size_t k = 0; same && k < a.vertices.size(); ++k)
        same = a.vertices[k].position == b.vertices[k].position && a.vertices[k].primitive == b.vertices[k].primitive;
    return same && (a.outcome != walk_arrived || (a.spread == b.spread && a.turn == b.turn &&
                                                  a.base_spread == b.base_spread && a.base_turn == b.base_turn));
}

TEST(ManifoldWalkOf, AnswersAreTheSameBitsInAnyCompany) {
    Walker walker(mixture(), 2048);
    Random random(9);
    const std::vector<WalkChain> chains = draw_chains(walker, random, 2000, 0.1, 0.1);
    const std::vector<WalkResult> results = walker.run(chains), again = walker.run(chains, 77);
    SessionOptions options;
    options.threads = 1;
    options.work_group_size = 16;
    Walker other(mixture(), 4096, {}, options);
    const std::vector<WalkResult> elsewhere = other.run(chains);
    for (std::size_t i = 0; i < chains.size(); ++i) {
        EXPECT_TRUE(same_bits(results[i], again[i])) << "chain " << i << " in a smaller batch";
        EXPECT_TRUE(same_bits(results[i], elsewhere[i])) << "chain " << i << " by one thread";
    }
}

// Far from the origin positions have few digits, and the tolerance knows.
TEST(ManifoldWalkOf, ChainsFarFromTheOriginArrive) {
    const Vector3 far{100, -200, 50};
    Scene scene = sphere_of(testing::glass(1.5));
    for (Mesh &mesh : scene.meshes)
        for (Vector3 &p : mesh.positions)
            p = {p.x + far.x, p.y + far.y, p.z + far.z};
    for (Sphere &sphere : scene.spheres)
        sphere.center = {sphere.center.x + far.x, sphere.center.y + far.y, sphere.center.z + far.z};
    Walker near_walker(sphere_of(testing::glass(1.5)), 512), walker(scene, 512);
    Random random(10);
    std::vector<WalkChain> chains = draw_chains(near_walker, random, 500, 0.1, 0), moved;
    const Point by = {far.x, far.y, far.z};
    for (WalkChain chain : chains) {
        for (Point *p : {&chain.start.position, &chain.end.position, &chain.target.position})
            *p = *p + by;
        for (auto &vertex : chain.vertices)
            vertex.position = vertex.position + by;
        chain.end.offset = chain.target.offset = 350 * 0x1p-22; // kernels/lib/ray_start.h
        moved.push_back(chain);
    }
    const auto here = tally(near_walker.run(chains)), there = tally(walker.run(moved));
    std::printf("  at the origin%s; far from it%s\n", text_of(here).c_str(), text_of(there).c_str());
    // Positions have a step of 1.5e-5, which the lens magnifies up to some tens of times, against ways back that must
    // be right to 1e-3: a few fail.
    EXPECT_GT(double(there.at("arrived")), 0.95 * double(here.at("arrived")));
}

} // namespace
} // namespace gradus
