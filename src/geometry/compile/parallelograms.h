#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

struct Parallelograms {
    std::vector<Rectangle> found;          ///< edges need not be perpendicular; normals are those of the triangles
    std::vector<std::uint32_t> triangles;  ///< indices of the triangles that are left
};

/// Whether the normals of all triangles are those of their planes.
bool has_flat_normals(const Mesh& mesh);

/// Pairs triangles that make a parallelogram: one primitive to trace instead of two. For meshes of a few dozen
/// triangles.
Parallelograms pair_triangles(const Mesh& mesh);

}  // namespace fathom
