#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Gives each triangle a colour of its own: vertices between triangles of different ones are doubled.
/// colors  as many as triangles
void color_faces(Mesh& mesh, const std::vector<Vec4f>& colors);

}  // namespace fathom
