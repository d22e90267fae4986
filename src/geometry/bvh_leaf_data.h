#pragma once
/// What leaves of curves, points and moving triangles hold beside the numbers of their primitives.
#include <vector>

#include "geometry/bvh_data.h"
#include "geometry/bvh_split.h"
#include "geometry/curve.h"

namespace fathom::bvh {

/// An item's id of a piece of a curve: its segment's number, and above which of the pieces.
inline constexpr int piece_bits = 5;
static_assert(CurveTable::max_pieces == 1u << piece_bits);
inline std::uint32_t piece_id(std::uint32_t segment, std::uint32_t piece)
{
    return segment << piece_bits | piece;
}

struct PieceEnds {
    CurvePoint<float> a, b, tangent_a, tangent_b;
};
/// linear: whether the segment is a line. The same bits as surfaces and tests find.
PieceEnds piece_ends(const SceneTables& tables, std::uint32_t id, bool linear);

/// The triangles of a leaf of moving ones, each vertex once.
class MovingTriangles {
public:
    explicit MovingTriangles(const SceneTables& tables) : tables_(tables) {}
    /// False, and nothing is added, if there were too many vertices or triangles.
    bool add(BvhKey key);
    /// Appends the leaf.
    void put(std::vector<std::uint32_t>& words) const;

private:
    const SceneTables& tables_;
    int count_ = 0, vertex_count_ = 0;
    BvhKey keys_[bvh_width];
    std::uint8_t corners_[3][bvh_width];
    std::uint32_t vertices_[MovingLeaf::max_vertices];
    /// Of each vertex the triangle that it was first seen of, and which corner.
    std::uint8_t triangle_[MovingLeaf::max_vertices], corner_[MovingLeaf::max_vertices];
};

/// Whether one leaf can hold these items.
bool fit_together(const SceneTables& tables, std::uint32_t kinds, const std::uint32_t* ids, std::size_t n);

/// Appends a leaf of one kind of items; where it begins.
std::size_t put_leaf(const SceneTables& tables, std::uint32_t kind, const std::uint32_t* first_id, std::size_t n,
                     std::vector<std::uint32_t>& words);

}  // namespace fathom::bvh
