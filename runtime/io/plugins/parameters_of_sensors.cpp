#include "runtime/io/plugins/parameters_of_sensors.h"

#include "runtime/io/text.h"

#include <cmath>

namespace gradus {

namespace {

Camera::FovAxis read_axis(Properties &properties) {
    const std::string name = lower_case(properties.string("fov_axis", "x"));
    if (name == "x")
        return Camera::FovAxis::x;
    if (name == "y")
        return Camera::FovAxis::y;
    if (name == "smaller")
        return Camera::FovAxis::smaller;
    if (name == "larger")
        return Camera::FovAxis::larger;
    if (name == "diagonal")
        return Camera::FovAxis::diagonal;
    throw properties.error("fov_axis", "unknown fov_axis \"" + name + "\" (known: x, y, smaller, larger, diagonal)");
}

/// The diagonal field of view, in degrees, behind a lens on 35 mm film (36 x 24 mm).
double fov_of_lens(Properties &properties) {
    std::string text = properties.string("focal_length", "50mm");
    if (text.size() > 2 && text.substr(text.size() - 2) == "mm")
        text.resize(text.size() - 2);
    const std::optional<double> millimetres = parse_number(text);
    if (!millimetres || *millimetres <= 0)
        throw properties.error("focal_length", "\"focal_length\" needs a length like 50mm, not \"" + text + "\"");
    const double half_diagonal = std::hypot(36.0, 24.0) / 2;
    return 2 * std::atan(half_diagonal / *millimetres) * (180 / 3.14159265358979323846);
}

} // namespace

void read_camera(Properties &properties, Camera &camera) {
    camera.to_world = properties.transform("to_world");
    if (!(std::fabs(determinant(camera.to_world)) > 1e-30))
        throw properties.error("to_world", "the camera's to_world has no inverse");
    camera.near_clip = properties.number("near_clip", 0.01);
    camera.far_clip = properties.number("far_clip", 10000);
    if (!(camera.near_clip > 0 && camera.far_clip > camera.near_clip)) {
        properties.diagnostics().warn(properties.location_of(properties.has("near_clip") ? "near_clip" : "far_clip"),
                                      "near_clip and far_clip are not in order, or not above 0, and are ignored");
        camera.near_clip = 0;
        camera.far_clip = 1e30;
    }
    properties.ignore({"shutter_open", "shutter_close"});
    for (const char *attachment : {"film", "sampler", "medium"})
        properties.objects(attachment);
}

void read_field_of_view(Properties &properties, Camera &camera) {
    if (properties.has("fov")) {
        if (properties.has("focal_length"))
            throw properties.error("focal_length", "give a camera's fov or its focal_length, not both");
        camera.fov = properties.number("fov", 0);
        if (!(camera.fov > 0 && camera.fov < 180))
            throw properties.error("fov", "\"fov\" must be between 0 and 180 degrees");
        camera.fov_axis = read_axis(properties);
    } else {
        camera.fov = fov_of_lens(properties);
        camera.fov_axis = Camera::FovAxis::diagonal;
        properties.ignore({"fov_axis"});
    }
}

} // namespace gradus
