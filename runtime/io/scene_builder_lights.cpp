// Emitters of a scene file: those of their own and those of shapes.
#include "runtime/io/absent_plugins.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/scene_builder.h"

namespace gradus {

void SceneBuilder::build_emitter(const Element &element) {
    const std::string type = type_of(element);
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

std::int32_t SceneBuilder::emitter_of(const Element &shape) {
    const std::vector<NestedObject> emitters = nested_objects(shape, "emitter", resolve_);
    if (emitters.empty())
        return -1;
    if (emitters.size() > 1)
        throw SceneError(emitters[1].location, "a shape has one emitter; this is its second");
    const Element &element = *emitters.front().element;
    const std::string type = type_of(element);
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
