// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom {

/// Weight of a face in the normals of its vertices: its area, as in pbrt, or its angle at the vertex, as in Mitsuba
/// (G. Thuermer, C. A. Wuethrich, "Computing Vertex Normals from Polygonal Facets", 1998).
enum class NormalWeight { area, angle };

/// Sets the normals of vertices to weighted means of their faces' normals.
void set_vertex_normals(Mesh& mesh, NormalWeight weight);

}  // namespace fathom
