#pragma once
/// Meshes to measure with: read from a PLY file, or generated.
#include <string>

#include "geometry/records.h"

namespace fathom::bench {

struct View {
    Vec3d position, look_at, up{0, 1, 0};
    double x_fov_deg = 60;
};
struct Mesh {
    std::string name;
    GeometryTables tables;
    View view;
};

/// Triangles of a binary little-endian PLY file. The view is read from the file beside it that ends in .json (position,
/// look_at, up, x_fov_degrees), or frames the mesh. Throws std::runtime_error.
Mesh read_ply(const std::string& path);

/// "terrain-N": a height field of about N million triangles; "foliage-N": slivers of leaves, N million; "boulder-N": a
/// rough ball. N may have a point; with N = 0: some ten thousand. Throws std::runtime_error for any other name.
Mesh generate(const std::string& name);

/// As read_ply reads it, with the view beside it. Throws std::runtime_error.
void write_ply(const Mesh& mesh, const std::string& path);

}  // namespace fathom::bench
