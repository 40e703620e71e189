#include "runtime/io/absent_plugins.h"

#include "runtime/io/diagnostics.h"
#include "runtime/io/plugins/catalogue.h"
#include "runtime/io/text.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace gradus {

namespace {

/// Of BSDFs that other renderers of such files have and this one has not: what looks most like them. Empty for others.
std::string substitute_for(const std::string &type) {
    static const std::map<std::string, std::string> substitutes = {
        {"coating", "plastic, of a diffuse base, or principled with clearcoat 1, of a metal,"},
        {"roughcoating", "roughplastic, of a diffuse base, or principled with clearcoat 1, of a metal,"},
        {"pplastic", "plastic"},
        {"polarizer", "null"},
        {"retarder", "null"},
        {"circular", "null"},
        {"difftrans", "principledthin with diff_trans 2"},
        {"hk", "principledthin with diff_trans 1"},
        {"irawan", "roughdiffuse"},
        {"sssbrdf", "principled with flatness 1"},
        {"measured", "principled"},
        {"measured_polarized", "principled"},
        {"hair", "principled"},
        {"roughgrating", "roughconductor"},
        {"lambertian", "diffuse"}, // of versions before 0.4, and of other renderers
        {"glass", "dielectric"},
        {"mirror", "conductor"},
        {"disney", "principled"},
        {"disneybsdf", "principled"},
    };
    const auto found = substitutes.find(type);
    return found == substitutes.end() ? "" : found->second;
}

/// What other programs have and this one has not: nobody misspelt it.
bool is_of_mitsuba(const std::string &tag, const std::string &type) {
    static const std::set<std::pair<std::string, std::string>> plugins = {
        {"shape", "hair"},           {"shape", "bsplinecurve"},       {"shape", "linearcurve"},
        {"shape", "sdfgrid"},        {"shape", "heightfield"},        {"shape", "deformable"},
        {"shape", "ellipsoids"},     {"shape", "ellipsoidsmesh"},     {"sensor", "irradiancemeter"},
        {"sensor", "radiancemeter"}, {"sensor", "fluencemeter"},      {"sensor", "spherical"},
        {"sensor", "distant"},       {"sensor", "distantflux"},       {"sensor", "mradiancemeter"},
        {"sensor", "batch"},         {"sensor", "perspective_rdist"}, {"sensor", "telecentric"},
        {"texture", "volume"},       {"texture", "wireframe"},        {"texture", "curvature"}};
    return plugins.contains({tag, type});
}

bool is_one_of(const std::string &type, std::initializer_list<const char *> types) {
    return std::find(types.begin(), types.end(), type) != types.end();
}

} // namespace

std::string unknown_plugin(const std::string &category, const std::string &type) {
    if (category == "spectrum")
        return "the spectrum \"" + type + "\" is not known here: write value=\"wavelength:value, ...\", or one of " +
               "type blackbody, d65, srgb or uniform";
    const std::vector<std::string> known = plugin_names(category);
    std::string message =
        type.empty() ? "<" + category + "> needs a type" : "unknown " + category + " plugin \"" + type + "\"";
    const std::string substitute = category == "bsdf" ? substitute_for(type) : "";
    const bool is_absent = !substitute.empty() || is_of_mitsuba(category, type);
    if (is_absent)
        message = "the " + category + " \"" + type + "\" is not supported";
    if (!substitute.empty())
        message += "; " + substitute + " is the nearest there is";
    else if (const auto nearest = is_absent ? std::nullopt : nearest_name(type, known))
        message += "; did you mean \"" + *nearest + "\"?";
    return message + " (known: " + join(known) + ")";
}

std::string note_on_integrator(const std::string &type) {
    const std::string quoted = "the integrator \"" + type + "\" ";
    if (type == "gpt" || type == "sppm" || type == "gpm")
        return quoted + "is a method here: --method " + type + " renders with it";
    if (type == "photonmapper" || type == "ppm")
        return quoted + "renders with photons, as --method sppm and --method gpm do here";
    if (is_one_of(type, {"volpath", "volpath_simple", "volpathmis", "prb", "prb_basic", "prbvolpath"}))
        return ""; // path tracers, whose image is the same without media
    if (is_one_of(type, {"bdpt", "ptracer", "adaptive", "vpl", "irrcache", "pssmlt", "mlt", "erpt", "gbdpt", "gdmlt"}))
        return quoted + "makes the same image in another way; here --method says how";
    if (is_one_of(type, {"ao", "depth", "field", "normals", "uv"}))
        return quoted + "makes an image of something else: --aov writes depth, normals and albedo beside that of light";
    return quoted + "is not known here; --method says what renders (known: " + join(plugin_names("integrator")) + ")";
}

void refuse_emitter(const std::string &type, const Location &location) {
    for (const char *model : {"sky", "sun", "sunsky", "timed_sunsky"})
        if (type == model)
            throw SceneError(location, "the sky model \"" + type +
                                           "\" is not supported: bake it into an image in latitude and longitude, "
                                           "and give that to an emitter \"envmap\"");
    if (type == "directionalarea" || type == "collimated")
        throw SceneError(location, "the emitter \"" + type +
                                       "\" is not supported; of what shines one way there are \"directional\" and "
                                       "\"spot\"");
}

} // namespace gradus
