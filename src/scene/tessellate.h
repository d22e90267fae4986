// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom {

/// Triangle mesh of a sphere, disk, rectangle or box, with uv; spheres and disks have normals. Empty for other shapes.
///
/// Used for transforms that turn a sphere or disk into an ellipsoid or ellipse, and for displacement. A moving sphere
/// is tessellated at its first position.
Mesh tessellate(const decltype(Shape::geometry)& geometry);

}  // namespace fathom
