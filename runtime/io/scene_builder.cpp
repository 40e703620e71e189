#include "runtime/io/scene_builder.h"

#include "runtime/io/file_search.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"
#include "runtime/scene/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <type_traits>

namespace gradus {

namespace {

/// Of BSDFs that other renderers of such files have and this one has not: what looks most like them. Empty for others.
std::string substitute_for(const std::string &type) {
    static const std::map<std::string, std::string> substitutes = {
        {"coating", "plastic, of a diffuse base,"},
        {"roughcoating", "roughplastic, of a diffuse base,"},
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
    };
    const auto found = substitutes.find(type);
    return found == substitutes.end() ? "" : found->second;
}
const char *const other_tags[] = {"ref", "alias", "scene"};
constexpr std::size_t deepest_references = 100; // objects in objects, by <ref>s
constexpr std::size_t longest_alias = 16;       // names that stand for names

/// What other programs have and this one has not: nobody misspelt it.
bool is_of_mitsuba(const std::string &tag, const std::string &type) {
    static const std::set<std::pair<std::string, std::string>> plugins = {
        {"shape", "hair"},           {"shape", "bsplinecurve"},       {"shape", "linearcurve"},
        {"shape", "sdfgrid"},        {"shape", "heightfield"},        {"shape", "deformable"},
        {"shape", "ellipsoids"},     {"shape", "ellipsoidsmesh"},     {"sensor", "irradiancemeter"},
        {"sensor", "radiancemeter"}, {"sensor", "fluencemeter"},      {"sensor", "spherical"},
        {"sensor", "distant"},       {"sensor", "distantflux"},       {"sensor", "mradiancemeter"},
        {"sensor", "batch"},         {"sensor", "perspective_rdist"}, {"sensor", "telecentric"}};
    return plugins.contains({tag, type});
}

std::string described(const Element &element) {
    const std::string type = element.attribute_or("type", "");
    return "<" + element.tag + (type.empty() ? "" : " type=\"" + type + "\"") + ">";
}
} // namespace

SceneBuilder::SceneBuilder(const Document &document, const LoadOptions &options, FileFinder &finder,
                           Diagnostics &diagnostics)
    : document_(document), limits_(options.limits), ignore_media_(options.ignore_media), finder_(finder),
      diagnostics_(diagnostics),
      resolve_([this](const Element &reference) -> const Element & { return resolve(reference); }),
      read_texture_([this](const Element &element, double lowest, double highest) {
          return texture(element, lowest, highest);
      }) {}

/// Reports tags that mean nothing, in every object.
void SceneBuilder::check_children(const Element &element) {
    for (const Element &child : element.children) {
        const std::string &tag = child.tag;
        if (is_object_tag(tag) || is_property_tag(tag) ||
            std::find(std::begin(other_tags), std::end(other_tags), tag) != std::end(other_tags))
            continue;
        std::vector<std::string> known{"ref",     "default", "include",  "path",      "bsdf",      "shape",
                                       "emitter", "sensor",  "film",     "sampler",   "rfilter",   "alias",
                                       "string",  "float",   "integer",  "boolean",   "point",     "vector",
                                       "rgb",     "srgb",    "spectrum", "transform", "integrator"};
        std::string message = "unknown element <" + tag + ">";
        if (const auto nearest = nearest_name(tag, known))
            message += "; did you mean <" + *nearest + ">?";
        diagnostics_.error(child.location, message);
    }
}

void SceneBuilder::index(const Element &element, int depth) {
    if (const std::string *id = element.attribute("id"); id && is_object_tag(element.tag)) {
        const auto [other, is_new] = by_id_.emplace(*id, &element);
        if (!is_new)
            diagnostics_.error(element.location,
                               "the id \"" + *id + "\" is already taken at " + other->second->location.text());
    }
    if (element.tag == "alias") {
        const std::string *id = element.attribute("id"), *as = element.attribute("as");
        if (!id || !as)
            diagnostics_.error(element.location, "<alias> needs id and as");
        else
            aliases_[*as] = *id;
    }
    if (element.tag == "texture")
        want_attribute(element);
    if (is_object_tag(element.tag) || depth == 0) {
        check_children(element);
        for (const Element &child : element.children)
            index(child, depth + 1);
    }
}

const Element &SceneBuilder::resolve(const Element &reference) {
    const std::string *id = reference.attribute("id");
    if (!id)
        throw SceneError(reference.location, "<ref> needs id");
    std::string name = *id;
    auto found = by_id_.find(name);
    for (std::size_t i = 0; found == by_id_.end() && i < longest_alias; ++i) {
        const auto alias = aliases_.find(name);
        if (alias == aliases_.end())
            break;
        name = alias->second;
        found = by_id_.find(name);
    }
    if (found == by_id_.end()) {
        std::vector<std::string> known; // not for the thousandth time: there may be as many ids
        for (auto at = by_id_.begin(); at != by_id_.end() && !diagnostics_.is_full(); ++at)
            known.push_back(at->first);
        std::string message = "nothing has the id \"" + *id + "\"";
        if (const auto nearest = nearest_name(*id, known))
            message += "; did you mean \"" + *nearest + "\"?";
        throw SceneError(reference.location, message);
    }
    return *found->second;
}

template <typename Result>
Result SceneBuilder::build_object(const Element &element) {
    if (std::find(open_.begin(), open_.end(), &element) != open_.end())
        throw SceneError(element.location, described(element) + " contains itself through a <ref>");
    if (open_.size() > deepest_references)
        throw SceneError(element.location, described(element) + " is nested more than " +
                                               std::to_string(deepest_references) + " deep through <ref>s");
    if constexpr (std::is_same_v<Result, Material>)
        if (const auto known = built_materials_.find(&element); known != built_materials_.end()) {
            if (const auto *error = std::get_if<SceneError>(&known->second))
                throw *error;
            return std::get<Material>(known->second);
        }
    Properties properties(element, resolve_, diagnostics_);
    if constexpr (std::is_same_v<Result, Material> || std::is_same_v<Result, Emitter>)
        properties.accept_textures(&read_texture_);
    const std::string type = properties.type();
    const PluginFunction<Result> plugin = find_plugin<Result>(type);
    if (!plugin) {
        const std::vector<std::string> known = plugin_names(element.tag);
        std::string message =
            type.empty() ? "<" + element.tag + "> needs a type" : "unknown " + element.tag + " plugin \"" + type + "\"";
        const std::string substitute = element.tag == "bsdf" ? substitute_for(type) : "";
        if (is_of_mitsuba(element.tag, type))
            message = "the " + element.tag + " \"" + type + "\" is not supported";
        if (!substitute.empty())
            message += "; " + substitute + " is the nearest there is";
        else if (const auto nearest = is_of_mitsuba(element.tag, type) ? std::nullopt : nearest_name(type, known))
            message += "; did you mean \"" + *nearest + "\"?";
        throw SceneError(element.location, message + " (known: " + join(known) + ")");
    }
    open_.push_back(&element);
    try {
        Result result = plugin(properties, *this);
        properties.report_unread();
        open_.pop_back();
        if constexpr (std::is_same_v<Result, Material>)
            built_materials_.emplace(&element, result);
        return result;
    } catch (const SceneError &error) {
        open_.pop_back();
        if constexpr (std::is_same_v<Result, Material>)
            built_materials_.emplace(&element, error);
        throw;
    }
}

template Material SceneBuilder::build_object(const Element &);
template Emitter SceneBuilder::build_object(const Element &);
template FilmSettings SceneBuilder::build_object(const Element &);
template RenderSettings SceneBuilder::build_object(const Element &);
template ReconstructionFilter SceneBuilder::build_object(const Element &);
template Camera SceneBuilder::build_object(const Element &);
template ShapeGeometry SceneBuilder::build_object(const Element &);
template Texture SceneBuilder::build_object(const Element &);

std::filesystem::path SceneBuilder::find_file(Properties &properties) {
    const std::string name = properties.string("filename", "");
    if (name.empty())
        throw properties.error("filename", properties.type() + " needs a filename");
    std::vector<std::filesystem::path> folders = document_.search_folders;
    if (const auto &file = properties.location().file) // an included file may lie elsewhere, its meshes beside it
        folders.push_back(std::filesystem::path(*file).parent_path());
    const auto found = finder_.find(name, folders);
    if (!found)
        throw properties.error("filename", "cannot find the file \"" + name + "\"" + finder_.hint());
    if (!found->exact)
        diagnostics_.warn(properties.location_of("filename"),
                          "\"" + name + "\" differs in case from the file " + found->path.string());
    return found->path;
}

Scene SceneBuilder::build() {
    const Element &root = document_.root;
    index(root, 0);
    Properties scene(root, resolve_, diagnostics_);
    const auto each = [&](const char *tag, auto &&function) {
        for (const Properties::Object &object : scene.objects(tag))
            try {
                function(*object.element);
            } catch (const SceneError &error) {
                diagnostics_.error(error);
            }
    };
    try {
        each("integrator", [&](const Element &element) { build_integrator(element); });
        each("sensor", [&](const Element &element) { build_sensor(element); });
        each("emitter", [&](const Element &element) { build_emitter(element); });
        std::vector<const Element *> shapes;
        each("shape", [&](const Element &element) { shapes.push_back(&element); });
        build_shapes(shapes, nullptr);
        each("bsdf", [&](const Element &element) { check_unused_bsdf(element); });
        check_media(scene);
        for (const char *tag : {"film", "sampler", "rfilter", "texture", "alias"})
            scene.objects(tag); // shared ones, built where they are referenced
        scene.report_unread();
    } catch (const SceneError &error) { // a <ref> in <scene> itself that leads nowhere
        diagnostics_.error(error);
    }
    check_whole();
    return std::move(scene_);
}

void SceneBuilder::check_whole() {
    const Location location{document_.root.location.file, 0};
    if (!sensor_)
        diagnostics_.error(location, "the scene has no <sensor>");
    if (diagnostics_.has_errors())
        return;
    if (scene_.shapes.empty() && !environment_)
        diagnostics_.error(location, "the scene has no shapes and no environment: there is nothing to render");
    else if (scene_.emitters.empty())
        diagnostics_.warn(location, "the scene has no emitters: the image will be black");
}

void SceneBuilder::build_integrator(const Element &element) {
    if (integrator_) {
        diagnostics_.warn(element.location,
                          "a second <integrator> is ignored; the first is at " + integrator_->location.text());
        return;
    }
    integrator_ = &element;
    const std::uint64_t samples = scene_.settings.samples_per_pixel;
    if (find_plugin<RenderSettings>(std::string(trimmed(element.attribute_or("type", ""))))) {
        scene_.settings = build_object<RenderSettings>(element);
    } else {
        // Of an integrator that we do not have, the depths still count: on itself or on the one that it wraps.
        Properties properties(element, resolve_, diagnostics_);
        std::string message = "the integrator \"" + properties.type() + "\" is not known here; the method decides";
        diagnostics_.warn(element.location, message + " (known: " + join(plugin_names("integrator")) + ")");
        const std::vector<Properties::Object> nested = properties.objects("integrator");
        Properties inner(nested.empty() ? element : *nested.front().element, resolve_, diagnostics_);
        scene_.settings = integrator_path(inner, *this);
    }
    scene_.settings.integrator = std::string(trimmed(element.attribute_or("type", "")));
    scene_.settings.samples_per_pixel = samples;
}

void SceneBuilder::build_sensor(const Element &element) {
    if (sensor_) {
        diagnostics_.warn(element.location,
                          "a second <sensor> is ignored; the first is at " + sensor_->location.text());
        return;
    }
    sensor_ = &element;
    Properties properties(element, resolve_, diagnostics_);
    if (const auto films = properties.objects("film"); !films.empty()) {
        const Element &film = *films.front().element;
        const std::string type(trimmed(film.attribute_or("type", "")));
        if (!type.empty() && !find_plugin<FilmSettings>(type)) {
            // Of a film that we do not have, size, crop and filter still count.
            diagnostics_.warn(film.location, "the film \"" + type + "\" is not known here; it is read as hdrfilm");
            Properties inner(film, resolve_, diagnostics_);
            scene_.film = film_hdrfilm(inner, *this);
        } else {
            scene_.film = build_object<FilmSettings>(film);
        }
    }
    check_media(properties);
    if (const auto samplers = properties.objects("sampler"); !samplers.empty()) {
        // Of a sampler only its count matters: the methods bring their own random numbers.
        Properties sampler(*samplers.front().element, resolve_, diagnostics_);
        scene_.settings.samples_per_pixel = std::uint64_t(sampler.integer("sample_count", 4, 1, std::int64_t(1) << 40));
    }
    scene_.camera = build_object<Camera>(element);
}

namespace {

/// What to do about emitters of Mitsuba's that we do not have.
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

} // namespace

void SceneBuilder::build_emitter(const Element &element) {
    const std::string type(trimmed(element.attribute_or("type", "")));
    refuse_emitter(type, element.location);
    if (type == "area") {
        if (!element.attribute_or("id", "").empty())
            return; // for shapes to refer to
        throw SceneError(element.location, "an area emitter belongs inside the shape that emits");
    }
    const Emitter emitter = build_object<Emitter>(element);
    if (emitter.kind == Emitter::Kind::constant || emitter.kind == Emitter::Kind::environment) {
        if (environment_)
            throw SceneError(element.location,
                             "a second environment emitter; the first is at " + environment_->location.text());
        environment_ = &element;
    }
    if (emitter.value == Rgb{}) {
        diagnostics_.warn(element.location, described(element) + " is black and left out");
        return;
    }
    scene_.emitters.push_back(emitter);
}

/// A BSDF that no shape uses cannot harm the image: what is wrong with it is worth a warning.
void SceneBuilder::check_unused_bsdf(const Element &element) {
    if (materials_.count(&element))
        return;
    try {
        build_object<Material>(element);
    } catch (const SceneError &error) {
        diagnostics_.warn(element.location, std::string("unused BSDF: ") + error.what());
    }
}

std::uint32_t SceneBuilder::material_of(Properties &shape) {
    const std::vector<Properties::Object> bsdfs = shape.objects("bsdf");
    if (bsdfs.size() > 1)
        throw SceneError(bsdfs[1].location, "a shape has one BSDF; this is its second");
    if (bsdfs.empty()) {
        // Mitsuba 3's defaults: half of the light is reflected, but nothing by a shape that emits.
        const bool emits = !shape.objects("emitter").empty();
        std::int64_t &index = emits ? default_emitter_material_ : default_material_;
        if (index < 0) {
            index = std::int64_t(scene_.materials.size());
            scene_.materials.push_back({});
            scene_.materials.back().name = emits ? "default of emitters" : "default";
            if (emits)
                scene_.materials.back().front.reflectance = {0, 0, 0};
        }
        return std::uint32_t(index);
    }
    const Element &element = *bsdfs.front().element;
    const auto known = materials_.find(&element);
    if (known != materials_.end())
        return known->second;
    Material material = build_object<Material>(element);
    material.name = element.attribute_or("id", element.attribute_or("type", "") + " at " + element.location.text());
    const auto index = std::uint32_t(scene_.materials.size());
    scene_.materials.push_back(material);
    materials_[&element] = index;
    return index;
}

std::int32_t SceneBuilder::emitter_of(Properties &shape) {
    const std::vector<Properties::Object> emitters = shape.objects("emitter");
    if (emitters.empty())
        return -1;
    if (emitters.size() > 1)
        throw SceneError(emitters[1].location, "a shape has one emitter; this is its second");
    const Element &element = *emitters.front().element;
    const std::string type(trimmed(element.attribute_or("type", "")));
    refuse_emitter(type, emitters[0].location);
    if (type != "area" && find_plugin<Emitter>(type))
        throw SceneError(emitters[0].location, "only an area emitter can stand inside a shape, not \"" + type + "\"");
    auto known = area_emitters_.find(&element);
    if (known == area_emitters_.end())
        known = area_emitters_.emplace(&element, build_object<Emitter>(element)).first;
    const Emitter &emitter = known->second;
    if (emitter.value == Rgb{})
        return -1;
    scene_.emitters.push_back(emitter);
    return std::int32_t(scene_.emitters.size() - 1);
}

} // namespace gradus
