// Derivatives of chains against differences, generalised geometry terms against closed forms, and the Jacobians of
// shifts against determinants of matrices of the whole chain.
#include "tests/kernels/chain_case.h"
#include "tests/support/worse.h"

#include <gtest/gtest.h>

#include <cstdio>

using namespace gradus::testing;

namespace {

using Kinds = ChainCases::Kinds;

double length(lib::vec3 v) { return std::sqrt(double(lib::v3_dot(v, v))); }
double distance(lib::vec3 a, lib::vec3 b) { return length(lib::v3_sub(a, b)); }

} // namespace

#ifdef GRADUS_DOUBLE // differences need it

namespace {

using Matrix = std::vector<std::vector<double>>;

double determinant(Matrix m) {
    double product = 1;
    for (std::size_t i = 0; i < m.size(); ++i) {
        std::size_t best = i;
        for (std::size_t r = i; r < m.size(); ++r)
            if (std::fabs(m[r][i]) > std::fabs(m[best][i]))
                best = r;
        std::swap(m[i], m[best]);
        if (m[i][i] == 0)
            return 0;
        product *= best == i ? m[i][i] : -m[i][i];
        for (std::size_t r = i + 1; r < m.size(); ++r) {
            const double factor = m[r][i] / m[i][i];
            for (std::size_t c = i; c < m.size(); ++c)
                m[r][c] -= factor * m[i][c];
        }
    }
    return product;
}

Matrix inverse(const Matrix &m) {
    const std::size_t size = m.size();
    Matrix a = m, result(size, std::vector<double>(size));
    for (std::size_t i = 0; i < size; ++i)
        result[i][i] = 1;
    for (std::size_t i = 0; i < size; ++i) {
        std::size_t best = i;
        for (std::size_t r = i; r < size; ++r)
            if (std::fabs(a[r][i]) > std::fabs(a[best][i]))
                best = r;
        std::swap(a[i], a[best]);
        std::swap(result[i], result[best]);
        const double scale = 1 / a[i][i];
        for (std::size_t c = 0; c < size; ++c)
            a[i][c] *= scale, result[i][c] *= scale;
        for (std::size_t r = 0; r < size; ++r)
            if (r != i) {
                const double factor = a[r][i];
                for (std::size_t c = 0; c < size; ++c)
                    a[r][c] -= factor * a[i][c], result[r][c] -= factor * result[i][c];
            }
    }
    return result;
}

/// The projected half vector that a vertex has by its directions, in its frame.
std::array<double, 2> projected(const ChainVertex &v, lib::vec3 n, lib::vec3 wi, lib::vec3 wo) {
    const double eta = v.reflects ? 1 : double(lib::shift_eta(real(v.ior), v.behind ? R(-1) : R(1)));
    lib::vec3 h = lib::v3_normalize(lib::v3_mad(wi, real(eta), wo));
    if (lib::v3_dot(h, n) < 0)
        h = lib::v3_neg(h);
    const lib::frame f = lib::frame_from_normal(n);
    return {double(lib::v3_dot(f.s, h)), double(lib::v3_dot(f.t, h))};
}

double cosine_of_half_vector(const ChainVertex &v) { return std::sqrt(1 - v.half_x * v.half_x - v.half_y * v.half_y); }

} // namespace

// Central differences with a step of 1e-5 of functions whose third derivatives are some hundreds: 1e-8 of them, and
// rounding gives 1e-15 / 1e-5. Chains of glass amplify both.
TEST(Chain, DerivativesAreThoseOfDifferences) {
    ChainCases cases(1);
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::size_t count = 1 + std::size_t(i) % 4;
        const ChainCase c = cases.draw(count, Kinds(i % 3));
        const FollowedChain chain = c.follow();
        ASSERT_TRUE(chain.is_valid);
        const lib::ray_differential begin = lib::ray_differential_begin(c.first_direction);
        const double h = 1e-5;
        const auto difference = [&](lib::vec3 turn) {
            const auto at = [&](double step) {
                return c.follow(lib::v3_normalize(lib::v3_mad(c.first_direction, real(step), turn)), count).end;
            };
            const lib::vec3 once = lib::v3_scale(lib::v3_sub(at(h), at(-h)), real(0.5 / h));
            const lib::vec3 twice = lib::v3_scale(lib::v3_sub(at(2 * h), at(-2 * h)), real(0.25 / h));
            return lib::v3_mad(once, real(1.0 / 3), lib::v3_sub(once, twice)); // Richardson
        };
        const double scale = length(chain.end_s) + length(chain.end_t);
        const double error = (distance(difference(begin.direction_s), chain.end_s) +
                              distance(difference(begin.direction_t), chain.end_t)) /
                             scale;
        EXPECT_LT(error, 1e-6) << "chain " << i << " of " << count;
        largest = worse(largest, error);
    }
    std::printf("  largest relative error of a derivative %.1e\n", largest);
}

// d (o of glossy vertices, y_s) / d (omega_b, omega of glossy vertices), whatever mixture of vertices: by following the
// chain with other directions, and by the product of chain_spread.h.
TEST(Chain, MixedDeterminantsAreThoseOfDifferences) {
    ChainCases cases(2);
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::size_t count = 1 + std::size_t(i) % 4;
        const ChainCase c = cases.draw(count, Kinds::mixed);
        const FollowedChain chain = c.follow();
        std::vector<lib::vec3> base = {c.first_direction};
        for (std::size_t k = 0; k < count; ++k)
            if (c.vertices[k].is_glossy)
                base.push_back(chain.directions_out[k]);
        const lib::frame end_frame = lib::frame_from_normal(c.plane);
        const auto result = [&](std::size_t which, double along_s, double along_t) {
            std::vector<lib::vec3> directions = base;
            const lib::frame f = lib::frame_from_normal(directions[which]);
            directions[which] =
                lib::v3_normalize(lib::v3_mad(lib::v3_mad(directions[which], real(along_s), f.s), real(along_t), f.t));
            const std::vector<lib::vec3> out(directions.begin() + 1, directions.end());
            const FollowedChain moved = c.follow(directions[0], count, &out);
            std::vector<double> values;
            lib::vec3 wi = lib::v3_neg(directions[0]);
            for (std::size_t k = 0; k < count; ++k) {
                if (c.vertices[k].is_glossy) {
                    const auto o = projected(c.vertices[k], moved.normals[k], wi, moved.directions_out[k]);
                    values.insert(values.end(), o.begin(), o.end());
                }
                wi = lib::v3_neg(moved.directions_out[k]);
            }
            values.push_back(double(lib::v3_dot(moved.end, end_frame.s)));
            values.push_back(double(lib::v3_dot(moved.end, end_frame.t)));
            return values;
        };
        const std::size_t size = 2 * base.size();
        Matrix m(size, std::vector<double>(size));
        const double h = 1e-5;
        for (std::size_t column = 0; column < size; ++column) {
            const double s = column % 2 ? 0 : h, t = column % 2 ? h : 0;
            const auto more = result(column / 2, s, t), less = result(column / 2, -s, -t);
            const auto more2 = result(column / 2, 2 * s, 2 * t), less2 = result(column / 2, -2 * s, -2 * t);
            for (std::size_t row = 0; row < size; ++row) {
                const double once = (more[row] - less[row]) / (2 * h), twice = (more2[row] - less2[row]) / (4 * h);
                m[row][column] = once + (once - twice) / 3;
            }
        }
        double expected = double(lib::chain_spread(chain.end_s, chain.end_t, chain.directions_out.back(), c.plane));
        for (const ChainVertex &v : c.vertices)
            if (v.is_glossy)
                expected *= cosine_of_half_vector(v);
        expected /= chain.turn;
        const double error = std::fabs(std::fabs(determinant(m)) / expected - 1);
        EXPECT_LT(error, 1e-6) << "chain " << i << " of " << count;
        largest = worse(largest, error);
    }
    std::printf("  largest relative error of a determinant %.1e\n", largest);
}

namespace {

/// d (o_1 ... o_N, y_s) / d (y_1 ... y_N, y_s) in tangent planes, by differences of each vertex's constraint (Jakob and
/// Marschner 2012): the matrix C of Hua et al. 2017, eq. 10.
Matrix constraint_matrix(const ChainCase &c, const FollowedChain &chain) {
    const std::size_t count = c.vertices.size(), size = 2 * count + 2;
    std::vector<lib::vec3> points = {c.start}, geometric = {lib::v3(0, 0, 1)};
    points.insert(points.end(), chain.positions.begin(), chain.positions.end());
    geometric.insert(geometric.end(), chain.geometric.begin(), chain.geometric.end());
    points.push_back(chain.end);
    geometric.push_back(c.plane);
    const auto constraint = [&](std::size_t k, std::size_t moved, lib::vec3 by) { // vertex k = 1 ... N
        std::vector<lib::vec3> at = points;
        at[moved] = lib::v3_add(at[moved], by);
        lib::vec3 n = chain.normals[k - 1];
        if (moved == k)
            n = lib::v3_normalize(lib::v3_add(n, lib::normal_change_along(chain.changes[k - 1], by)));
        return projected(c.vertices[k - 1], n, lib::v3_normalize(lib::v3_sub(at[k - 1], at[k])),
                         lib::v3_normalize(lib::v3_sub(at[k + 1], at[k])));
    };
    Matrix m(size, std::vector<double>(size));
    m[size - 2][size - 2] = m[size - 1][size - 1] = 1;
    const double h = 1e-5;
    for (std::size_t k = 1; k <= count; ++k)
        for (std::size_t moved = std::max<std::size_t>(k - 1, 1); moved <= k + 1; ++moved) {
            const lib::frame f = lib::frame_from_normal(geometric[moved]);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                const auto value = [&](double step) {
                    return constraint(k, moved, lib::v3_scale(axis ? f.t : f.s, real(step)));
                };
                const auto a = value(h), b = value(-h), a2 = value(2 * h), b2 = value(-2 * h);
                for (std::size_t row = 0; row < 2; ++row) {
                    const double once = (a[row] - b[row]) / (2 * h), twice = (a2[row] - b2[row]) / (4 * h);
                    m[2 * (k - 1) + row][2 * (moved - 1) + axis] = once + (once - twice) / 3;
                }
            }
        }
    return m;
}

} // namespace

// The same by areas, from the matrix of all constraints: the minor of its inverse that leaves out the half vectors of
// specular vertices and the vertices after them (Hua et al. 2017, section 4.2).
TEST(Chain, MixedDeterminantsAreMinorsOfTheConstraintMatrix) {
    ChainCases cases(3);
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::size_t count = 1 + std::size_t(i) % 4;
        const ChainCase c = cases.draw(count, Kinds::mixed);
        const FollowedChain chain = c.follow();
        const Matrix inverted = inverse(constraint_matrix(c, chain));
        std::vector<std::size_t> rows = {0, 1}, columns;
        for (std::size_t k = 0; k < count; ++k)
            if (c.vertices[k].is_glossy) {
                rows.insert(rows.end(), {2 * k + 2, 2 * k + 3});
                columns.insert(columns.end(), {2 * k, 2 * k + 1});
            }
        columns.insert(columns.end(), {2 * count, 2 * count + 1});
        Matrix minor(rows.size(), std::vector<double>(rows.size()));
        for (std::size_t r = 0; r < rows.size(); ++r)
            for (std::size_t k = 0; k < columns.size(); ++k)
                minor[r][k] = inverted[rows[r]][columns[k]];
        // |d u / d v| by areas, from that by solid angles.
        double expected = chain.turn;
        expected /= double(lib::chain_spread(chain.end_s, chain.end_t, chain.directions_out.back(), c.plane));
        lib::vec3 from = c.start;
        for (std::size_t k = 0; k <= count; ++k) {
            const lib::vec3 to = k < count ? chain.positions[k] : chain.end;
            const lib::vec3 normal = k < count ? chain.geometric[k] : c.plane;
            if (k > 0 && c.vertices[k - 1].is_glossy)
                expected /= cosine_of_half_vector(c.vertices[k - 1]);
            if (k == 0 || c.vertices[k - 1].is_glossy) {
                const double way = distance(from, to);
                expected *= way * way * way / std::fabs(double(lib::v3_dot(normal, lib::v3_sub(to, from))));
            }
            from = to;
        }
        const double error = std::fabs(std::fabs(determinant(minor)) / expected - 1);
        EXPECT_LT(error, 1e-5) << "chain " << i << " of " << count;
        largest = worse(largest, error);
    }
    std::printf("  largest relative error of a minor %.1e\n", largest);
}

// The step of the first vertex is that of the block tridiagonal system, with the end moved and all half vectors held.
TEST(Chain, StepsSolveTheBlockTridiagonalSystem) {
    ChainCases cases(4);
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::size_t count = 1 + std::size_t(i) % 4;
        const ChainCase c = cases.draw(count, Kinds(i % 3));
        const FollowedChain chain = c.follow();
        const Matrix inverted = inverse(constraint_matrix(c, chain));
        const lib::frame end = lib::frame_from_normal(c.plane), first = lib::frame_from_normal(chain.geometric[0]);
        const double angle = cases.uniform(0, 6.28), by_s = std::cos(angle), by_t = std::sin(angle);
        const lib::vec3 wanted = lib::v3_mad(lib::v3_scale(end.s, real(by_s)), real(by_t), end.t);
        const lib::chain_step step =
            lib::chain_step_for(wanted, chain.end_s, chain.end_t, c.plane, chain.step_s[0], chain.step_t[0]);
        if (!step.is_valid)
            continue; // near a caustic
        const std::size_t s = 2 * count, t = s + 1;
        const double along_s = inverted[0][s] * by_s + inverted[0][t] * by_t;
        const double along_t = inverted[1][s] * by_s + inverted[1][t] * by_t;
        const lib::vec3 expected = lib::v3_mad(lib::v3_scale(first.s, real(along_s)), real(along_t), first.t);
        const double error = distance(step.step, expected) / length(expected);
        EXPECT_LT(error, 1e-5) << "chain " << i << " of " << count;
        largest = worse(largest, error);
    }
    std::printf("  largest relative error of a step %.1e\n", largest);
}

#endif

// y_b and y_s over a plane mirror: the geometry term of the mirrored start.
TEST(Chain, GeometryTermOfAPlaneMirrorIsThatOfTheImage) {
    ChainCases cases(5);
    for (int i = 0; i < 200; ++i) {
        const lib::vec3 start = lib::v3(0, 0, real(cases.uniform(0.5, 2)));
        const lib::vec3 end =
            lib::v3(real(cases.uniform(-2, 2)), real(cases.uniform(-2, 2)), real(cases.uniform(0.5, 2)));
        const lib::vec3 image = lib::v3(0, 0, -start.z), n = lib::v3(0, 0, 1);
        const lib::vec3 end_normal = cases.near(lib::v3(0, 0, -1), 0.5),
                        start_normal = cases.near(lib::v3(0, 0, -1), 0.5);
        const lib::vec3 way = lib::v3_sub(end, image);
        const real share = start.z / (start.z + end.z);
        const lib::vec3 vertex = lib::v3_mad(image, share, way);
        const lib::vec3 direction = lib::v3_normalize(lib::v3_sub(vertex, start));
        lib::ray_differential beam = lib::ray_differential_begin(direction);
        beam = lib::ray_differential_at(beam, direction, real(distance(start, vertex)), n, 1 / direction.z);
        const lib::vertex_event event = lib::vertex_event_of(lib::v3_neg(direction), n, 0, 0, 1, 0, R(1.5));
        ASSERT_TRUE(event.is_valid);
        const lib::vec3 zero = lib::v3(0, 0, 0);
        const lib::vec3 out_s = lib::vertex_event_change(event, n, 0, 0, beam.direction_s, zero);
        const lib::vec3 out_t = lib::vertex_event_change(event, n, 0, 0, beam.direction_t, zero);
        const real cosine = lib::v3_dot(end_normal, event.wo), reach = real(distance(vertex, end));
        const lib::vec3 end_s = lib::ray_step_at(beam.position_s, out_s, event.wo, reach, end_normal, 1 / cosine);
        const lib::vec3 end_t = lib::ray_step_at(beam.position_t, out_t, event.wo, reach, end_normal, 1 / cosine);
        const double spread = double(lib::chain_spread(end_s, end_t, event.wo, end_normal));
        const double start_cosine = std::fabs(double(lib::v3_dot(start_normal, direction)));
        const double expected = start_cosine * std::fabs(double(cosine)) / double(lib::v3_dot(way, way));
        EXPECT_NEAR(double(lib::generalized_geometry_term(real(spread), real(start_cosine))) / expected, 1,
                    bound(1e-4, 1e-12));
    }
}

// A half vector that a pair of directions has leads from the one to the other.
TEST(Chain, EventsGoBackToTheirHalfVector) {
    ChainCases cases(6);
    double largest = 0;
    for (int i = 0; i < 3000; ++i) {
        const ChainCase c = cases.draw(1, Kinds::glossy);
        const ChainVertex &v = c.vertices[0];
        const FollowedChain chain = c.follow();
        const lib::half_vector m = lib::half_vector_of(lib::v3_neg(c.first_direction), chain.directions_out[0],
                                                       chain.normals[0], v.reflects, real(v.ior));
        ASSERT_TRUE(m.is_valid);
        // h = wi + eta wo is known to rounding over its length, which is over 0.04 by ChainCases.
        const double error = std::hypot(double(m.x) - v.half_x, double(m.y) - v.half_y);
        largest = worse(largest, error);
    }
    std::printf("  largest error of a half vector %.1e\n", largest);
    EXPECT_LT(largest, bound(3e-5, 1e-13));
}

// Dirac interfaces between equal indices let rays pass, and their derivatives.
TEST(Chain, EqualIndicesPassStraight) {
    ChainCases cases(7);
    for (int i = 0; i < 100; ++i) {
        const lib::vec3 direction = cases.direction(), n = cases.near(direction, 0.8);
        const lib::vertex_event event = lib::vertex_event_of(lib::v3_neg(direction), n, 0, 0, 0, 1, 1);
        ASSERT_TRUE(event.is_valid);
        EXPECT_LT(distance(event.wo, direction), bound(1e-6, 1e-14));
        const lib::vec3 change = lib::frame_from_normal(direction).s, dn = lib::frame_from_normal(n).s;
        EXPECT_LT(distance(lib::vertex_event_change(event, n, 0, 0, change, dn), change), bound(1e-5, 1e-13));
    }
}

TEST(Chain, EventsThatCannotBeFail) {
    const lib::vec3 n = lib::v3(0, 0, 1);
    const auto works = [&](lib::vec3 wi, bool reflects, bool behind, double ior, double x = 0) {
        return lib::vertex_event_of(lib::v3_normalize(wi), n, real(x), 0, reflects, behind, real(ior)).is_valid != 0;
    };
    EXPECT_TRUE(works(lib::v3(1, 0, 1), true, false, 1.5));
    EXPECT_FALSE(works(lib::v3(1, 0, -1), true, false, 1.5)) << "another side";
    EXPECT_TRUE(works(lib::v3(1, 0, -1), true, true, 1.5));
    EXPECT_TRUE(works(lib::v3(1, 0, -2), false, true, 1.5));
    EXPECT_FALSE(works(lib::v3(2, 0, -1), false, true, 1.5)) << "total reflection";
    EXPECT_FALSE(works(lib::v3(1, 0, 1e-4f), true, false, 1.5)) << "grazing";
    EXPECT_FALSE(works(lib::v3(-5, 0, 1), true, false, 1.5, 0.5)) << "the half vector turns it below the surface";
}

// The plane contains both ends and is the same from either of them, whatever the sides of the normals.
TEST(Chain, PlanesOfWalksAreSymmetric) {
    ChainCases cases(8);
    for (int i = 0; i < 1000; ++i) {
        const lib::vec3 end = lib::v3_scale(cases.direction(), 3), normal = cases.direction();
        const lib::vec3 target = lib::v3_mad(end, real(cases.uniform(0, 1)), cases.direction());
        const lib::vec3 target_normal = cases.near(lib::v3_scale(normal, real(i % 2 ? 1 : -1)), 0.9);
        const lib::vec3 there = lib::walk_plane(end, normal, target, target_normal, R(1e-7));
        const lib::vec3 back = lib::walk_plane(target, target_normal, end, normal, R(1e-7));
        if (length(there) == 0) {
            EXPECT_EQ(length(back), 0);
            continue;
        }
        EXPECT_NEAR(length(there), 1, 1e-5);
        EXPECT_NEAR(std::fabs(double(lib::v3_dot(there, back))), 1, bound(1e-5, 1e-12));
        EXPECT_NEAR(double(lib::v3_dot(there, lib::v3_sub(target, end))), 0, bound(1e-5, 1e-9));
    }
}
