// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Gives each triangle a color; vertices shared by triangles of different colors are duplicated.
///
/// colors  one color for each triangle
void set_face_colors(Mesh& mesh, const std::vector<Vec4f>& colors);

}  // namespace fathom
