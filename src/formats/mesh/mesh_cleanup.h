// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/description.h"
#include "formats/mesh/mesh_faults.h"

namespace fathom {

/// Repairs defects that don't prevent rendering, and counts each. Indices must be in range.
/// - triangles without area are removed
/// - normals that are not finite or have no length are replaced by the mean normal of adjacent faces
/// - other per-vertex data that is not finite becomes zero
void clean_mesh(Mesh& mesh, const std::string& file, MeshFaults& faults);

}  // namespace fathom
