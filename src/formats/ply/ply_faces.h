// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/ply/ply.h"

namespace fathom {

/// Triangulates the polygons and strips of a PLY file. Elements may appear in any order: faces before the vertices are
/// buffered.
class PlyFaces {
public:
    using Corners = std::vector<std::int64_t>;

    /// file  name of the file, for messages
    PlyFaces(const std::string& file, PlyData& data) : file_(file), data_(data) {}

    /// Adds a polygon.
    ///
    /// face   index of the face, for messages
    /// color  color of the face; null if it has none
    void add_polygon(const Corners& corners, std::size_t face, const Vec4f* color);
    /// Adds a triangle strip; -1 restarts the strip.
    void add_strip(const Corners& corners, std::size_t strip);
    /// Adds buffered faces. Must be called after the vertices have been read, and at the end of the file.
    void flush_waiting_faces();
    bool is_waiting() const { return awaits_vertices_; }

    /// Throws Error unless a vertex with this index exists.
    void check_index(std::int64_t index, std::size_t face) const;

private:
    struct Waiting {
        std::size_t first_corner, face;
        Vec4f color;
        bool has_color, is_strip;
    };

    void wait(const Corners& corners, const Waiting& face);
    void triangulate_polygon(const Corners& corners, std::size_t face);

    const std::string& file_;
    PlyData& data_;
    bool awaits_vertices_ = true;
    std::vector<Waiting> waiting_;
    Corners waiting_corners_;
    std::vector<Vec3f> points_;
    std::vector<std::uint32_t> triangles_;
};

}  // namespace fathom
