#pragma once
/// What leaves in BvhData::others hold beside the numbers of their primitives.
#include <array>
#include <vector>

#include "geometry/bvh/builder/split.h"
#include "geometry/bvh/layout/data.h"
#include "geometry/shapes/curve.h"

namespace fathom::bvh {

/// An item's id of a piece of a curve: its segment's number, and above which of the pieces.
inline constexpr int piece_bits = 5;
static_assert(CurveRecord::max_pieces == 1u << piece_bits);
inline std::uint32_t piece_id(std::uint32_t segment, std::uint32_t piece)
{
    return segment << piece_bits | piece;
}

struct PieceEnds {
    CurvePoint<float> a, b, tangent_a, tangent_b;
};
/// linear: whether the segment is a line. key: which of vertex_times, if it moves. The same bits as surfaces and tests
/// find.
PieceEnds piece_ends(const GeometryTables& tables, std::uint32_t id, bool linear, std::size_t key = 0);
/// Around the balls at both ends and all between them.
Box box_of(const PieceEnds& ends);
/// The shape of a segment.
const ShapeRecord& shape_of_segment(const GeometryTables& tables, std::uint32_t segment);

/// The triangles of a leaf that holds each vertex once.
class IndexedTriangles {
public:
    /// moving  whether they do; all or none
    IndexedTriangles(const GeometryTables& tables, bool moving) : tables_(tables), moving_(moving) {}
    /// False, and nothing is added, if there were too many vertices or triangles.
    bool add(BvhKey key);
    /// What put adds.
    std::size_t words() const;
    /// Appends the leaf; where it begins.
    std::size_t put(std::vector<std::uint32_t>& words) const;

private:
    /// Which vertex it is: of those that stand still their coordinates' bits, as meshes may have a vertex several
    /// times, with other normals. Those that move may meet for once: by number.
    using Vertex = std::array<std::uint32_t, 3>;
    Vertex vertex(BvhKey key, int corner, const Vec3f& position) const;
    std::size_t times() const { return moving_ ? tables_.vertex_times.size() : 1; }

    const GeometryTables& tables_;
    const bool moving_;
    int count_ = 0, vertex_count_ = 0;
    BvhKey keys_[bvh_width];
    std::uint8_t corners_[3][bvh_width];
    Vertex vertices_[IndexedLeaf::max_vertices];
    /// Of each vertex the triangle that it was first seen of, and which corner.
    std::uint8_t triangle_[IndexedLeaf::max_vertices], corner_[IndexedLeaf::max_vertices];
};

/// Whether one leaf can hold these items.
bool fit_together(const GeometryTables& tables, std::uint32_t kinds, const std::uint32_t* ids, std::size_t n);

/// Appends a leaf of one kind of items; where it begins.
std::size_t put_leaf(const GeometryTables& tables, std::uint32_t kind, const std::uint32_t* first_id, std::size_t n,
                     std::vector<std::uint32_t>& words);

}  // namespace fathom::bvh
