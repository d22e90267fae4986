#pragma once
#include "fathom/description.h"

namespace fathom {

/// A sphere or disk as triangles with normals and uv, for transforms that make an ellipsoid or an ellipse of it. A
/// moving sphere stands at its first place. Other shapes give an empty mesh.
Mesh tessellate(const decltype(Shape::geometry)& geometry);

}  // namespace fathom
