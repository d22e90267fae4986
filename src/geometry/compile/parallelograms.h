// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Result of pair_triangles().
struct Parallelograms {
    std::vector<Rectangle> found;          ///< edges need not be perpendicular; normals are those of the triangles
    std::vector<std::uint32_t> triangles;  ///< vertex indices of the triangles that are left
};

/// Whether all vertex normals equal the normals of their triangles' planes.
bool has_flat_normals(const Mesh& mesh);

/// Merges pairs of triangles that form a parallelogram, which halves the primitives to trace. Quadratic time: for
/// meshes of a few dozen triangles.
Parallelograms pair_triangles(const Mesh& mesh);

}  // namespace fathom
