#include "bench/kernels/measured_function.h"

#include "tests/kernels/bsdf_arguments.h"
#include "tests/kernels/shift_case.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace gradus::bench {

namespace {

using testing::Arguments;
using testing::rounded;
using Random = std::mt19937_64;

constexpr std::size_t material_columns = testing::material_fields, wi_column = material_columns,
                      wo_column = wi_column + 3, bsdf_columns = wo_column + 6;

double uniform(Random &random) { return std::uniform_real_distribution<double>()(random); }
double log_uniform(Random &random, double low, double high) { return low * std::pow(high / low, uniform(random)); }
double sign(Random &random) { return uniform(random) < 0.5 ? -1 : 1; }
/// A multiple of 2^-24 in [0, 1), as kernels/lib/random.h makes them.
double draw_unit(Random &random) { return std::ldexp(double(random() >> 40), -24); }

std::array<double, 3> direction_of(double z, double azimuth) {
    const double radius = std::sqrt(std::max(0.0, 1 - z * z));
    return {rounded(radius * std::cos(azimuth)), rounded(radius * std::sin(azimuth)), rounded(z)};
}

double draw_azimuth(Random &random) { return 2 * M_PI * uniform(random); }

std::vector<double> columns_of(const Arguments &a) {
    std::vector<double> row(a.material.begin(), a.material.end());
    row.insert(row.end(), a.wi.begin(), a.wi.end());
    row.insert(row.end(), a.wo.begin(), a.wo.end());
    row.insert(row.end(), {a.u_lobe, a.u1, a.u2});
    return row;
}

Arguments arguments_of(const Columns &columns, std::size_t i) {
    Arguments a;
    for (std::size_t c = 0; c < material_columns; ++c)
        a.material[c] = columns[c][i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        a.wi[axis] = columns[wi_column + axis][i];
        a.wo[axis] = columns[wo_column + axis][i];
    }
    return a;
}

MeasuredFunction bsdf(const std::string &kind) {
    const bool is_dielectric = kind.find("dielectric") != std::string::npos, is_rough = kind.starts_with("rough");
    MeasuredFunction f{kind, "kernels/measure/bsdf.cl", "measure_bsdf", {{"BSDF", kind}}, 13, {}, 11, {}, {}, {}};
    f.outputs = {{"eval", 0, 3, 1e-6},
                 {"pdf", 3, 1, 1e-6},
                 {"reverse pdf", 12, 1, 1e-6},
                 {"sampled direction", 4, 3, 0, true, true},
                 {"sample weight", 7, 3, 1e-6, false, true}};
    f.domains.push_back({"inside", [](Random &random) { return columns_of(testing::draw_arguments(random, 0.01)); }});
    f.domains.push_back({"grazing", [](Random &random) {
                             Arguments a = testing::draw_arguments(random, 0.01);
                             a.wi = direction_of(sign(random) * log_uniform(random, 1e-4, 1e-2), draw_azimuth(random));
                             return columns_of(a);
                         }});
    if (is_dielectric)
        f.domains.push_back({"critical angle", [](Random &random) {
                                 Arguments a = testing::draw_arguments(random, 0.01);
                                 // From the denser side, within 1e-3 of where the transmitted ray grazes.
                                 const double side = a[testing::Field::ior] < 1 ? 1 : -1;
                                 const double eta = side > 0 ? a[testing::Field::ior] : 1 / a[testing::Field::ior];
                                 const double near = sign(random) * log_uniform(random, 1e-7, 1e-3);
                                 a.wi = direction_of(side * std::sqrt(1 - eta * eta + near), draw_azimuth(random));
                                 return columns_of(a);
                             }});
    if (is_rough) {
        f.domains.push_back({"roughness 1e-4 to 0.01", [](Random &random) {
                                 Arguments a = testing::draw_arguments(random, 0.01);
                                 a[testing::Field::alpha_u] = rounded(log_uniform(random, 1e-4, 1e-2));
                                 a[testing::Field::alpha_v] = rounded(log_uniform(random, 1e-4, 1e-2));
                                 return columns_of(a);
                             }});
        f.domains.push_back({"half vector at the horizon", [](Random &random) {
                                 Arguments a = testing::draw_arguments(random, 0.01);
                                 const double azimuth = draw_azimuth(random);
                                 a.wi = direction_of(log_uniform(random, 1e-4, 1e-2), azimuth);
                                 a.wo = direction_of(log_uniform(random, 1e-4, 1e-2), azimuth + 0.6 * uniform(random));
                                 a[testing::Field::alpha_u] = a[testing::Field::alpha_v] =
                                     rounded(0.3 + 0.7 * uniform(random));
                                 return columns_of(a);
                             }});
    }
    for (MeasuredFunction::Domain &domain : f.domains)
        domain.is_adjusted = !domain.name.starts_with("half vector");
    // Two of three pairs are where the BSDF samples them, the third is anywhere.
    f.adjust = [](Columns &columns, const Columns &results) {
        for (std::size_t i = 0; i < columns.front().size(); ++i)
            for (std::size_t axis = 0; i % 3 != 0 && axis < 3; ++axis)
                columns[wo_column + axis][i] = rounded(results[4 + axis][i]);
    };
    f.is_edge = [is_dielectric](const Columns &columns, std::size_t i) {
        return testing::is_edge(arguments_of(columns, i), is_dielectric);
    };
    return f;
}

MeasuredFunction fresnel_of_dielectrics() {
    MeasuredFunction f{"fresnel dielectric",
                       "kernels/measure/fresnel.cl",
                       "measure_fresnel_dielectric",
                       {},
                       2,
                       {{"reflectance", 0, 1, 1e-6}, {"transmitted cosine", 1, 1, 1e-6}},
                       0,
                       {},
                       {},
                       {}};
    const auto draw_eta = [](Random &random) {
        const double eta = 1.05 + 1.45 * uniform(random);
        return rounded(uniform(random) < 0.5 ? eta : 1 / eta);
    };
    const auto at_root = [](double cosine, double eta) { return cosine * cosine + (eta - 1) * (eta + 1); };
    f.domains = {{"inside",
                  [=](Random &random) {
                      for (;;) {
                          const double cosine = rounded(0.01 + 0.99 * uniform(random)), eta = draw_eta(random);
                          if (std::fabs(at_root(cosine, eta)) > 1e-2)
                              return std::vector<double>{cosine, eta};
                      }
                  }},
                 {"grazing",
                  [=](Random &random) {
                      return std::vector<double>{rounded(log_uniform(random, 1e-4, 1e-2)), draw_eta(random)};
                  }},
                 {"critical angle",
                  [=](Random &random) {
                      const double eta = rounded(1 / (1.05 + 1.45 * uniform(random)));
                      const double near = sign(random) * log_uniform(random, 1e-7, 1e-2);
                      return std::vector<double>{rounded(std::sqrt(1 - eta * eta + near)), eta};
                  }},
                 {"index ratio near 1", [=](Random &random) {
                      const double eta = rounded(1 + sign(random) * log_uniform(random, 1e-4, 0.05));
                      for (;;) {
                          const double cosine = rounded(0.01 + 0.99 * uniform(random));
                          if (at_root(cosine, eta) > 1e-2 * cosine * cosine)
                              return std::vector<double>{cosine, eta};
                      }
                  }}};
    return f;
}

MeasuredFunction fresnel_of_conductors() {
    MeasuredFunction f{"fresnel conductor",
                       "kernels/measure/fresnel.cl",
                       "measure_fresnel_conductor",
                       {},
                       1,
                       {{"reflectance", 0, 1, 1e-6}},
                       0,
                       {},
                       {},
                       {}};
    const auto draw = [](double low, double high) {
        return [=](Random &random) {
            return std::vector<double>{rounded(log_uniform(random, low, high)), rounded(0.05 + 2 * uniform(random)),
                                       rounded(0.5 + 4 * uniform(random))};
        };
    };
    f.domains = {{"inside", draw(1e-2, 1)}, {"grazing", draw(1e-4, 1e-2)}};
    return f;
}

MeasuredFunction microfacet(const std::string &distribution) {
    MeasuredFunction f{"microfacet " + distribution,
                       "kernels/measure/microfacet.cl",
                       "measure_microfacet",
                       {{"DISTRIBUTION", "microfacet_" + distribution}},
                       5,
                       {{"density", 0, 1, 1e-6}, {"projected area", 1, 1, 1e-6}, {"sampled normal", 2, 3, 0, true}},
                       0,
                       {},
                       {},
                       {}};
    // A normal within some widths of the lobe, so that the density is not all tail.
    const auto draw = [](double lowest_alpha, double highest_alpha, double lowest_z) {
        return [=](Random &random) {
            const double u = log_uniform(random, lowest_alpha, highest_alpha),
                         v = log_uniform(random, lowest_alpha, highest_alpha);
            const double slope = 3 * uniform(random), turn = draw_azimuth(random);
            const double x = slope * u * std::cos(turn), y = slope * v * std::sin(turn);
            const double length = std::hypot(x, y, 1.0);
            const auto w = direction_of(log_uniform(random, lowest_z, 1), draw_azimuth(random));
            return std::vector<double>{
                rounded(x / length), rounded(y / length), rounded(1 / length), w[0], w[1], w[2], rounded(u),
                rounded(v),          draw_unit(random),   draw_unit(random)};
        };
    };
    f.domains = {{"inside", draw(0.01, 1, 0.01)},
                 {"roughness 1e-4 to 0.01", draw(1e-4, 1e-2, 0.01)},
                 {"grazing", draw(0.01, 1, 1e-4)}};
    return f;
}

MeasuredFunction warps() {
    MeasuredFunction f{"warp",
                       "kernels/measure/warp.cl",
                       "measure_warp",
                       {},
                       11,
                       {{"cosine hemisphere", 0, 3, 0, true},
                        {"uniform sphere", 3, 3, 0, true},
                        {"uniform cone", 6, 3, 0, true},
                        {"uniform triangle", 9, 2, 0, true}},
                       0,
                       {},
                       {},
                       {}};
    const auto draw_end = [](Random &random) {
        const double near = std::ldexp(double(random() % 64), -24);
        return uniform(random) < 0.5 ? near : 1 - std::ldexp(1.0, -24) - near;
    };
    f.domains = {
        {"inside",
         [](Random &random) {
             return std::vector<double>{draw_unit(random), draw_unit(random), rounded(log_uniform(random, 1e-4, 2))};
         }},
        {"corners", [=](Random &random) {
             return std::vector<double>{draw_end(random), draw_end(random), rounded(log_uniform(random, 1e-8, 1e-4))};
         }}};
    return f;
}

void append(std::vector<double> &row, const testing::LongVector &v) {
    row.insert(row.end(), {rounded(double(v.x)), rounded(double(v.y)), rounded(double(v.z))});
}

MeasuredFunction reconnection() {
    MeasuredFunction f{"reconnection",
                       "kernels/measure/shift.cl",
                       "measure_reconnection",
                       {},
                       1,
                       {{"Jacobian", 0, 1, 1e-30}},
                       0,
                       {},
                       {},
                       {}};
    const auto cases = std::make_shared<testing::ShiftCases>(1, 0.01);
    // Around the origin: then a short distance keeps its digits.
    const auto draw = [cases](double nearest, double farthest, double lowest_cosine, double highest_cosine) {
        return [=](Random &random) {
            const testing::LongVector normal = cases->draw_direction();
            const testing::LongVector side = testing::perpendicular(normal), other = testing::cross(normal, side);
            const auto end = [&] {
                const double cosine = sign(random) * log_uniform(random, lowest_cosine, highest_cosine);
                const double azimuth = draw_azimuth(random), sine = std::sqrt(1 - cosine * cosine);
                const testing::LongVector direction = (long double)(cosine)*normal +
                                                      (long double)(sine * std::cos(azimuth)) * side +
                                                      (long double)(sine * std::sin(azimuth)) * other;
                return (long double)(log_uniform(random, nearest, farthest)) * direction;
            };
            std::vector<double> row;
            append(row, end());
            append(row, end());
            append(row, testing::LongVector{0, 0, 0});
            append(row, normal);
            return row;
        };
    };
    f.domains = {{"inside", draw(1e-2, 1e2, 0.01, 1)},
                 {"distances 1e-4 to 1e4", draw(1e-4, 1e4, 0.01, 1)},
                 {"grazing the target", draw(1e-2, 1e2, 1e-4, 0.01)}};
    return f;
}

MeasuredFunction copied_shift(const std::string &name, const std::string &entry) {
    MeasuredFunction f{name,  "kernels/measure/shift.cl",
                       entry, {},
                       5,     {{"Jacobian", 0, 1, 1e-30, false, true}, {"direction", 1, 3, 0, true, true}},
                       4,     {},
                       {},    {}};
    const auto draw = [](double smallest, double nearest, bool inside) {
        const auto cases = std::make_shared<testing::ShiftCases>(2, smallest, nearest);
        return [=](Random &) {
            for (;;) {
                const testing::ShiftCase c = cases->draw();
                if (inside && c.half_vector_length() < 0.2)
                    continue;
                std::vector<double> row;
                append(row, c.wi_base);
                append(row, c.wo_base);
                append(row, c.wi_offset);
                row.insert(row.end(), {c.ior_base, c.ior_offset});
                return row;
            }
        };
    };
    f.domains = {{"inside", draw(0.1, 0.05, true)},
                 {"grazing, near total reflection", draw(0.0101, 0.05, false)},
                 {"index ratio near 1", draw(0.1, 1e-3, false)}};
    return f;
}

/// One vertex of a chain, with the derivatives that walks and their Jacobians are made of.
MeasuredFunction chain_vertex() {
    MeasuredFunction f{
        "chain vertex",
        "kernels/measure/chain.cl",
        "measure_chain",
        {},
        6,
        {{"spread", 0, 1, 1e-2, false, true}, {"turn", 1, 1, 1e-2, false, true}, {"direction", 2, 3, 0, true, true}},
        5,
        {},
        {},
        {}};
    const auto draw = [](double most_tilt, double least_contrast) {
        const auto cases = std::make_shared<testing::ShiftCases>(4, 0.01);
        return [=](Random &random) {
            const auto near = [&](const testing::LongVector &v, double most) {
                return testing::normalized(v + (long double)(most * uniform(random)) * cases->draw_direction());
            };
            const testing::LongVector direction = cases->draw_direction();
            const testing::LongVector geometric = near((long double)(sign(random)) * direction, most_tilt);
            std::vector<double> row;
            append(row, direction);
            append(row, geometric);
            append(row, near(geometric, 0.2));
            append(row, near((long double)(sign(random)) * direction, 0.8));
            const double contrast = least_contrast + 0.5 * uniform(random);
            const double ior = uniform(random) < 0.5 ? 1 + contrast : 1 / (1 + contrast);
            row.insert(row.end(), {0.2 * uniform(random), 0.2 * uniform(random), sign(random), ior,
                                   2 * uniform(random) - 1, 0.5 + uniform(random), 0.5 + uniform(random)});
            for (double &value : row)
                value = rounded(value);
            return row;
        };
    };
    f.domains = {{"inside", draw(0.7, 0.1), true},
                 {"grazing, near total reflection", draw(2, 0.1), true},
                 {"index ratio near 1", draw(0.7, 1e-3), true}};
    // Cases that fail make way for the one before. The end's plane is within 0.7 of the way to it.
    f.adjust = [](Columns &columns, const Columns &results) {
        for (std::size_t i = 1; i < columns.front().size(); ++i) {
            const bool fails = results[5][i] == 0;
            for (std::vector<double> &column : columns)
                column[i] = fails ? column[i - 1] : column[i];
            if (fails)
                continue;
            std::array<double, 3> plane{};
            for (std::size_t axis = 0; axis < 3; ++axis)
                plane[axis] = results[2 + axis][i] + 0.7 * columns[9 + axis][i];
            for (std::size_t axis = 0; axis < 3; ++axis)
                columns[9 + axis][i] = rounded(plane[axis] / std::hypot(plane[0], plane[1], plane[2]));
        }
    };
    // Near total reflection rounding is divided by the square of the cosine against the microfacet, which is within 0.3
    // of the normal.
    f.is_edge = [](const Columns &columns, std::size_t i) {
        double in = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            in += columns[axis][i] * columns[6 + axis][i];
        in = std::max(std::fabs(in) - 0.3, 0.0);
        const double ior = columns[15][i];
        return columns[14][i] < 0 && in * in - std::fabs(ior * ior - 1) < 0.1;
    };
    return f;
}

} // namespace

std::vector<MeasuredFunction> measured_functions(const std::vector<std::string> &kinds) {
    std::vector<MeasuredFunction> functions;
    for (const std::string &kind : kinds)
        if (kind != "null")
            functions.push_back(bsdf(kind));
    for (MeasuredFunction &f : std::vector<MeasuredFunction>{
             fresnel_of_dielectrics(), fresnel_of_conductors(), microfacet("ggx"), microfacet("beckmann"), warps(),
             reconnection(), copied_shift("half-vector copy", "measure_half_vector"),
             copied_shift("specular copy", "measure_specular"), chain_vertex()})
        functions.push_back(std::move(f));
    return functions;
}

} // namespace gradus::bench
