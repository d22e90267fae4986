// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contents of leaves in BvhData::others besides the ids of their primitives.
#include <array>
#include <vector>

#include "geometry/bvh/builder/split.h"
#include "geometry/bvh/layout/data.h"
#include "geometry/shapes/curve.h"

namespace fathom::bvh {

/// Item id of a curve piece: the number of its segment, and the number of the piece in the low bits.
inline constexpr int piece_bits = 5;
static_assert(CurveRecord::max_pieces == 1u << piece_bits);
inline std::uint32_t piece_id(std::uint32_t segment, std::uint32_t piece)
{
    return segment << piece_bits | piece;
}

/// End points and tangents of a curve piece.
struct PieceEnds {
    CurvePoint<float> a, b, tangent_a, tangent_b;
};
/// Ends of a curve piece, bitwise equal to those that intersection and surfaces compute. linear: whether the segment is
/// straight. key: index of vertex_times for moving segments.
PieceEnds piece_ends(const GeometryTables& tables, std::uint32_t id, bool linear, std::size_t key = 0);
/// Bounds of the cone-sphere of a piece: the balls at both ends and everything between.
Box box_of(const PieceEnds& ends);
/// The shape that a segment belongs to.
const ShapeRecord& shape_of_segment(const GeometryTables& tables, std::uint32_t segment);

/// Builder of an indexed leaf, which stores each vertex once.
class IndexedTriangles {
public:
    /// moving: whether the triangles move; all or none do.
    IndexedTriangles(const GeometryTables& tables, bool moving) : tables_(tables), moving_(moving) {}
    /// Adds a triangle; returns false without any change if there would be too many vertices or triangles.
    bool add(BvhKey key);
    /// Number of words that put() appends.
    std::size_t words() const;
    /// Appends the leaf; returns the index of its first word.
    std::size_t put(std::vector<std::uint32_t>& words) const;

private:
    /// Identity of a vertex. Static vertices compare by the bits of their coordinates, since meshes may repeat a vertex
    /// with other normals. Moving vertices compare by index, since distinct ones may coincide at one time only.
    using Vertex = std::array<std::uint32_t, 3>;
    Vertex vertex(BvhKey key, int corner, const Vec3f& position) const;
    std::size_t times() const { return moving_ ? tables_.vertex_times.size() : 1; }

    const GeometryTables& tables_;
    const bool moving_;
    int count_ = 0, vertex_count_ = 0;
    BvhKey keys_[bvh_width];
    std::uint8_t corners_[3][bvh_width];
    Vertex vertices_[IndexedLeaf::max_vertices];
    /// The triangle and corner where each vertex first occurred.
    std::uint8_t triangle_[IndexedLeaf::max_vertices], corner_[IndexedLeaf::max_vertices];
};

/// Whether one leaf can hold these items.
bool fit_together(const GeometryTables& tables, std::uint32_t kinds, const std::uint32_t* ids, std::size_t n);

/// Appends a leaf with items of one kind; returns the index of its first word.
std::size_t put_leaf(const GeometryTables& tables, std::uint32_t kind, const std::uint32_t* first_id, std::size_t n,
                     std::vector<std::uint32_t>& words);

}  // namespace fathom::bvh
