// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom {

Color scaled(Color c, double factor);

/// A rotation that maps +z, the direction of lights in pbrt and Mitsuba, to a direction.
Transform rotation_from_z(Vec3d direction);

}  // namespace fathom
