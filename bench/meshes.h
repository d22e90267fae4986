// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Meshes for measurements: read from a PLY file, or generated.
#include <string>

#include "geometry/records.h"

namespace fathom::bench {

/// A camera that looks at a mesh.
struct View {
    Vec3d position, look_at, up{0, 1, 0};
    double x_fov_deg = 60;
};
/// A triangle mesh in geometry tables, and the camera view from which it is measured.
struct Mesh {
    std::string name;
    GeometryTables tables;
    View view;
};

/// Reads the triangles of a binary little-endian PLY file. The view is read from the file beside it that ends in .json
/// (position, look_at, up, x_fov_degrees), or frames the mesh. Throws std::runtime_error.
Mesh read_ply(const std::string& path);

/// Generates "terrain-N", a height field of about N million triangles; "foliage-N", slivers of leaves; or "boulder-N",
/// a rough ball. N may have a decimal point; N = 0 gives some ten thousand triangles. Throws std::runtime_error for
/// other names.
Mesh generate(const std::string& name);

/// Writes a mesh and its view in the format of read_ply. Throws std::runtime_error.
void write_ply(const Mesh& mesh, const std::string& path);

}  // namespace fathom::bench
