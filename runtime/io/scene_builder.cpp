#include "runtime/io/scene_builder.h"

#include "runtime/io/absent_plugins.h"
#include "runtime/io/file_search.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/mesh_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <type_traits>

namespace gradus {

namespace {

const char *const other_tags[] = {"ref", "alias", "scene"};
constexpr std::size_t deepest_references = 100; // objects in objects, by <ref>s
constexpr std::size_t longest_alias = 16;       // names that stand for names
} // namespace

SceneBuilder::SceneBuilder(const Document &document, const LoadOptions &options, FileFinder &finder,
                           Diagnostics &diagnostics)
    : document_(document), limits_(options.limits), ignore_media_(options.ignore_media), phases_(options.phases),
      finder_(finder), diagnostics_(diagnostics),
      resolve_([this](const Element &reference) -> const Element & { return resolve(reference); }),
      read_texture_([this](const Element &element, double lowest, double highest, StandsFor stands_for) {
          return texture(element, lowest, highest, stands_for, OneColor::is_no_texture);
      }),
      instance_choice_(options.instances), most_copied_bytes_(options.most_copied_bytes) {}

/// Reports tags that mean nothing, in every object.
void SceneBuilder::check_children(const Element &element) {
    // Nobody reads what is in a medium or in an integrator that is not known; an error says so, or a warning.
    const bool is_read = element.tag != "medium" && element.tag != "subsurface" && element.tag != "volume" &&
                         element.tag != "phase" && element.tag != "integrator";
    for (const Element &child : element.children) {
        const std::string &tag = child.tag;
        if (is_object_tag(tag) || is_property_tag(tag) ||
            std::find(std::begin(other_tags), std::end(other_tags), tag) != std::end(other_tags))
            continue;
        std::vector<std::string> known = all_tags();
        known.insert(known.end(), {"ref", "alias", "default", "include", "path"});
        std::string message = "unknown element <" + tag + ">";
        if (tag == "camera" || tag == "luminaire") // of 0.3 and before
            message += std::string(", of versions before 0.4; it is ") +
                       (tag == "camera" ? "a <sensor>" : "an <emitter>") + " now";
        else if (const auto nearest = nearest_name(tag, known))
            message += "; did you mean <" + *nearest + ">?";
        if (is_read)
            diagnostics_.error(child.location, message);
        else
            diagnostics_.unknown(child.location, message);
    }
}

void SceneBuilder::index(const Element &element, int depth) {
    const bool is_plugin = is_object_tag(element.tag) || (element.tag == "spectrum" && element.attribute("type"));
    if (const std::string *id = element.attribute("id"); id && is_plugin) {
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
    if (element.tag == "texture" || (is_plugin && element.tag == "spectrum")) {
        want_attribute(element);
        if (type_of(element) == "bitmap")
            pictures_.push_back(&element);
    }
    if (is_object_tag(element.tag) || depth == 0) {
        check_children(element);
        for (const Element &child : element.children)
            index(child, depth + 1);
    }
}

/// What a name stands for, through names that stand for names, as far as they are followed.
std::string SceneBuilder::without_aliases(std::string name) const {
    for (std::size_t i = 0; i < longest_alias && !by_id_.contains(name); ++i) {
        const auto alias = aliases_.find(name);
        if (alias == aliases_.end())
            break;
        name = alias->second;
    }
    return name;
}

/// nullptr where nothing has the id.
const Element *SceneBuilder::find_by_id(const std::string &name) const {
    const auto found = by_id_.find(without_aliases(name));
    return found == by_id_.end() ? nullptr : found->second;
}

const Element &SceneBuilder::resolve(const Element &reference) {
    const std::string *id = reference.attribute("id");
    if (!id)
        throw SceneError(reference.location, "<ref> needs id");
    const Element *const found = find_by_id(*id);
    if (!found && aliases_.contains(without_aliases(*id)))
        throw SceneError(reference.location,
                         fmt::format("nothing has the id \"{}\" after {} names that stand for names; "
                                     "do they go in a circle?",
                                     *id, longest_alias));
    if (!found) {
        std::vector<std::string> known; // not for the thousandth time: there may be as many ids
        for (auto at = by_id_.begin(); at != by_id_.end() && !diagnostics_.is_full(); ++at)
            known.push_back(at->first);
        std::string message = "nothing has the id \"" + *id + "\"";
        if (const auto nearest = nearest_name(*id, known))
            message += "; did you mean \"" + *nearest + "\"?";
        throw SceneError(reference.location, message);
    }
    return *found;
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
    const std::string type = type_of(element);
    const Plugin<Result> plugin = find_plugin<Result>(type);
    if (!plugin) {
        throw SceneError(element.location, unknown_plugin(element.tag, type));
    }
    open_.push_back(&element);
    try {
        Properties properties(element, *plugin.declaration, resolve_, diagnostics_, &read_texture_);
        Result result = plugin.build(properties, *this);
        properties.report_unknown();
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

std::optional<FoundFile> SceneBuilder::look_for(const std::string &name, const std::filesystem::path &beside) const {
    std::vector<std::filesystem::path> folders = {beside.parent_path()};
    folders.insert(folders.end(), document_.search_folders.begin(), document_.search_folders.end());
    return finder_.find(name, folders);
}

std::filesystem::path SceneBuilder::find_file(Properties &properties) {
    const std::string name = properties.string("filename");
    std::vector<std::filesystem::path> folders = document_.search_folders;
    std::filesystem::path beside;
    if (const auto &file = properties.location().file) { // an included file may lie elsewhere, its meshes beside it
        beside = std::filesystem::path(*file).parent_path();
        folders.push_back(beside);
    }
    const std::string place = (beside / name).string();
    const auto found = missing_files_.contains(place) ? std::nullopt : finder_.find(name, folders);
    if (!found) {
        missing_files_.insert(place);
        SceneError error =
            properties.error("filename", "cannot find the file \"" + name + "\"" + finder_.why_not(name, folders));
        error.cause = place;
        throw error;
    }
    if (!found->exact)
        diagnostics_.warn(properties.location_of("filename"),
                          "\"" + name + "\" differs in case from the file " + found->path.string());
    return found->path;
}

std::shared_ptr<const OpenFile> SceneBuilder::open_file(const std::filesystem::path &path,
                                                        const Location &location) const {
    auto file = finder_.open(path);
    if (!file)
        throw SceneError(location, "cannot read " + path.string());
    return file;
}

Scene SceneBuilder::build() {
    const Element &root = document_.root;
    index(root, 0);
    begin_pictures();
    Declaration of_scene; // some are shared, and built where they are referenced
    for (const char *tag : {"integrator", "sensor", "emitter", "shape", "bsdf", "medium", "subsurface", "volume",
                            "phase", "film", "sampler", "rfilter", "texture", "spectrum", "alias"})
        of_scene.parameters.push_back({tag, Takes::objects});
    Properties scene(root, of_scene, resolve_, diagnostics_);
    const auto each = [&](const char *tag, auto &&function) {
        for (const NestedObject &object : scene.objects(tag))
            tell_errors([&] { function(*object.element); });
    };
    try {
        each("integrator", [&](const Element &element) { build_integrator(element); });
        each("sensor", [&](const Element &element) { build_sensor(element); });
        each("emitter", [&](const Element &element) { build_emitter(element); });
        std::vector<const Element *> shapes;
        each("shape", [&](const Element &element) { shapes.push_back(&element); });
        build_shapes(shapes, nullptr);
        settle_instances();
        for (const Element *shape : shapes)
            if (type_of(*shape) == "shapegroup" && !groups_.contains(shape))
                diagnostics_.warn(shape->location, "no instance names this shapegroup: it is seen nowhere");
        std::vector<const Element *> bsdfs;
        each("bsdf", [&](const Element &element) { bsdfs.push_back(&element); });
        check_unused_bsdfs(bsdfs);
        each("texture", [&](const Element &element) { check_unused_texture(element); });
        check_media(root);
        scene.report_unknown();
        warn_of_parts_of_no_sensor(root);
    } catch (const SceneError &error) { // a <ref> in <scene> itself that leads nowhere
        diagnostics_.error(error);
    }
    check_whole();
    return std::move(scene_);
}

/// Of films, samplers and filters that stand in <scene> itself: a sensor may take them by <ref>.
void SceneBuilder::warn_of_parts_of_no_sensor(const Element &root) {
    std::set<const Element *> taken;
    const auto take = [&](const Element &from, const char *tag) {
        for (const NestedObject &object : nested_objects(from, tag, resolve_))
            taken.insert(object.element);
    };
    if (sensor_)
        for (const char *tag : {"film", "sampler"})
            take(*sensor_, tag);
    for (const Element *film : std::vector<const Element *>(taken.begin(), taken.end()))
        take(*film, "rfilter");
    for (const Element &child : root.children)
        if ((child.tag == "film" || child.tag == "sampler" || child.tag == "rfilter") && !taken.contains(&child))
            diagnostics_.warn(child.location, "<" + child.tag +
                                                  "> is passed over, as it is no sensor's: it belongs into " +
                                                  (child.tag == "rfilter" ? "the sensor's <film>" : "the <sensor>"));
}

bool SceneBuilder::tell_sensor_elsewhere() {
    for (const Element &child : document_.root.children)
        for (const Element &inside : child.children)
            if (inside.tag == "sensor") {
                diagnostics_.error(inside.location, described(inside) + " inside " + described(child) +
                                                        ": only a camera that stands in <scene> itself is rendered");
                return true;
            }
    return false;
}

/// As Mitsuba 0.6 has it: 45 degrees wide, looking along z from where all of the scene is seen.
void SceneBuilder::see_all(const Location &location) {
    const Bounds bounds = world_bounds(scene_);
    const Double3 &lower = bounds.lower, &upper = bounds.upper;
    const double largest = bounds.extent();
    Camera camera;
    camera.fov = 45;
    const double distance = largest / (2 * std::tan(0.5 * camera.fov * std::numbers::pi / 180));
    camera.near_clip = distance / 100;
    camera.far_clip = 5 * largest + distance;
    camera.to_world = translation({0.5 * (lower[0] + upper[0]), 0.5 * (lower[1] + upper[1]), lower[2] - distance});
    scene_.camera = camera;
    diagnostics_.warn(location, "the scene has no <sensor>; all of it is seen along z, as Mitsuba 0.6 has it; add one, "
                                "for example <sensor type=\"perspective\"> with a <transform name=\"to_world\"> that "
                                "says where from");
}

void SceneBuilder::check_whole() {
    const Location location{document_.root.location.file, 0};
    if ((!sensor_ && tell_sensor_elsewhere()) || diagnostics_.has_errors())
        return;
    if (scene_.shapes.empty() && !environment_)
        diagnostics_.error(location,
                           fmt::format("the scene has no shapes and no environment: there is nothing to render{}",
                                       nested_objects(document_.root, "shape", resolve_).empty()
                                           ? ""
                                           : "; its file's shapes have no area or only bound a medium"));
    else if (!sensor_ && scene_.shapes.empty())
        diagnostics_.error(location, "the scene has no <sensor> and no shapes that one could be directed at");
    else if (!sensor_)
        see_all(location);
    if (!diagnostics_.has_errors() && scene_.emitters.empty())
        diagnostics_.warn(location,
                          std::string("nothing in the scene emits light: the image will be black; add an "
                                      "<emitter>, for example one of type \"constant\"") +
                              (document_.root.is_legacy() ? ", where Mitsuba 0.x takes a sun and a sky" : ""));
}

} // namespace gradus
