// SPDX-License-Identifier: Apache-2.0
#include "camera_text.h"

#include <fmt/format.h>

#include <numbers>

namespace fathom::view {

namespace {

/// Ten digits are precise enough, and print 40 as 40.
std::string number_text(double number)
{
    // Adding 0 turns -0 into 0.
    return fmt::format("{:.10g}", number + 0.0);
}

std::string vector_text(Vec3d v)
{
    return fmt::format("[{}, {}, {}]", number_text(v.x), number_text(v.y), number_text(v.z));
}

}  // namespace

std::string camera_text(const Camera& camera)
{
    std::string members = fmt::format("\"position\": {}, \"look_at\": {}, \"up\": {}", vector_text(camera.position),
                                      vector_text(camera.look_at), vector_text(camera.up));
    if (camera.kind == CameraKind::orthographic) {
        members =
            "\"kind\": \"orthographic\", " + members + fmt::format(", \"height\": {}", number_text(camera.height));
    } else if (camera.kind != CameraKind::perspective) {
        const bool equal = camera.kind == CameraKind::equal_area;
        members = fmt::format("\"kind\": \"{}\", ", equal ? "equal-area" : "spherical") + members;
    } else {
        members += fmt::format(", \"fov_y_deg\": {}", number_text(camera.fov_y * 180 / std::numbers::pi));
        if (camera.aperture > 0) members += fmt::format(", \"aperture\": {}", number_text(camera.aperture));
        if (camera.focus_distance > 0)
            members += fmt::format(", \"focus_distance\": {}", number_text(camera.focus_distance));
    }
    if (camera.shift_x != 0 || camera.shift_y != 0)
        members += fmt::format(", \"shift\": [{}, {}]", number_text(camera.shift_x), number_text(camera.shift_y));
    if (camera.shutter_open != 0 || camera.shutter_close != 0)
        members +=
            fmt::format(", \"shutter\": [{}, {}]", number_text(camera.shutter_open), number_text(camera.shutter_close));
    return "\"camera\": {" + members + "}";
}

}  // namespace fathom::view
