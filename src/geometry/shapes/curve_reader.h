// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/motion.h"
#include "geometry/shapes/curve.h"

namespace fathom {
inline namespace FATHOM_LANES {

inline CurvePoint<Float> mix(const CurvePoint<Float>& a, const CurvePoint<Float>& b, Float fraction)
{
    return {mix(a.x, b.x, fraction), mix(a.y, b.y, fraction), mix(a.z, b.z, fraction), mix(a.r, b.r, fraction)};
}

/// Reads a curve segment per lane from the tables, bitwise equal to the pieces in the BVH. Where control points move,
/// the ends of pieces at two keys are interpolated.
class CurveReader {
public:
    /// segment: index in tables.curves. shape: the shape of the segment or of the instance. flags: flags of that shape.
    CurveReader(const GeometryTables& tables, UInt segment, UInt shape, UInt flags, Float time, Mask m)
        : CurveReader(tables, segment, shape, flags,
                      tables.vertex_times.empty() ? KeyTime{UInt(0u), Float(0)} : vertex_key(tables, time), m)
    {
    }
    /// time: key time, from vertex_key().
    CurveReader(const GeometryTables& tables, UInt segment, UInt shape, UInt flags, const KeyTime& time, Mask m)
        : tables_(tables), linear_((flags & UInt(ShapeRecord::linear_curves)) != UInt(0u))
    {
        UInt first = gather(tables.curves, &CurveRecord::first_point, segment, m);
        pieces_ = to_float(gather(tables.curves, &CurveRecord::pieces, segment, m));
        if (!tables.vertex_times.empty()) {
            const UInt points = gather(tables.shapes, &ShapeRecord::moving_vertices, shape, m);
            moving_ = m & (points != UInt(0u));
            any_moves_ = any(moving_);
            first = first + time.key * points;
            next_ = first + points;
            fraction_ = time.fraction;
        }
        read(first, m, p_);
    }

    Float pieces() const { return pieces_; }
    /// Index of the piece at u along the segment, in [0, 1].
    Float piece_of(Float u) const { return min(floor(u * pieces_), pieces_ - Float(1)); }
    /// Start point of a piece.
    CurvePoint<Float> begin(Float piece) const
    {
        CurvePoint<Float> p = begin_by(p_, piece);
        if (any_moves_) move_begin(piece, p);
        return p;
    }
    CurvePoint<Float> end(Float piece) const { return begin(piece + Float(1)); }
    /// Tangent of the curve at the start of a piece, not normalized.
    Vec3 tangent(Float piece) const
    {
        CurvePoint<Float> t = tangent_by(p_, piece);
        if (any_moves_) move_tangent(piece, t);
        return {t.x, t.y, t.z};
    }

private:
    void read(UInt first, Mask m, CurvePoint<Float> p[4]) const
    {
        const float* points = reinterpret_cast<const float*>(tables_.curve_points.data());
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Mask has = k < 2 ? m : m & !linear_;
            const UInt place = (first + UInt(k)) << 2;
            p[k] = {gather(points, place, has), gather(points + 1, place, has), gather(points + 2, place, has),
                    gather(points + 3, place, has)};
        }
    }
    CurvePoint<Float> begin_by(const CurvePoint<Float> p[4], Float piece) const
    {
        return chosen(linear_, between(p[0], p[1], piece), bezier(p, piece * (Float(1) / pieces_)));
    }
    CurvePoint<Float> tangent_by(const CurvePoint<Float> p[4], Float piece) const
    {
        const CurvePoint<Float> line{p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z, Float(0)};
        return chosen(linear_, line, bezier_tangent(p, piece * (Float(1) / pieces_)));
    }
    // Interpolation between keys is in functions of its own, so that static curves stay fast.
    [[gnu::noinline]] void move_begin(Float piece, CurvePoint<Float>& p) const
    {
        CurvePoint<Float> next[4];
        read(next_, moving_, next);
        p = chosen(moving_, mix(p, begin_by(next, piece), fraction_), p);
    }
    [[gnu::noinline]] void move_tangent(Float piece, CurvePoint<Float>& t) const
    {
        CurvePoint<Float> next[4];
        read(next_, moving_, next);
        t = chosen(moving_, mix(t, tangent_by(next, piece), fraction_), t);
    }
    static CurvePoint<Float> chosen(Mask m, const CurvePoint<Float>& a, const CurvePoint<Float>& b)
    {
        return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z), select(m, a.r, b.r)};
    }

    const GeometryTables& tables_;
    Mask linear_;
    Float pieces_;
    CurvePoint<Float> p_[4];
    // Values for moving control points: index of the first one at the next key, and the fraction of the way to that
    // key.
    bool any_moves_ = false;
    Mask moving_;
    UInt next_;
    Float fraction_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
