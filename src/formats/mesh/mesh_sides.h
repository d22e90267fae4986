#pragma once
#include "fathom/description.h"

namespace fathom {

/// Turns triangles whose front is not on the side of the normals at their corners.
void turn_to_normals(Mesh& mesh);

}  // namespace fathom
