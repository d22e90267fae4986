#include "camera_text.h"

#include <fmt/format.h>

#include <numbers>

namespace fathom::view {

namespace {

/// Ten digits: enough for any picture, and 40 stays 40.
std::string text(double number)
{
    // Adding 0 makes -0 a 0.
    return fmt::format("{:.10g}", number + 0.0);
}

std::string text(Vec3d v)
{
    return fmt::format("[{}, {}, {}]", text(v.x), text(v.y), text(v.z));
}

}  // namespace

std::string camera_text(const Camera& camera)
{
    std::string members = fmt::format("\"position\": {}, \"look_at\": {}, \"up\": {}", text(camera.position),
                                      text(camera.look_at), text(camera.up));
    if (camera.kind == CameraKind::orthographic) {
        members = "\"kind\": \"orthographic\", " + members + fmt::format(", \"height\": {}", text(camera.height));
    } else if (camera.kind != CameraKind::perspective) {
        const bool equal = camera.kind == CameraKind::equal_area;
        members = fmt::format("\"kind\": \"{}\", ", equal ? "equal-area" : "spherical") + members;
    } else {
        members += fmt::format(", \"fov_y_deg\": {}", text(camera.fov_y * 180 / std::numbers::pi));
        if (camera.aperture > 0) members += fmt::format(", \"aperture\": {}", text(camera.aperture));
        if (camera.focus_distance > 0) members += fmt::format(", \"focus_distance\": {}", text(camera.focus_distance));
    }
    if (camera.shift_x != 0 || camera.shift_y != 0)
        members += fmt::format(", \"shift\": [{}, {}]", text(camera.shift_x), text(camera.shift_y));
    if (camera.shutter_open != 0 || camera.shutter_close != 0)
        members += fmt::format(", \"shutter\": [{}, {}]", text(camera.shutter_open), text(camera.shutter_close));
    return "\"camera\": {" + members + "}";
}

}  // namespace fathom::view
