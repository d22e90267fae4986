#pragma once
#include <functional>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// What displaces a mesh.
struct Displacement {
    /// Into how many parts the edge between two vertices is to be cut at least.
    std::function<double(const Mesh& mesh, std::uint32_t a, std::uint32_t b)> parts;
    /// Fewer will do, to a factor of the square root of 2 and where triangles would be too many.
    bool may_be_coarser = false;
    /// The heights of vertices [begin, end).
    std::function<void(const Mesh& mesh, std::size_t begin, std::size_t end, float* heights)> heights;
};

/// More than that nothing is cut into that may be coarser.
inline constexpr double max_displaced_triangles = 1 << 23;

struct Displaced {
    Mesh mesh;
    double wanted_triangles = 0;  ///< as many as it has, unless they were too many
};

/// The mesh, cut finer and moved along its normals by heights.
///
/// Vertices that stand at one place stay together: they move along the mean of their normals by the mean of their
/// heights, whatever is a seam or a hard edge there. New normals are the old ones, turned as the surface was; so what
/// looked round does, and an edge that was hard is. The same bits for any number of threads.
///
/// Throws Error with `name` as its place if there isn't the memory.
Displaced displace(const Mesh& mesh, const Displacement& by, const std::string& file, const std::string& name);

}  // namespace fathom
