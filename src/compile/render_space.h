// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/vector.h"

namespace fathom {

/// Map from world space to render space (see kernel/tables.h), in double precision.
struct RenderSpace {
    Vec3d origin;
    double scale = 1;   ///< a power of two
    double radius = 1;  ///< radius of the scene in render space
    Vec3d ball_center;  ///< of a ball that contains the scene, in render space
    double ball_radius = 1;

    Vec3d point(Vec3d world) const { return (world - origin) * scale; }
    Transform from_world() const { return Transform::scale({scale, scale, scale}) * Transform::translate(-origin); }
};

}  // namespace fathom
