// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/shapes/curve_reader.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Pieces of solid curves, one per lane. A ray hits the boundary of the whole curve only, not the parts of a piece that
/// lie inside the adjacent pieces.
class SolidPieces {
public:
    /// segment: index in tables.curves. number: index of the piece in the segment. time: key time, from vertex_key().
    SolidPieces(const GeometryTables& tables, UInt segment, Float number, const KeyTime& time, Mask m)
        : before_(neighbor(tables, segment, number, time, false, m)),
          behind_(neighbor(tables, segment, number, time, true, m))
    {
    }

    /// Lanes whose point is inside the previous or next piece.
    Mask hide(const Vec3& p) const { return within(before_, p) | within(behind_, p); }
    /// Lanes whose ray hits the piece at t > 0. w: position along the piece.
    Mask meet(const CurvePiece& piece, const Vec3& o, const Vec3& d, Float& t, Float& w) const
    {
        const RoundSpan s = span_of_round_piece(piece, o, d);
        const auto shows = [&](Float at) {
            const Vec3 p = fma(d, at, o);
            return s.met & (at > Float(0)) & !hide(p);
        };
        const Mask enters = shows(s.t_in), leaves = shows(s.t_out);
        t = select(enters, s.t_in, s.t_out);
        w = select(enters, s.w_in, s.w_out);
        return enters | leaves;
    }

private:
    struct Neighbor {
        CurvePiece piece;
        Mask is_there;
    };
    static Mask within(const Neighbor& n, const Vec3& p) { return n.is_there & is_within_round_piece(n.piece, p); }

    /// The next or previous piece; it may be in an adjacent segment if the curve continues there, which then shares a
    /// control point.
    static Neighbor neighbor(const GeometryTables& tables, UInt segment, Float number, const KeyTime& time, bool next,
                             Mask m)
    {
        const UInt count(std::uint32_t(tables.curves.size()));
        const Float pieces = to_float(gather(tables.curves, &CurveRecord::pieces, segment, m));
        const Float wanted = number + Float(next ? 1.f : -1.f);
        const Mask here = m & (wanted >= Float(0)) & (wanted < pieces);
        const Mask exists = m & (next ? less(segment + UInt(1u), count) : less(UInt(0u), segment));
        const UInt other = select(exists, next ? segment + UInt(1u) : segment - UInt(1u), segment);
        const UInt shape = gather(tables.shape_of_primitive.data(), segment + UInt(tables.first_curve()), m);
        const UInt flags = gather(tables.shapes, &ShapeRecord::flags, shape, m);
        const UInt stride = select((flags & UInt(ShapeRecord::linear_curves)) != UInt(0u), UInt(1u), UInt(3u));
        const UInt own = gather(tables.curves, &CurveRecord::first_point, segment, m),
                   others = gather(tables.curves, &CurveRecord::first_point, other, m);
        const Mask joined = exists & !here & (next ? others == own + stride : own == others + stride);
        const Mask is_there = here | joined;
        const CurveReader curve(tables, select(here, segment, other), shape, flags, time, is_there);
        const Float place = select(here, wanted, next ? Float(0) : curve.pieces() - Float(1));
        const CurvePoint<Float> a = curve.begin(place), b = curve.end(place);
        return {{{a.x, a.y, a.z}, {b.x, b.y, b.z}, a.r, b.r}, is_there};
    }

    Neighbor before_, behind_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
