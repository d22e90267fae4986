// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom {

/// Flips triangles whose geometric normal points away from their vertex normals.
void orient_to_normals(Mesh& mesh);

/// Reverses the orientation of all triangles, with their normals.
void flip(Mesh& mesh);

}  // namespace fathom
