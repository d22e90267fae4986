// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "fathom/vector.h"
#include "kernel/kernel.h"

namespace fathom {

/// Position of a point of render space in the image of a camera, seen from the middle of its lens: in pixels, with y
/// growing downwards. NaN behind the camera. Spherical cameras map directions equirectangularly.
inline std::array<double, 2> image_place(const CameraRecord& camera, double width, double height, const Vec3d& p)
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const auto vector = [](const float(&a)[3]) { return Vec3d{a[0], a[1], a[2]}; };
    const Vec3d to = p - vector(camera.position);
    const double x = dot(to, vector(camera.right)), y = dot(to, vector(camera.up)), z = dot(to, vector(camera.forward));
    if (camera.spherical) {
        const double phi = std::atan2(-x, -z) / (2 * std::numbers::pi);
        const double theta = std::acos(std::clamp(y / length(to), -1.0, 1.0));
        return {(phi - std::floor(phi)) * width, theta / std::numbers::pi * height};
    }
    if (!(z > 0)) return {nan, nan};
    const double scale = camera.orthographic ? 1 : 1 / z;
    const double sx = (x * scale - camera.shift_right) / camera.half_width;
    const double sy = (y * scale - camera.shift_up) / camera.half_height;
    return {(0.5 + 0.5 * sx) * width, (0.5 - 0.5 * sy) * height};
}

}  // namespace fathom
