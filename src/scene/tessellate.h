#pragma once
#include "fathom/description.h"

namespace fathom {

/// A sphere, disk, rectangle or box as triangles with uv, round ones with normals: for transforms that make an
/// ellipsoid or an ellipse of it, and for displacement. A moving sphere stands at its first place. Other shapes give an
/// empty mesh.
Mesh tessellate(const decltype(Shape::geometry)& geometry);

}  // namespace fathom
