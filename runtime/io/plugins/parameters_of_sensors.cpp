#include "runtime/io/plugins/parameters_of_sensors.h"

#include "runtime/io/text.h"
#include "runtime/scene/instances.h"

#include <cmath>
#include <numbers>

namespace gradus {

namespace {

constexpr double no_far_clip = 1e30;

Camera::FovAxis read_axis(Properties &properties) {
    const std::string name = properties.choice("fov_axis");
    if (name == "x")
        return Camera::FovAxis::x;
    if (name == "y")
        return Camera::FovAxis::y;
    if (name == "smaller")
        return Camera::FovAxis::smaller;
    if (name == "larger")
        return Camera::FovAxis::larger;
    return Camera::FovAxis::diagonal;
}

/// The diagonal field of view, in degrees, behind a lens on 35 mm film (36 x 24 mm).
double fov_of_lens(Properties &properties) {
    std::string text = properties.string("focal_length");
    if (text.size() > 2 && text.substr(text.size() - 2) == "mm")
        text.resize(text.size() - 2);
    const std::optional<double> millimetres = parse_number(text);
    if (!millimetres || *millimetres <= 0)
        throw properties.error("focal_length", "\"focal_length\" needs a length like 50mm, not \"" + text + "\"");
    const double half_diagonal = std::hypot(36.0, 24.0) / 2;
    return 2 * std::atan(half_diagonal / *millimetres) * (180 / std::numbers::pi);
}

} // namespace

ParameterList parameters_of_camera() {
    return joined(
        {{{"to_world", Takes::transform, nullptr, "from a camera at the origin that looks along +z, +y up"},
          Parameter{"near_clip", Takes::number, "0.01", "what is nearer along the line of sight is not seen"}.in(
              "lengths"),
          Parameter{"far_clip", Takes::number, "10000",
                    "what is farther is not seen, nor through holes of a mask; or inf"}
              .in("lengths"),
          {"film", Takes::objects, nullptr, "one"},
          {"sampler", Takes::objects, nullptr, "one"},
          {"medium", Takes::objects, nullptr, "an error, or left out"}},
         meaningless({"shutter_open", "shutter_close"})});
}

ParameterList parameters_of_field_of_view() {
    return {
        Parameter{"fov", Takes::number, nullptr, "field of view; not beside focal_length"}.in("degrees").or_else(
            "by focal_length"),
        Parameter{"fov_axis", Takes::choice, "x", "what fov is along"}.of({"x", "y", "smaller", "larger", "diagonal"}),
        {"focal_length", Takes::string, "50mm", "of a lens on 35 mm film, whose diagonal counts"}};
}

void read_camera(Properties &properties, Camera &camera) {
    camera.to_world = properties.transform("to_world");
    if (!is_invertible(camera.to_world))
        throw properties.error("to_world", "the camera's to_world has no inverse");
    camera.near_clip = properties.number("near_clip");
    const bool sees_all = lower_case(properties.written("far_clip")) == "inf";
    camera.far_clip = sees_all ? no_far_clip : properties.number("far_clip");
    if (!(camera.near_clip > 0 && camera.far_clip > camera.near_clip)) {
        properties.diagnostics().warn(properties.location_of(properties.has("near_clip") ? "near_clip" : "far_clip"),
                                      "near_clip and far_clip are not in order, or not above 0, and are ignored");
        camera.near_clip = 0;
        camera.far_clip = no_far_clip;
    }
}

void read_field_of_view(Properties &properties, Camera &camera) {
    const Camera::FovAxis axis = read_axis(properties);
    if (properties.has("fov")) {
        if (properties.has("focal_length"))
            throw properties.error("focal_length", "give a camera's fov or its focal_length, not both");
        camera.fov = properties.number("fov");
        if (!(camera.fov > 0 && camera.fov < 180))
            throw properties.error("fov", "\"fov\" must be between 0 and 180 degrees");
        camera.fov_axis = axis;
    } else {
        camera.fov = fov_of_lens(properties);
        camera.fov_axis = Camera::FovAxis::diagonal;
    }
}

} // namespace gradus
