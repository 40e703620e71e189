// The Jacobian of reconnections against differences of the shift itself.
#include "tests/kernels/lib_vector.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include "kernels/lib/shift_reconnection.h"

#include <cstdio>
#include <random>

using namespace gradus::testing;

namespace {

/// (v + move) / |v + move| - v / |v| without cancellation: far ends hardly turn.
LongVector moved_direction(LongVector v, LongVector move) {
    const long double before = length(v), after = length(v + move);
    const long double growth = dot(2.0L * v + move, move) / (before + after);
    return (1 / after) * (move - (growth / before) * v);
}

struct Connection {
    LongVector base, offset, target, normal; ///< exact in `real`

    double jacobian() const {
        return lib::reconnection_jacobian(as_real(base), as_real(offset), as_real(target), as_real(normal));
    }
    double jacobian_back() const {
        return lib::reconnection_jacobian(as_real(offset), as_real(base), as_real(target), as_real(normal));
    }
    double cosine(LongVector from) const {
        return double(std::fabs(dot(normalized(target - from), normalized(normal))));
    }
    double distance(LongVector from) const { return double(length(target - from)); }

    /// A turn of the direction at base moves the target in its plane; the direction at offset follows.
    NumericalJacobian numerical() const {
        const LongVector w = normalized(target - base);
        const long double base_distance = length(target - base);
        // The ray along w + turn meets the plane at base + base_distance k (w + turn), k = w.n / (w + turn).n.
        const auto shifted = [&](LongVector turn) {
            const long double k_less_one = -dot(turn, normal) / dot(w + turn, normal);
            return moved_direction(target - offset, base_distance * (k_less_one * w + (1 + k_less_one) * turn));
        };
        // A turn moves the target by |base - target| turn / cosine: small against the shorter distance.
        const long double shorter = std::min(1.0, distance(offset) / distance(base));
        return solid_angle_jacobian(shifted, w, 0.02L * cosine(base) * shorter);
    }
};

/// Distances over [1e-3, 1e4]; half of the ends see the target under a cosine from [smallest, 0.3].
class Connections {
  public:
    Connections(unsigned seed, double smallest) : random(seed), smallest(smallest) {}

    Connection draw() {
        Connection c;
        c.target = 10.0L * direction();
        c.normal = direction();
        c.base = c.target + end(c.normal);
        c.offset = c.target + end(c.normal);
        for (LongVector *v : {&c.base, &c.offset, &c.target, &c.normal})
            *v = as_long(as_real(*v));
        return c;
    }

  private:
    double uniform() { return std::uniform_real_distribution<double>()(random); }
    LongVector direction() {
        std::normal_distribution<double> normal;
        return normalized({normal(random), normal(random), normal(random)});
    }
    LongVector end(LongVector normal) {
        const long double cosine = uniform() < 0.5 ? uniform() : smallest * std::pow(0.3 / smallest, uniform());
        const LongVector first = perpendicular(normal), second = cross(normal, first);
        const long double turn = 2 * M_PI * uniform(), sine = std::sqrt(1 - cosine * cosine);
        const long double distance = std::pow(10.0, -3 + 7 * uniform()), side = uniform() < 0.5 ? 1 : -1;
        return distance * (side * cosine * normal + sine * std::cos(turn) * first + sine * std::sin(turn) * second);
    }

    std::mt19937_64 random;
    double smallest;
};

/// What roundings do: a few to lengths, and n.d is known to a few epsilon |d|.
double allowed(const Connection &c) { return epsilon * (16 + 4 / c.cosine(c.base) + 4 / c.cosine(c.offset)); }

} // namespace

TEST(ReconnectionJacobian, IsThatOfTheShift) {
    Connections connections(1, 1e-3);
    double largest = 0, largest_uncertainty = 0, worst = 0;
    for (int i = 0; i < sample_count / 40; ++i) {
        const Connection c = connections.draw();
        if (std::min(c.cosine(c.base), c.cosine(c.offset)) < 1e-3)
            continue; // short distances lose their last bits where positions are rounded
        const NumericalJacobian numerical = c.numerical();
        ASSERT_LT(numerical.relative_error, 1e-8L) << c.cosine(c.base) << " " << c.cosine(c.offset);
        const double error = std::fabs(c.jacobian() / double(numerical.value) - 1);
        ASSERT_LT(error, allowed(c) + 1e-8) << c.cosine(c.base) << " " << c.cosine(c.offset);
        ASSERT_LT(error, bound(2e-3, 1e-6));
        largest = worse(largest, error);
        worst = worse(worst, error / (allowed(c) + 1e-8));
        largest_uncertainty = worse(largest_uncertainty, double(numerical.relative_error));
    }
    std::printf("  largest error %.1e, the differences know it to %.1e\n", largest, largest_uncertainty);
    record_stability(
        {"Reconnection", "short and long edges, grazing ones: squared distances leave float's range",
         "distances from 1e-3 to 1e4, cosines at the target from 1e-3",
         "takes the ratio of distances before it is squared; fails where a cosine is below 1e-6 or distances "
         "differ by 1e15, and so does the shift back",
         "largest error of the Jacobian over what rounding of the arguments allows", worst, 1});
}

TEST(ReconnectionJacobian, IsUndoneByTheShiftBack) {
    Connections connections(2, 1e-4);
    for (int i = 0; i < sample_count; ++i) {
        const Connection c = connections.draw();
        const double there = c.jacobian(), back = c.jacobian_back();
        ASSERT_EQ(there > 0, back > 0);
        if (there > 0) {
            ASSERT_NEAR(there * back, 1, 8 * epsilon); // eight roundings; the cosines are the same
        }
    }
}

TEST(ReconnectionJacobian, HandDerivedValues) {
    const lib::vec3 normal = lib::v3(0, 0, 1), target = lib::v3(1, 2, 3);
    const lib::vec3 above = lib::v3(1, 2, 5), far_above = lib::v3(1, 2, 9), below = lib::v3(1, 2, 1);
    EXPECT_EQ(lib::reconnection_jacobian(above, above, target, normal), 1);
    EXPECT_EQ(lib::reconnection_jacobian(above, below, target, normal), 1);
    EXPECT_NEAR(lib::reconnection_jacobian(above, far_above, target, normal), 1 / 9.0, 4 * epsilon);
    EXPECT_NEAR(lib::reconnection_jacobian(far_above, above, target, lib::v3(0, 0, -1)), 9, 32 * epsilon);
    // At 60 degrees, twice as far: half the cosine, a quarter of the solid angle.
    const lib::vec3 slanted = lib::v3(real(1 + 2 * std::sqrt(3.0)), 2, 5);
    EXPECT_NEAR(lib::reconnection_jacobian(above, slanted, target, normal), 1 / 8.0, 4 * epsilon);
}

TEST(ReconnectionJacobian, IsZeroWhereDegenerateAndAlwaysFinite) {
    const lib::vec3 normal = lib::v3(0, 0, 1), target = lib::v3(0, 0, 0), fine = lib::v3(1, 1, 1);
    const lib::vec3 failing[] = {target, lib::v3(1, 0, 0), lib::v3(1, 1, real(1e-7)), lib::v3(0, 0, real(1e-18))};
    for (const lib::vec3 end : failing) {
        EXPECT_EQ(lib::reconnection_jacobian(fine, end, target, normal), 0);
        EXPECT_EQ(lib::reconnection_jacobian(end, fine, target, normal), 0);
        EXPECT_EQ(lib::reconnection_jacobian(end, end, target, normal), 0);
    }
    EXPECT_EQ(lib::reconnection_jacobian(fine, fine, target, lib::v3(0, 0, 0)), 0);
    for (const double base : {1e-30, 1e-14, 1e-9, 1e-3, 1.0, 1e4, 1e9, 1e14, 1e18, 1e25})
        for (const double offset : {1e-30, 1e-14, 1e-9, 1e-3, 1.0, 1e4, 1e9, 1e14, 1e18, 1e25})
            for (const double cosine : {1e-10, 2e-6, 1e-3, 1.0}) {
                const auto at = [&](double distance) { return lib::v3(real(distance), 0, real(distance * cosine)); };
                const real there = lib::reconnection_jacobian(at(base), at(offset), target, normal);
                const real back = lib::reconnection_jacobian(at(offset), at(base), target, normal);
                ASSERT_TRUE(std::isfinite(there)) << base << " " << offset << " " << cosine;
                ASSERT_EQ(there > 0, back > 0) << base << " " << offset << " " << cosine;
                const bool is_plain = base > 1e-4 && base < 1e5 && offset > 1e-4 && offset < 1e5 && cosine > 1e-6;
                ASSERT_TRUE(there > 0 || !is_plain);
            }
}

// The test above would see each of these.
TEST(ReconnectionJacobian, DifferencesRefuteWrongFormulas) {
    Connections connections(3, 1e-2);
    int count = 0, no_cosine = 0, upside_down = 0, cosine_upside_down = 0, first_power = 0;
    for (int i = 0; i < 1000; ++i, ++count) {
        const Connection c = connections.draw();
        const double truth = double(c.numerical().value);
        const double cosines = c.cosine(c.offset) / c.cosine(c.base);
        const double squares = std::pow(c.distance(c.base) / c.distance(c.offset), 2);
        EXPECT_NEAR(cosines * squares / truth, 1, 1e-8);
        const auto is_wrong = [&](double value) { return std::fabs(value / truth - 1) > 1e-2; };
        no_cosine += is_wrong(squares);
        upside_down += is_wrong(cosines / squares);
        cosine_upside_down += is_wrong(squares / cosines);
        first_power += is_wrong(cosines * std::sqrt(squares));
    }
    for (const int refuted : {no_cosine, upside_down, cosine_upside_down, first_power})
        EXPECT_GT(refuted, 0.95 * count);
}
