#include "runtime/io/refractive_index.h"

#include "runtime/io/text.h"

#include <algorithm>
#include <iterator>

namespace gradus {

namespace {

struct NamedDielectric {
    const char *name;
    double index;
};

// Handbook values for the sodium D line; gases at 0 degrees Celsius and one atmosphere.
constexpr NamedDielectric dielectrics[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419},
};

struct NamedConductor {
    const char *name;
    float eta_r, eta_g, eta_b, k_r, k_g, k_b;
};

// Measured n(lambda) and k(lambda) (E. Palik, Handbook of Optical Constants, and the SOPRA tables), integrated over the
// CIE 1931 observer as a light of equal energy is. That makes red 1.2 times and blue 0.9 times what a mean over each
// channel would give, but these are the values that Mitsuba 3.9 prints in its RGB mode, and both renderers must agree
// on a metal. The tests compare k of the noble metals with Johnson and Christy's tables (1972), treated alike.
constexpr NamedConductor conductors[] = {
    {"none", 0, 0, 0, 1, 1, 1},
    {"a-C", 2.94405f, 2.22714f, 1.96816f, 0.887465f, 0.799299f, 0.81529f},
    {"Ag", 0.155276f, 0.116728f, 0.138388f, 4.82835f, 3.12222f, 2.1469f},
    {"Al", 1.6575f, 0.880405f, 0.521244f, 9.22381f, 6.2695f, 4.837f},
    {"AlAs", 3.6053f, 3.23294f, 2.21632f, 0.000679437f, 0, 0.00751271f},
    {"AlSb", 0, 4.13937f, 4.6693f, 0, 0.0940091f, 1.30057f},
    {"Au", 0.143036f, 0.375307f, 1.44205f, 3.983f, 2.38556f, 1.60336f},
    {"Be", 4.18501f, 3.18503f, 2.78406f, 3.83547f, 3.01012f, 2.86899f},
    {"Cr", 4.36967f, 2.91651f, 1.6549f, 5.20655f, 4.23131f, 3.7547f},
    {"CsI", 2.1449f, 1.70232f, 1.66243f, 0, 0, 0},
    {"Cu", 0.201005f, 0.92375f, 1.10222f, 3.91326f, 2.45305f, 2.14209f},
    {"Cu2O", 3.55177f, 2.94987f, 2.75188f, 0.114207f, 0.193897f, 0.606134f},
    {"Cu_palik", 0.213229f, 0.919715f, 1.10241f, 3.92187f, 2.45733f, 2.13658f},
    {"CuO", 3.24754f, 2.44781f, 2.21022f, 0.52109f, 0.570031f, 0.722179f},
    {"d-C", 2.70872f, 2.31883f, 2.2289f, 0, 0, 0},
    {"Hg", 2.39894f, 1.44003f, 0.90957f, 6.32759f, 4.37192f, 3.42176f},
    {"HgTe", 4.77904f, 3.2312f, 2.6599f, 1.63161f, 1.58081f, 1.72929f},
    {"Ir", 3.0863f, 2.08219f, 1.61791f, 5.59215f, 4.06709f, 3.26731f},
    {"K", 0.0640432f, 0.0464098f, 0.0381849f, 2.1042f, 1.34894f, 0.913126f},
    {"Li", 0.265791f, 0.195618f, 0.220949f, 3.54015f, 2.31112f, 1.66861f},
    {"MgO", 2.08958f, 1.65072f, 1.59488f, 4.3327e-12f, 0, 2.49865e-11f},
    {"Mo", 4.48397f, 3.52513f, 2.77631f, 4.11144f, 3.42083f, 3.15061f},
    {"Na_palik", 0.0602694f, 0.0561409f, 0.0619884f, 3.17927f, 2.11249f, 1.57904f},
    {"Nb", 3.42007f, 2.79009f, 2.39563f, 3.44139f, 2.73767f, 2.57975f},
    {"Ni_palik", 2.3673f, 1.66337f, 1.46708f, 4.49881f, 3.05015f, 2.34544f},
    {"Rh", 2.58579f, 1.86022f, 1.55426f, 6.78226f, 4.70299f, 3.97607f},
    {"Se", 4.05831f, 2.84294f, 2.82085f, 0.75405f, 0.638444f, 0.521808f},
    {"Se-e", 5.72285f, 4.16574f, 4.08134f, 0.871136f, 1.10516f, 1.56532f},
    {"SiC", 3.17234f, 2.52597f, 2.47937f, 7.53766e-07f, 0, 1.01925e-05f},
    {"SnTe", 4.52425f, 1.98164f, 1.28159f, 0, 0, 0},
    {"Ta", 2.06272f, 2.39294f, 2.62793f, 2.40836f, 1.74149f, 1.94703f},
    {"Te", 7.39023f, 4.4821f, 2.63711f, 3.25602f, 3.52706f, 3.29205f},
    {"Te-e", 7.50891f, 4.29643f, 2.36999f, 5.58393f, 4.94721f, 3.99759f},
    {"ThF4", 1.83071f, 1.44223f, 1.38765f, 0, 0, 0},
    {"TiC", 3.70053f, 2.83742f, 2.58229f, 3.26564f, 2.35159f, 2.17279f},
    {"TiN", 1.64845f, 1.15052f, 1.37982f, 3.36833f, 1.9435f, 1.10207f},
    {"TiO2", 3.45661f, 2.80174f, 2.90517f, 0.000105265f, 0, 0.000652887f},
    {"TiO2-e", 3.10656f, 2.51317f, 2.58244f, 2.97517e-05f, 0, 0.000182698f},
    {"V_palik", 4.27758f, 3.51295f, 2.76107f, 3.4913f, 2.88945f, 3.11152f},
    {"VC", 3.65757f, 2.75274f, 2.53267f, 3.0683f, 2.19869f, 1.96319f},
    {"VN", 2.8656f, 2.11919f, 1.94009f, 3.03224f, 2.05612f, 1.61631f},
    {"W", 4.37082f, 3.30025f, 2.99841f, 3.50064f, 2.60487f, 2.27323f},
};

} // namespace

std::optional<double> dielectric_index(const std::string &name) {
    const std::string wanted = lower_case(trimmed(name));
    for (const NamedDielectric &entry : dielectrics)
        if (wanted == lower_case(entry.name))
            return entry.index;
    return std::nullopt;
}

std::vector<std::string> dielectric_names() {
    std::vector<std::string> names;
    for (const NamedDielectric &entry : dielectrics)
        names.push_back(entry.name);
    return names;
}

std::optional<ConductorIndex> conductor_index(const std::string &name) {
    // The suffix names the measurement, of which one a material is kept here, but for copper.
    const std::string suffix = "_palik", wanted = lower_case(trimmed(name));
    const auto bare = [&](const std::string &text) {
        const bool has_suffix = text.size() > suffix.size() && text.ends_with(suffix);
        return has_suffix ? text.substr(0, text.size() - suffix.size()) : text;
    };
    const auto find = [](const auto &is_wanted) {
        const auto at = std::find_if(std::begin(conductors), std::end(conductors),
                                     [&](const NamedConductor &entry) { return is_wanted(lower_case(entry.name)); });
        return at == std::end(conductors)
                   ? std::nullopt
                   : std::optional(ConductorIndex{{at->eta_r, at->eta_g, at->eta_b}, {at->k_r, at->k_g, at->k_b}});
    };
    const auto exact = find([&](const std::string &name) { return name == wanted; });
    return exact ? exact : find([&](const std::string &name) { return bare(name) == bare(wanted); });
}

std::vector<std::string> conductor_names() {
    std::vector<std::string> names;
    for (const NamedConductor &entry : conductors)
        names.push_back(entry.name);
    return names;
}

} // namespace gradus
