#include "runtime/scene/coating.h"

#include "kernels/lib/fresnel.h"
#include "kernels/lib/microfacet.h"
#include "kernels/lib/rough_coat.h"
#include "runtime/scene/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

struct Node {
    double place, weight;
};

/// Gauss and Legendre's rule on [0, 1]: Newton's steps from the usual guess.
std::vector<Node> gauss_legendre(int count) {
    std::vector<Node> nodes;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
        for (int step = 0; step < 8; ++step) {
            double last = 1, value = x;
            for (int k = 2; k <= count; ++k) {
                const double next = ((2 * k - 1) * x * value - (k - 1) * last) / k;
                last = value;
                value = next;
            }
            slope = count * (x * value - last) / (x * x - 1);
            x -= value / slope;
        }
        nodes.push_back({0.5 * (1 - x), 1 / ((1 - x * x) * slope * slope)});
    }
    return nodes;
}

/// Of light that meets a rough interface at this cosine, the share that leaves it at once, reflected or refracted, not
/// hidden by the microsurface. eta: index beyond over index on this side.
struct Passed {
    double reflected = 0, refracted = 0;
};

Passed through_rough(int distribution, float alpha, double eta, double mu, const std::vector<Node> &along,
                     const std::vector<Node> &around) {
    const auto cosine = float(mu);
    const vec3 wi = v3(float(std::sqrt(std::max(0.0, 1 - mu * mu))), 0, cosine);
    const auto visible = [&](const vec3 &wo) { // G1
        return wo.z / microfacet_projected_area(distribution, wo, alpha, alpha);
    };
    Passed passed;
    for (const Node &u : along)
        for (const Node &v : around) {
            const vec3 m = microfacet_sample_visible(distribution, wi, alpha, alpha, float(u.place), float(v.place));
            const float c = std::clamp(v3_dot(wi, m), 0.0f, 1.0f);
            const fresnel_dielectric_result f = fresnel_dielectric(c, float(eta));
            const vec3 mirrored = v3_mad(v3_neg(wi), 2 * c, m);
            const vec3 refracted = v3_mad(v3_scale(wi, float(-1 / eta)), float(c / eta) - f.cosine_transmitted, m);
            const double weight = u.weight * v.weight;
            if (mirrored.z > 0)
                passed.reflected += weight * f.reflectance * visible(mirrored);
            if (refracted.z < 0)
                passed.refracted += weight * (1 - f.reflectance) * visible(v3_neg(refracted));
        }
    return passed;
}

bool has_rough_coat(const Bsdf &bsdf) {
    return bsdf.kind == BsdfKind::roughplastic_ggx || bsdf.kind == BsdfKind::roughplastic_beckmann;
}

constexpr int coefficients = 10;

/// Of the polynomial in x that interpolates the values at `nodes` places, the least squares of Chebyshev's.
template <class Function>
std::array<double, coefficients> fitted(Function function) {
    constexpr int nodes = 32;
    std::array<double, coefficients> chebyshev{}, result{};
    for (int i = 0; i < nodes; ++i) {
        const double angle = std::numbers::pi * (i + 0.5) / nodes, value = function(std::cos(angle));
        for (int k = 0; k < coefficients; ++k)
            chebyshev[k] += (k == 0 ? 1.0 : 2.0) / nodes * value * std::cos(k * angle);
    }
    std::array<double, coefficients> last{1}, here{0, 1}; // Chebyshev's polynomials by powers of x
    for (int k = 0; k < coefficients; ++k) {
        for (int power = 0; power < coefficients; ++power)
            result[power] += chebyshev[k] * last[power];
        std::array<double, coefficients> next{};
        for (int power = 0; power < coefficients; ++power)
            next[power] = (power > 0 ? 2 * here[power - 1] : 0.0) - last[power];
        last = here;
        here = next;
    }
    return result;
}

} // namespace

double internal_reflectance_of_smooth(double ior) {
    constexpr int count = 4096;
    double outside = 0;
    for (int i = 0; i < count; ++i) {
        const double mu = (i + 0.5) / count;
        outside += 2 * mu * fresnel_dielectric(float(mu), float(ior)).reflectance / count;
    }
    return 1 - (1 - outside) / (ior * ior);
}

void set_coating(Bsdf &bsdf) {
    const double ior = bsdf.ior;
    if (!has_rough_coat(bsdf)) {
        bsdf.internal_reflectance = float(internal_reflectance_of_smooth(ior));
        return;
    }
    if (bsdf.alpha_u.texture != no_texture) { // coat_records() are what they come to
#define GRADUS_TAKE_TEXTURE(with, name, value, text) bsdf.name.texture = bsdf.alpha_u.texture;
        GRADUS_COAT_PARAMETERS(GRADUS_TAKE_TEXTURE, )
#undef GRADUS_TAKE_TEXTURE
        return;
    }
    const int distribution = bsdf.kind == BsdfKind::roughplastic_ggx ? microfacet_ggx : microfacet_beckmann;
    const float alpha = microfacet_alpha(bsdf.alpha_u);
    // By the symmetry about the plane of wi, half of the turn says all.
    const std::vector<Node> along = gauss_legendre(48);
    std::vector<Node> around = gauss_legendre(12);
    for (Node &node : around)
        node.place = distribution == microfacet_ggx ? 0.5 * node.place : 0.5 + 0.5 * node.place;
    constexpr int cosines = 64;
    double inside = 0;
    for (int i = 0; i < cosines; ++i) {
        const double mu = std::max(1e-6, double(i) / (cosines - 1));
        inside += 2 * mu / cosines * through_rough(distribution, alpha, 1 / ior, mu, along, around).reflected;
    }
    bsdf.internal_reflectance = float(inside);
    const std::array<double, coefficients> coat = fitted([&](double x) {
        const double root = 0.5 * (x + 1);
        return through_rough(distribution, alpha, ior, std::max(1e-6, root * root), along, around).refracted;
    });
    Number *const fields[coefficients] = {&bsdf.coat_0, &bsdf.coat_1, &bsdf.coat_2, &bsdf.coat_3, &bsdf.coat_4,
                                          &bsdf.coat_5, &bsdf.coat_6, &bsdf.coat_7, &bsdf.coat_8, &bsdf.coat_9};
    for (int k = 0; k < coefficients; ++k)
        *fields[k] = float(coat[k]);
}

bool has_varying_coat(const Bsdf &bsdf) { return has_rough_coat(bsdf) && bsdf.coat_0.texture != no_texture; }

std::vector<Bsdf> coat_records(const Bsdf &bsdf) {
    std::vector<Bsdf> records(rough_coat_records);
    const auto make = [&](std::size_t i) {
        records[i] = bsdf;
        records[i].alpha_u = records[i].alpha_v = rough_coat_roughness(std::uint32_t(i));
        set_coating(records[i]);
    };
    for_each_in_parallel(records.size(), make, 1);
    return records;
}

} // namespace gradus
