// SPDX-License-Identifier: Apache-2.0
#include "lights/environment/studio.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

/// A soft light: a disk of directions whose penumbra is a third of its radius wide.
struct Softbox {
    Vec3d direction;
    double angle, radiance;  ///< radius of the disk in radians; radiance at its center
};

/// Three-point lighting: key light above one side of the camera, dimmer fill light on the other side, rim light from
/// behind. A white surface that faces the camera has a radiance of about 0.9.
constexpr Softbox softboxes[] = {
    {{-0.62, 0.62, 0.62}, 0.48, 4.2}, {{0.9, 0.2, 0.5}, 0.6, 0.7}, {{0.45, 0.5, -0.9}, 0.36, 3.0}};

}  // namespace

double studio_radiance(const Vec3d& d)
{
    // Radiance of the room: darker below, so that shapes are visible.
    double sum = 0.26 + 0.1 * d.y;
    for (const Softbox& box : softboxes) {
        const double off = std::acos(std::clamp(dot(d, normalize(box.direction)), -1.0, 1.0)) / box.angle;
        const double x = std::clamp((1 - off) * 3, 0.0, 1.0);
        sum += box.radiance * x * x * (3 - 2 * x);
    }
    return sum;
}

}  // namespace fathom
