// BSDFs as files describe them against Mitsuba 3's own values: tests/references/bsdfs.txt, made by bsdfs.py.
#include "tests/io/scene_text.h"

#include "kernels/lib/bsdf.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/traits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace gradus {
namespace {

namespace lib = lib_float;

struct Functions {
    lib::bsdf_value (*evaluate)(lib::material, lib::vec3, lib::vec3, int mode);
    lib::bsdf_sample (*sample)(lib::material, lib::vec3, float, float, float, int mode);
};

Functions functions_of(const Bsdf &bsdf) {
#define GRADUS_FUNCTIONS(name, ...) {lib::name##_evaluate, lib::name##_sample},
    const Functions functions[] = {GRADUS_BSDF_KINDS(GRADUS_FUNCTIONS)};
#undef GRADUS_FUNCTIONS
    return functions[bsdf_kind_number(bsdf)];
}

/// f |cos wo|; of Dirac kinds weight times probability of the event that wo says by its side.
lib::rgb value_of(const Bsdf &bsdf, const lib::material &m, lib::vec3 wi, lib::vec3 wo) {
    const Functions functions = functions_of(bsdf);
    if (!bsdf_kind_traits(bsdf.kind).is_dirac)
        return functions.evaluate(m, wi, wo, lib::transport_radiance).value;
    const lib::bsdf_sample sample =
        functions.sample(m, wi, wi.z * wo.z > 0 ? -1.0f : 2.0f, 0.5f, 0.5f, lib::transport_radiance);
    EXPECT_NEAR(lib::v3_dot(sample.wo, wo), 1, 1e-5);
    return lib::rgb_scale(sample.weight, sample.pdf);
}

/// What is left where one side fits what the other computes, relative to the larger of the value and a hundredth.
/// Smooth coats: the error that the fit of the internal reflectance that Mitsuba takes (Egan and Hilgeman 1973) is said
/// to have, 0.1 % at an index of 1.5 and 0.6 % at 2, times what it does to 1 / (1 - reflectance), up to 2. Rough coats:
/// 1e-3 by our polynomial in either direction; Beckmann's, 0.35 % for each masking term, of which Mitsuba takes
/// Walter's rational fit (2007), of two. Others are float alone, of values rounded to seven digits.
double tolerance_of(const Bsdf &bsdf) {
    const std::string kind = bsdf_kind_name(bsdf);
    if (kind == "plastic")
        return bsdf.ior < 1.6 ? 2e-3 : 1.2e-2;
    return kind == "roughplastic_beckmann" ? 7e-3 : kind == "roughplastic_ggx" ? 2e-3 : 2e-5;
}

TEST(BsdfReference, IsMitsubas) {
    std::ifstream file(GRADUS_REFERENCES "/bsdfs.txt");
    ASSERT_TRUE(file);
    std::string line, material;
    Bsdf bsdf;
    lib::material m{};
    double worst = 0;
    int compared = 0, materials = 0;
    const auto finish = [&] {
        if (materials++ > 0)
            std::printf("  largest error %.1e (of %.0e): %s\n", worst, tolerance_of(bsdf), material.c_str());
        worst = 0;
    };
    while (std::getline(file, line)) {
        if (line.starts_with("#"))
            continue;
        if (line.starts_with("bsdf ")) {
            finish();
            material = line.substr(5);
            const Scene scene =
                load_text(scene_around("<shape type=\"cube\">" + material + "</shape><emitter type=\"constant\"/>",
                                       "3.0.0", ""))
                    .scene;
            bsdf = scene.materials.at(0).front;
            const SceneTables tables = make_scene_tables(scene, scene_traits(scene));
            m = lib::material_load(tables.materials.data(), 0, 1);
            continue;
        }
        std::istringstream numbers(line);
        float v[9];
        for (float &x : v)
            ASSERT_TRUE(numbers >> x) << line;
        const lib::rgb ours = value_of(bsdf, m, lib::v3(v[0], v[1], v[2]), lib::v3(v[3], v[4], v[5]));
        const float values[] = {ours.r, ours.g, ours.b};
        for (int channel = 0; channel < 3; ++channel) {
            const double theirs = v[6 + channel], scale = std::max(theirs, 0.01);
            worst = std::max(worst, std::fabs(values[channel] - theirs) / scale);
            EXPECT_NEAR(values[channel], theirs, tolerance_of(bsdf) * scale) << material << "\n" << line;
            ++compared;
        }
    }
    finish();
    EXPECT_GT(compared, 2000);
}

} // namespace
} // namespace gradus
