// On the paths of renders: each shift has a way back, it ends where the base path is, and the product of both Jacobians
// is 1. Gradient-domain path tracing is unbiased only if that is so.
#include "tests/methods/reference_scene.h"
#include "tests/methods/shift_inverse.h"
#include "tests/support/render.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace gradus::testing {
namespace {

struct InverseCase {
    const char *name, *scene;
    double threshold;     ///< of the roughness from which on offset paths reconnect
    double distance = 0;  ///< and of the least way
    unsigned samples = 2; ///< a pixel of 128 x 96, a little more than 30000 shifts each
};

void PrintTo(const InverseCase &c, std::ostream *out) { *out << c.name; }

double quantile(std::vector<float> values, double share) {
    if (values.empty())
        return 0;
    const auto place = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

void record(const InverseCase &c, const char *area, const char *kind, const InverseShifts &s, double limit) {
    if (s.shifts == 0)
        return;
    const std::string provoked_by = fmt::format("{} in renders of the project's scenes", kind);
    const double shifts = double(s.shifts);
    record_stability({area, "a shift without a way back biases the image", provoked_by,
                      "both ways decide by the same vertices",
                      "shifts with no way back, or with one of another kind, of a million",
                      1e6 * double(s.one_way + s.other_kind) / shifts, 30});
    record_stability({area, "a way back that ends elsewhere biases the image", provoked_by,
                      "rays and hits of both ways are computed alike; where they pass edges, rounding decides",
                      "shifts whose way back ends further off than a thousandth of the way, of a million",
                      1e6 * double(s.elsewhere) / shifts, 100});
    record_stability({area, "Jacobians that are not each other's inverse bias the image", provoked_by,
                      "formulas hold to rounding; rays start off the surface, which turns a short segment",
                      "99.9th percentile of the product of Jacobians less 1", quantile(s.jacobian_errors, 0.999),
                      limit});
    ::testing::Test::RecordProperty(fmt::format("{}_shifts", area[0] == 'R' ? "reconnection" : "copy"),
                                    std::to_string(s.shifts));
    std::printf("%s of %s, threshold %g, distance %g: %llu shifts, %llu without a way back, %llu of another kind, %llu "
                "elsewhere; "
                "product of Jacobians less 1: median %.2g, 99 %% %.2g, 99.9 %% %.2g, largest %.2g\n",
                kind, c.scene, c.threshold, c.distance, static_cast<unsigned long long>(s.shifts),
                static_cast<unsigned long long>(s.one_way), static_cast<unsigned long long>(s.other_kind),
                static_cast<unsigned long long>(s.elsewhere), quantile(s.jacobian_errors, 0.5),
                quantile(s.jacobian_errors, 0.99), quantile(s.jacobian_errors, 0.999), quantile(s.jacobian_errors, 1));
}

class ShiftInverse : public ::testing::TestWithParam<InverseCase> {};

TEST_P(ShiftInverse, BringsEveryPathBack) {
    const InverseCase &c = GetParam();
    Scene scene = own_scene(fmt::format("{}.xml", c.scene), 128, 96);
    scene.settings.samples_per_pixel = c.samples;
    RenderOptions options;
    options.shift_threshold = c.threshold;
    options.shift_distance = c.distance;
    ShiftInverter inverter(shared_device(), scene);
    render(scene, options, "gpt");
    EXPECT_GT(inverter.reconnections().shifts + inverter.copies().shifts, 10000u * c.samples);
    record(c, "Reconnection", "reconnections", inverter.reconnections(), 0.03);
    record(c, "Half-vector copy", "copies", inverter.copies(), 0.01);
}

std::string name_of_inverse(const ::testing::TestParamInfo<InverseCase> &info) { return info.param.name; }

const std::vector<InverseCase> quick = {{"cornell_box", "cornell-box", 0.01},
                                        {"door_ajar", "door-ajar", 0.01},
                                        {"materials", "materials", 0.01},
                                        {"materials_copied", "materials", 0.21},
                                        {"torus", "torus-rough-glass", 0.01}};
INSTANTIATE_TEST_SUITE_P(Methods, ShiftInverse, ::testing::ValuesIn(quick), name_of_inverse);

/// The shifts of millions of paths, and some by kernels that no other test compiles.
std::vector<InverseCase> full_cases() {
    std::vector<InverseCase> cases = quick;
    cases.insert(cases.end(), {{"holes", "holes", 0.01},
                               {"plates", "plates", 0.01},
                               {"plates_copied", "plates", 0.2},
                               {"plastics", "plastics", 0.01},
                               {"relief", "../tests/scenes/relief", 0.01},
                               {"torus_copied", "torus-rough-glass", 0.2},
                               {"torus_near", "torus-rough-glass", 0.01, 0.02},
                               {"materials_near", "materials", 0.01, 0.02}});
    for (InverseCase &c : cases)
        c.samples = 64;
    return cases;
}
INSTANTIATE_TEST_SUITE_P(Full, ShiftInverse, ::testing::ValuesIn(full_cases()), name_of_inverse);

} // namespace
} // namespace gradus::testing
