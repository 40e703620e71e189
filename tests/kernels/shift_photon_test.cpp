// The shift of photons between two gather points: there and back, its Jacobian against differences, and which photons
// arrive.
#include "tests/kernels/lib_vector.h"
#include "tests/support/worse.h"

#include "kernels/lib/shift_photon.h"

#include <cstdio>
#include <random>

using namespace gradus::testing;

namespace {

struct Disc {
    LongVector position, normal;
    long double radius;
    lib::photon_disc as_lib() const { return lib::photon_disc_of(as_real(position), as_real(normal), real(radius)); }
};

/// Two gather points a pixel or so apart, a last vertex, and a photon near the first.
struct PhotonCase {
    Disc base, offset;
    LongVector from, photon;

    lib::shifted_photon shift() const {
        return lib::photon_shift_from(as_real(from), as_real(photon), base.as_lib(), offset.as_lib());
    }
    /// The shift of another direction from the same vertex.
    LongVector shifted(LongVector direction) const {
        const long double way = dot(base.position - from, base.normal) / dot(direction, base.normal);
        const lib::shifted_photon moved =
            lib::photon_shift_from(as_real(from), as_real(from + way * direction), base.as_lib(), offset.as_lib());
        return as_long(moved.target) - from;
    }
};

class PhotonCases {
  public:
    /// bend: how far apart the normals are, about.
    PhotonCases(unsigned seed, double bend) : random(seed), bend(bend) {}

    PhotonCase draw() {
        for (;;) {
            PhotonCase c{};
            c.base.normal = direction();
            c.offset.normal = normalized(c.base.normal + (long double)(bend * uniform()) * direction());
            c.base.radius = std::pow(10.0, -3 + 2 * uniform());
            c.offset.radius = c.base.radius * (0.8 + 0.4 * uniform());
            c.base.position = 2.0L * direction();
            c.offset.position = c.base.position + (3 * c.base.radius * (long double)uniform()) * direction();
            const LongVector inside = inside_disc();
            const LongVector s = perpendicular(c.base.normal), t = cross(c.base.normal, s);
            c.photon = c.base.position + (inside.x * c.base.radius) * s + (inside.y * c.base.radius) * t +
                       (0.3L * (2 * uniform() - 1) * c.base.radius) * c.base.normal;
            const LongVector up = direction();
            c.from = c.photon + (long double)(0.3 + 3 * uniform()) * (dot(up, c.base.normal) < 0 ? -1.0L * up : up);
            const LongVector way = normalized(c.photon - c.from);
            if (std::fabs(dot(way, c.base.normal)) > 0.05L && c.shift().is_valid)
                return c;
        }
    }
    double uniform() { return std::uniform_real_distribution<double>()(random); }
    LongVector direction() {
        std::normal_distribution<double> normal;
        return normalized({normal(random), normal(random), normal(random)});
    }
    LongVector inside_disc() {
        const double radius = std::sqrt(uniform()), turn = 2 * M_PI * uniform();
        return {radius * std::cos(turn), radius * std::sin(turn), 0};
    }

  private:
    std::mt19937_64 random;
    double bend;
};

/// How far a ray from a vertex passes a point.
long double distance_from_ray(LongVector from, LongVector towards, LongVector point) {
    return length(cross(point - from, normalized(towards - from)));
}

} // namespace

/// Wherever along its ray the offset photon lies, the shift back finds the base photon's ray, and the Jacobians are
/// inverse.
TEST(PhotonShift, ComesBack) {
    PhotonCases cases(1, 1.5);
    long double farthest = 0, worst = 0;
    for (int i = 0; i < sample_count / 10; ++i) {
        const PhotonCase c = cases.draw();
        const lib::shifted_photon there = c.shift();
        const LongVector target = as_long(there.target);
        PhotonCase back = c;
        std::swap(back.base, back.offset);
        back.photon = c.from + (long double)(1 + 0.02 * (2 * cases.uniform() - 1)) * (target - c.from);
        const lib::shifted_photon home = back.shift();
        ASSERT_TRUE(home.is_valid);
        const LongVector way = normalized(c.photon - c.from);
        // What rounding of positions of size 5 moves where they are seen at a grazing angle.
        const long double grazing =
            std::min(std::fabs(dot(way, c.base.normal)), std::fabs(dot(normalized(target - c.from), c.offset.normal)));
        farthest = worse(farthest, grazing * distance_from_ray(c.from, as_long(home.target), c.photon));
        worst = std::max<long double>(worst, grazing * std::fabs(there.jacobian * home.jacobian - 1));
    }
    std::printf("back at the photon's ray to %.2Lg, Jacobians inverse to %.2Lg\n", farthest, worst);
    // Some units in the last place of coordinates up to 5; the shortest ways are 0.3 long.
    EXPECT_LT(farthest, bound(4e-6, 8e-15));
    EXPECT_LT(worst, bound(1.5e-5, 3e-14));
}

/// By solid angle at the last vertex, against differences of the map itself.
TEST(PhotonShift, JacobianIsThatOfTheMap) {
    if (!is_double) // differences of what float rounds
        return;
    PhotonCases cases(2, 1.5);
    long double worst = 0;
    int no_cosine = 0, no_distance = 0, no_scale = 0, upside_down = 0;
    constexpr int count = 2000;
    for (int i = 0; i < count; ++i) {
        const PhotonCase c = cases.draw();
        const LongVector way = normalized(c.photon - c.from);
        const long double step = 0.02L * c.base.radius / length(c.photon - c.from) * std::fabs(dot(way, c.base.normal));
        const LongVector unmoved = normalized(c.shifted(way));
        const NumericalJacobian numerical = solid_angle_jacobian(
            [&](LongVector turn) { return normalized(c.shifted(normalized(way + turn))) - unmoved; }, way, step);
        const lib::shifted_photon there = c.shift();
        worst = std::max<long double>(worst, std::fabs(there.jacobian / numerical.value - 1));
        // What the formula would be with a part of it left out.
        const long double cosines = std::fabs(dot(normalized(as_long(there.target) - c.from), c.offset.normal)) /
                                    std::fabs(dot(way, c.base.normal));
        const long double scale = c.offset.radius / c.base.radius;
        const auto is_wrong = [&](long double value) { return std::fabs(value / numerical.value - 1) > 1e-4L; };
        no_cosine += is_wrong(there.jacobian / cosines);
        no_distance += is_wrong(cosines * scale * scale);
        no_scale += is_wrong(there.jacobian / (scale * scale));
        upside_down += is_wrong(1 / there.jacobian);
    }
    std::printf("worst relative error %.2Lg\n", worst);
    EXPECT_LT(worst, 1e-6);
    for (const int refuted : {no_cosine, no_distance, no_scale, upside_down})
        EXPECT_GT(refuted, 0.9 * count);
}

/// Along the normals: there and back, and the area against differences, on planes inclined to the discs.
TEST(PhotonShift, AlongNormalsComesBackAndKeepsItsArea) {
    PhotonCases cases(3, 1.5);
    long double farthest = 0, worst = 0;
    for (int i = 0; i < sample_count / 100; ++i) {
        const PhotonCase c = cases.draw();
        const lib::photon_disc base = c.base.as_lib(), offset = c.offset.as_lib();
        // Surfaces: planes through the gather points.
        const LongVector m = normalized(c.base.normal + 0.4L * cases.direction());
        const LongVector m_offset = normalized(c.offset.normal + 0.4L * cases.direction());
        const auto on_plane = [](LongVector point, LongVector along, const Disc &disc, LongVector normal) {
            return point - (dot(point - disc.position, normal) / dot(along, normal)) * along;
        };
        const LongVector photon = on_plane(c.photon, c.base.normal, c.base, m);
        const auto shifted = [&](LongVector from) {
            const lib::shifted_photon s = lib::photon_shift_along_normal(as_real(from), as_real(m), base, offset);
            return on_plane(as_long(s.target), c.offset.normal, c.offset, m_offset);
        };
        const lib::shifted_photon there = lib::photon_shift_along_normal(as_real(photon), as_real(m), base, offset);
        ASSERT_TRUE(there.is_valid);
        const LongVector arrived = shifted(photon);
        const lib::shifted_photon home =
            lib::photon_shift_along_normal(as_real(arrived), as_real(m_offset), offset, base);
        farthest = worse(farthest, length(on_plane(as_long(home.target), c.base.normal, c.base, m) - photon));
        if (!is_double || i % 10 != 0)
            continue;
        const LongVector first = perpendicular(m), second = cross(m, first);
        long double error;
        const long double step = 0.05L * c.base.radius;
        const LongVector a = derivative([&](long double t) { return shifted(photon + t * first); }, step, error);
        const LongVector b = derivative([&](long double t) { return shifted(photon + t * second); }, step, error);
        const long double jacobian = there.jacobian / std::fabs(dot(m_offset, c.offset.normal));
        worst = worse(worst, std::fabs(jacobian / length(cross(a, b)) - 1));
    }
    std::printf("back to %.2Lg, area to %.2Lg\n", farthest, worst);
    EXPECT_LT(farthest, bound(1e-5, 2e-14)); // lines along normals meet planes at cosines from 0.2
    EXPECT_LT(worst, 1e-6);
}

/// Along parallel rays, from a light at infinity: there and back, wherever on its ray the photon lies, and the area
/// across the rays against differences.
TEST(PhotonShift, AlongParallelRaysComesBackAndItsJacobianIsThatOfTheMap) {
    PhotonCases cases(5, 1.5);
    long double farthest = 0, worst = 0;
    int no_cosines = 0, no_scale = 0, count = 0;
    for (int i = 0; i < sample_count / 100; ++i) {
        const PhotonCase c = cases.draw();
        const lib::photon_disc base = c.base.as_lib(), offset = c.offset.as_lib();
        const LongVector way = normalized(c.photon - c.from);
        const lib::shifted_photon there = lib::photon_shift_parallel(as_real(way), as_real(c.photon), base, offset);
        if (!there.is_valid || std::fabs(dot(way, c.offset.normal)) < 0.05L)
            continue;
        const LongVector arrived = as_long(there.target) + (long double)(0.1 * (2 * cases.uniform() - 1)) * way;
        const lib::shifted_photon home = lib::photon_shift_parallel(as_real(way), as_real(arrived), offset, base);
        ASSERT_TRUE(home.is_valid);
        farthest = worse(farthest, length(cross(as_long(home.target) - c.photon, way)));
        if (!is_double || i % 10 != 0)
            continue;
        const auto shifted = [&](LongVector from) {
            return as_long(lib::photon_shift_parallel(as_real(way), as_real(from), base, offset).target);
        };
        const LongVector first = perpendicular(way), second = cross(way, first);
        long double error;
        const long double step = 0.05L * c.base.radius;
        const LongVector a = derivative([&](long double t) { return shifted(c.photon + t * first); }, step, error);
        const LongVector b = derivative([&](long double t) { return shifted(c.photon + t * second); }, step, error);
        const long double numerical = std::fabs(dot(cross(a, b), way));
        worst = std::max<long double>(worst, std::fabs(there.jacobian / numerical - 1));
        const long double scale = c.offset.radius / c.base.radius;
        const auto is_wrong = [&](long double value) { return std::fabs(value / numerical - 1) > 1e-4L; };
        no_cosines += is_wrong(scale * scale);
        no_scale += is_wrong(there.jacobian / (scale * scale));
        ++count;
    }
    std::printf("back to %.2Lg, area to %.2Lg\n", farthest, worst);
    EXPECT_LT(farthest, bound(1e-5, 2e-14)); // as along normals, at cosines from 0.05
    if (!is_double)
        return;
    EXPECT_LT(worst, 1e-6);
    EXPECT_GT(no_cosines, 0.9 * count);
    EXPECT_GT(no_scale, 0.9 * count);
}

/// On a plane, with equal radii: photons that count at one gather point alone arrive where they count at the other
/// alone, all of them.
TEST(PhotonShift, TakesThePhotonsOfOneDiscAloneToThoseOfTheOther) {
    PhotonCases cases(4, 0);
    int alone = 0;
    for (int i = 0; i < sample_count; ++i) {
        PhotonCase c = cases.draw();
        c.offset.normal = c.base.normal;
        c.offset.radius = c.base.radius;
        const LongVector s = perpendicular(c.base.normal), t = cross(c.base.normal, s);
        const LongVector inside = cases.inside_disc(), step = cases.inside_disc();
        const long double r = c.base.radius;
        c.offset.position = c.base.position + (3 * r * step.x) * s + (3 * r * step.y) * t;
        c.photon = c.base.position + (0.999L * r * inside.x) * s + (0.999L * r * inside.y) * t;
        const lib::photon_disc offset = c.offset.as_lib();
        const lib::vec3 normal = as_real(c.base.normal);
        ASSERT_TRUE(lib::photon_counts(c.base.as_lib(), as_real(c.photon), normal));
        // Within rounding of the border either is right.
        if (std::fabs(length(c.photon - c.offset.position) / r - 1) < 1e-2L ||
            lib::photon_counts(offset, as_real(c.photon), normal))
            continue;
        const lib::shifted_photon there = c.shift();
        if (!there.is_valid)
            continue;
        ++alone;
        EXPECT_TRUE(lib::photon_counts(offset, there.target, normal));
        EXPECT_FALSE(lib::photon_counts(c.base.as_lib(), there.target, normal));
    }
    EXPECT_GT(alone, sample_count / 3);
}

TEST(PhotonShift, FailsWhereAPlaneIsGrazedOrTheNormalsAreOpposite) {
    Disc base{{0, 0, 0}, {0, 0, 1}, 0.1}, offset{{0.1, 0, 0}, {0, 0, 1}, 0.1};
    const auto valid = [&](LongVector from) {
        return lib::photon_shift_from(as_real(from), lib::v3(0, 0, 0), base.as_lib(), offset.as_lib()).is_valid;
    };
    EXPECT_TRUE(valid({1, 0, 0.5}));
    EXPECT_FALSE(valid({1, 0, 0.005}));
    offset.normal = {1, 0, 0}; // its plane contains the ray
    EXPECT_FALSE(valid({0.1, 0, 0.5}));
    offset.normal = {0, 0, -1};
    EXPECT_FALSE(valid({1, 0, 0.5}));
}
