// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Parameters of the displacement of a mesh.
struct Displacement {
    /// Minimum number of parts of the edge between two vertices.
    std::function<double(const Mesh& mesh, std::uint32_t a, std::uint32_t b)> parts;
    /// Whether edges may have fewer parts: by a factor of up to the square root of 2, and more where the triangles
    /// would exceed max_displaced_triangles.
    bool may_be_coarser = false;
    /// Computes the heights of vertices [begin, end).
    std::function<void(const Mesh& mesh, std::size_t begin, std::size_t end, float* heights)> heights;
};

/// Limit on the triangles of meshes that may be coarser.
inline constexpr double max_displaced_triangles = 1 << 23;

/// Result of displace().
struct Displaced {
    Mesh mesh;
    double wanted_triangles = 0;  ///< number of triangles before max_displaced_triangles was applied
};

/// Subdivides a mesh and displaces it along its normals.
///
/// Vertices at one position stay together, even at seams and hard edges: they move along the mean of their normals by
/// the mean of their heights. Each normal is rotated as the surface around it was, which keeps smooth edges smooth and
/// hard edges hard. The result does not depend on the number of threads.
///
/// Throws Error, with `name` as its place, if the result is too large for the memory.
Displaced displace(const Mesh& mesh, const Displacement& by, const std::string& file, const std::string& name);

}  // namespace fathom
