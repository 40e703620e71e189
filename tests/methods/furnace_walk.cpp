#define GRADUS_DOUBLE
#include "tests/methods/furnace_walk.h"

#include "runtime/scene/traits.h"
#include "runtime/scene/transform.h"

#include <cmath>
#include <random>
#include <stdexcept>

// Last: it defines macros with short names.
#include "kernels/lib/bsdf.h"

namespace gradus::testing {

namespace {

namespace lib = lib_double;

using Sample = lib::bsdf_sample (*)(lib::material, lib::vec3, double, double, double, int);

Sample sampler_named(const std::string &name) {
#define GRADUS_NAMED(kind, ...)                                                                                        \
    if (name == #kind)                                                                                                 \
        return lib::kind##_sample;
    GRADUS_BSDF_KINDS(GRADUS_NAMED)
#undef GRADUS_NAMED
    throw std::runtime_error("no BSDF kind " + name);
}

lib::material material_from(const Bsdf &b) {
    lib::material m{};
#define GRADUS_COLOR(with, name, value, text) m.name##_r = b.name.r, m.name##_g = b.name.g, m.name##_b = b.name.b;
#define GRADUS_NUMBER(with, name, value, text) m.name = b.name;
    GRADUS_MATERIAL_PARAMETERS(GRADUS_COLOR, GRADUS_NUMBER, )
#undef GRADUS_COLOR
#undef GRADUS_NUMBER
    return m;
}

/// A point of the surface with its outward normal and the direction of dp/du.
struct Point {
    Double3 position, normal, tangent;
};

Point sphere_point(const Double3 &p) {
    const Double3 normal = normalize(p);
    return {normal, normal, normalize(Double3{-normal[1], normal[0], 0})};
}

Point cube_point(const Double3 &p, int axis) {
    Point point{p, {}, {}};
    const double side = p[axis] > 0 ? 1 : -1;
    point.position[axis] = side;
    point.normal[axis] = side;
    point.tangent[(axis + (side > 0 ? 1 : 2)) % 3] = 1;
    return point;
}

/// Where a line enters the object (from outside) or leaves it (from a point of its surface).
Point meet(ConvexShape shape, const Double3 &origin, const Double3 &direction, bool entering) {
    if (shape == ConvexShape::sphere) {
        const double b = -dot(origin, direction);
        const double half_chord = std::sqrt(std::max(0.0, 1 - dot(origin, origin) + b * b));
        return sphere_point(add(origin, scale(direction, entering ? b - half_chord : b + half_chord)));
    }
    double found = entering ? -INFINITY : INFINITY;
    int axis = 0;
    for (int a = 0; a < 3; ++a) {
        if (direction[a] == 0)
            continue;
        const double t = ((direction[a] > 0) == entering ? -1 - origin[a] : 1 - origin[a]) / direction[a];
        if (entering ? t > found : t < found) {
            found = t;
            axis = a;
        }
    }
    return cube_point(add(origin, scale(direction, found)), axis);
}

} // namespace

WalkMean walk(ConvexShape shape, const Bsdf &bsdf, const View &view, int walks) {
    const Sample sample = sampler_named(bsdf_kind_name(bsdf));
    const lib::material material = material_from(bsdf);
    const Double3 origin{view.from[0], view.from[1], view.from[2]};
    const Matrix4 camera = look_at(origin, {0, 0, 0}, {0, 1, 0});
    const double half_width = std::tan(view.fov * M_PI / 360);
    std::mt19937_64 engine(7);
    std::uniform_real_distribution<double> uniform;
    WalkMean result;
    std::array<double, 3> squares{};
    for (int i = 0; i < walks; ++i) {
        Double3 direction = normalize(transform_vector(
            camera, {half_width * (2 * uniform(engine) - 1), half_width * (2 * uniform(engine) - 1), 1}));
        Point point = meet(shape, origin, direction, true);
        std::array<double, 3> throughput{1, 1, 1};
        for (;;) {
            const Double3 s = point.tangent, n = point.normal, t = cross(n, s);
            const lib::vec3 wi = lib::v3(-dot(direction, s), -dot(direction, t), -dot(direction, n));
            const double u_lobe = uniform(engine), u1 = uniform(engine), u2 = uniform(engine);
            const lib::bsdf_sample drawn = sample(material, wi, u_lobe, u1, u2, lib::transport_radiance);
            throughput[0] *= drawn.weight.r, throughput[1] *= drawn.weight.g, throughput[2] *= drawn.weight.b;
            if (drawn.pdf <= 0 || throughput[0] + throughput[1] + throughput[2] <= 0) {
                throughput = {};
                break;
            }
            direction = normalize(add(add(scale(s, drawn.wo.x), scale(t, drawn.wo.y)), scale(n, drawn.wo.z)));
            if (drawn.wo.z > 0)
                break; // outside: nothing but the environment
            point = meet(shape, point.position, direction, false);
        }
        for (int c = 0; c < 3; ++c) {
            result.mean[c] += throughput[c] / walks;
            squares[c] += throughput[c] * throughput[c] / walks;
        }
    }
    for (int c = 0; c < 3; ++c)
        result.standard_error[c] = std::sqrt(std::max(0.0, squares[c] - result.mean[c] * result.mean[c]) / walks);
    return result;
}

} // namespace gradus::testing
