#pragma once
#include <string>

#include "fathom/description.h"
#include "formats/mesh/mesh_faults.h"

namespace fathom {

/// Mends what files get wrong and a picture can do without, each counted as a fault: triangles without area are
/// left out; normals that are not finite or have no length are replaced by those of the faces around; other per-vertex
/// data that is not finite becomes zero. Indices must be in range.
void clean_mesh(Mesh& mesh, const std::string& file, MeshFaults& faults);

}  // namespace fathom
