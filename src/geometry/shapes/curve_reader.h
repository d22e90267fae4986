#pragma once
#include "geometry/records.h"
#include "geometry/shapes/curve.h"
#include "math/gather_member.h"

namespace fathom::inline FATHOM_LANES {

/// A segment of a curve of each lane of the mask, from the tables, to the bits that the tree has of its pieces.
class CurveReader {
public:
    /// segment: in tables.curves. flags: of its shape.
    CurveReader(const GeometryTables& tables, UInt segment, UInt flags, Mask m)
        : linear_((flags & UInt(ShapeRecord::linear_curves)) != UInt(0u))
    {
        const UInt first = gather(tables.curves, &CurveRecord::first_point, segment, m);
        pieces_ = to_float(gather(tables.curves, &CurveRecord::pieces, segment, m));
        const float* points = reinterpret_cast<const float*>(tables.curve_points.data());
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Mask has = k < 2 ? m : m & !linear_;
            const UInt place = (first + UInt(k)) << 2;
            p_[k] = {gather(points, place, has), gather(points + 1, place, has), gather(points + 2, place, has),
                     gather(points + 3, place, has)};
        }
    }

    Float pieces() const { return pieces_; }
    /// The piece at u along the segment, in [0, 1].
    Float piece_of(Float u) const { return min(floor(u * pieces_), pieces_ - Float(1)); }
    /// Where a piece begins.
    CurvePoint<Float> begin(Float piece) const
    {
        return chosen(between(p_[0], p_[1], piece), bezier(p_, piece * (Float(1) / pieces_)));
    }
    CurvePoint<Float> end(Float piece) const { return begin(piece + Float(1)); }
    /// Along the curve where a piece begins, of any length.
    Vec3 tangent(Float piece) const
    {
        const CurvePoint<Float> line{p_[1].x - p_[0].x, p_[1].y - p_[0].y, p_[1].z - p_[0].z, Float(0)};
        const CurvePoint<Float> t = chosen(line, bezier_tangent(p_, piece * (Float(1) / pieces_)));
        return {t.x, t.y, t.z};
    }

private:
    CurvePoint<Float> chosen(const CurvePoint<Float>& line, const CurvePoint<Float>& cubic) const
    {
        return {select(linear_, line.x, cubic.x), select(linear_, line.y, cubic.y), select(linear_, line.z, cubic.z),
                select(linear_, line.r, cubic.r)};
    }

    Mask linear_;
    Float pieces_;
    CurvePoint<Float> p_[4];
};

}  // namespace fathom::inline FATHOM_LANES
