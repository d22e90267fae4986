// SPDX-License-Identifier: Apache-2.0
#include "formats/ply/ply_faces.h"

#include <fmt/format.h>

#include "fathom/error.h"
#include "formats/mesh/polygon.h"

namespace fathom {

namespace {

constexpr Vec4f white{1, 1, 1, 1};

}  // namespace

void PlyFaces::check_index(std::int64_t index, std::size_t face) const
{
    const std::size_t vertices = data_.mesh.positions.size();
    if (index < 0 || std::size_t(index) >= vertices)
        throw Error(file_, fmt::format("face {}", face),
                    fmt::format("vertex {} is out of range: there are {}", index, vertices));
}

void PlyFaces::add_polygon(const Corners& corners, std::size_t face, const Vec4f* color)
{
    if (awaits_vertices_) return wait(corners, {0, face, color ? *color : white, color != nullptr, false});
    const std::vector<std::uint32_t>& indices = data_.mesh.indices;
    // Faces before the first colored one become white.
    if (color) data_.face_colors.resize(indices.size() / 3, white);
    triangulate_polygon(corners, face);
    if (color) data_.face_colors.resize(indices.size() / 3, *color);
}

void PlyFaces::triangulate_polygon(const Corners& corners, std::size_t face)
{
    for (const std::int64_t index : corners) check_index(index, face);
    if (corners.size() < 3) {
        ++data_.bad_faces;
        return;
    }
    Mesh& mesh = data_.mesh;
    points_.clear();
    for (const std::int64_t index : corners) points_.push_back(mesh.positions[std::size_t(index)]);
    triangles_.clear();
    triangulate(points_, triangles_);
    if (corners.size() == 4) data_.quads.push_back(std::uint32_t(mesh.indices.size() / 3));
    for (const std::uint32_t k : triangles_) mesh.indices.push_back(std::uint32_t(corners[k]));
}

void PlyFaces::add_strip(const Corners& corners, std::size_t strip)
{
    if (awaits_vertices_) return wait(corners, {0, strip, white, false, true});
    std::vector<std::uint32_t>& indices = data_.mesh.indices;
    std::size_t start = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        if (corners[k] == -1) {
            start = k + 1;
            continue;
        }
        check_index(corners[k], strip);
        if (k < start + 2) continue;
        std::uint32_t a = std::uint32_t(corners[k - 2]), b = std::uint32_t(corners[k - 1]);
        if ((k - start) % 2 == 1) std::swap(a, b);
        const std::uint32_t c = std::uint32_t(corners[k]);
        if (a != b && b != c && c != a) indices.insert(indices.end(), {a, b, c});
    }
}

void PlyFaces::wait(const Corners& corners, const Waiting& face)
{
    waiting_.push_back(face);
    waiting_.back().first_corner = waiting_corners_.size();
    waiting_corners_.insert(waiting_corners_.end(), corners.begin(), corners.end());
}

void PlyFaces::flush_waiting_faces()
{
    awaits_vertices_ = false;
    Corners corners;
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        const Waiting& face = waiting_[i];
        const std::size_t end = i + 1 < waiting_.size() ? waiting_[i + 1].first_corner : waiting_corners_.size();
        corners.assign(waiting_corners_.begin() + std::ptrdiff_t(face.first_corner),
                       waiting_corners_.begin() + std::ptrdiff_t(end));
        if (face.is_strip)
            add_strip(corners, face.face);
        else
            add_polygon(corners, face.face, face.has_color ? &face.color : nullptr);
    }
    waiting_ = {};
    waiting_corners_ = {};
}

}  // namespace fathom
