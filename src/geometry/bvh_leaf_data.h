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

/// Appends a leaf of one kind of items; where it begins.
std::size_t put_leaf(const SceneTables& tables, const Item* items, std::size_t n, std::vector<std::uint32_t>& words);

}  // namespace fathom::bvh
