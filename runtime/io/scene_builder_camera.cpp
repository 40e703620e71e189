// The sensor of a scene file with what hangs on it, and its integrator.
#include "runtime/io/absent_plugins.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/scene_builder.h"
#include "runtime/io/text.h"

#include <algorithm>

namespace gradus {

/// What an object of any type says that a plugin knows, the rest in silence.
template <typename Result>
Result SceneBuilder::read_as(const Element &element, const std::string &type) {
    const Plugin<Result> plugin = find_plugin<Result>(type);
    Properties properties(element, *plugin.declaration, resolve_, diagnostics_, &read_texture_);
    return plugin.build(properties, *this);
}

/// What is wrapped by integrators that we do not have, which add layers or moments to another one's image; or the
/// element itself.
const Element &SceneBuilder::innermost_integrator(const Element &element) const {
    const Element *innermost = &element;
    std::vector<const Element *> seen; // one that contains itself through a <ref> ends there
    while (!find_plugin<RenderSettings>(type_of(*innermost)) && std::ranges::count(seen, innermost) == 0) {
        const std::vector<NestedObject> nested = nested_objects(*innermost, "integrator", resolve_);
        if (nested.empty())
            break;
        seen.push_back(innermost);
        const auto known = std::ranges::find_if(
            nested, [](const NestedObject &one) { return bool(find_plugin<RenderSettings>(type_of(*one.element))); });
        const NestedObject &kept = known == nested.end() ? nested.front() : *known;
        warn_of_others(nested, kept, diagnostics_);
        innermost = kept.element;
    }
    return *innermost;
}

void SceneBuilder::build_integrator(const Element &element) {
    if (integrator_) {
        diagnostics_.warn(element.location,
                          "a second <integrator> is ignored; the first is at " + integrator_->location.text());
        return;
    }
    integrator_ = &element;
    const Element &paths = innermost_integrator(element);
    const std::string type = type_of(paths);
    if (&paths != &element)
        diagnostics_.warn(element.location, "the integrator \"" + type_of(element) + "\" is passed over: the \"" +
                                                type + "\" that it wraps says what paths are made");
    if (find_plugin<RenderSettings>(type)) {
        scene_.settings = build_object<RenderSettings>(paths);
    } else {
        // Of an integrator that we do not have, the depths still count.
        if (const std::string note = note_on_integrator(type); !note.empty())
            diagnostics_.warn(paths.location, note);
        scene_.settings = read_as<RenderSettings>(paths, "path");
    }
    scene_.settings.integrator = type_of(element);
}

void SceneBuilder::build_sensor(const Element &element) {
    if (sensor_) {
        diagnostics_.warn(element.location,
                          "a second <sensor> is ignored; the first is at " + sensor_->location.text());
        return;
    }
    sensor_ = &element;
    if (const Element *const its_film = the_one_of(nested_objects(element, "film", resolve_), diagnostics_)) {
        const Element &film = *its_film;
        const std::string type = type_of(film);
        if (!type.empty() && !find_plugin<FilmSettings>(type)) {
            // Of a film that we do not have, size, crop and filter still count. One for display loses nothing.
            if (type != "ldrfilm")
                diagnostics_.warn(film.location, "the film \"" + type + "\" is not known here; it is read as hdrfilm");
            scene_.film = read_as<FilmSettings>(film, "hdrfilm");
        } else {
            scene_.film = build_object<FilmSettings>(film);
        }
    }
    check_media(element);
    if (const Element *const sampler = the_one_of(nested_objects(element, "sampler", resolve_), diagnostics_))
        scene_.settings.samples_per_pixel = read_as<SampleCount>(*sampler, "any").count;
    scene_.camera = build_object<Camera>(element);
}

} // namespace gradus
