// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

#include "geometry/shapes/curve_reader.h"

namespace fathom {

/// Finds the ends of pieces of a curve, at one time of the motion.
class SegmentReader {
public:
    /// segment: index in tables.curves. key, fraction: position among tables.vertex_times, as in KeyTime.
    SegmentReader(const GeometryTables& tables, std::uint32_t segment, std::uint32_t key, float fraction)
        : tables_(tables),
          segment_(segment),
          shape_(tables.shapes[tables.shape_of_primitive[tables.first_curve() + segment]]),
          key_(key),
          fraction_(fraction)
    {
    }

    /// Finds the far end of the piece before or behind piece `number` of the segment. That piece may be in an adjacent
    /// segment if the curve continues there. Returns whether there is such a piece.
    bool find_neighbor(std::uint32_t number, bool next, CurvePoint<float>& far_end) const
    {
        const std::uint32_t pieces = tables_.curves[segment_].pieces;
        if (next ? number + 1 < pieces : number > 0) {
            far_end = point_at(segment_, next ? number + 2 : number - 1);
            return true;
        }
        if (next ? segment_ + 1 == tables_.curves.size() : segment_ == 0) return false;
        const std::uint32_t first = next ? segment_ : segment_ - 1;
        if (!are_joined(first)) return false;
        far_end = next ? point_at(first + 1, 1) : point_at(first, tables_.curves[first].pieces - 1);
        return true;
    }

private:
    bool is_linear() const { return shape_.flags & ShapeRecord::linear_curves; }
    /// Whether a segment and the one after it share a control point.
    bool are_joined(std::uint32_t first) const
    {
        return tables_.curves[first + 1].first_point == tables_.curves[first].first_point + (is_linear() ? 1 : 3);
    }
    /// The point after this number of pieces.
    CurvePoint<float> point_at(std::uint32_t segment, std::uint32_t pieces) const
    {
        const CurveRecord& curve = tables_.curves[segment];
        const float t = float(pieces) / float(curve.pieces);
        const std::size_t stride = shape_.moving_vertices, first = curve.first_point + key_ * stride;
        const CurvePoint<float> now = point_at_key(first, t);
        if (stride == 0) return now;
        const CurvePoint<float> then = point_at_key(first + stride, t);
        const auto mean = [&](float a, float b) { return std::fma(b - a, fraction_, a); };
        return {mean(now.x, then.x), mean(now.y, then.y), mean(now.z, then.z), mean(now.r, then.r)};
    }
    CurvePoint<float> point_at_key(std::size_t first, float t) const
    {
        CurvePoint<float> p[4];
        for (std::size_t k = 0; k < (is_linear() ? 2 : 4); ++k) {
            const Vec4f& v = tables_.curve_points[first + k];
            p[k] = {v.x, v.y, v.z, v.w};
        }
        return is_linear() ? between(p[0], p[1], t) : bezier(p, t);
    }

    const GeometryTables& tables_;
    const std::uint32_t segment_;
    const ShapeRecord& shape_;
    const std::uint32_t key_;
    const float fraction_;
};

inline namespace FATHOM_LANES {

/// Pieces of solid curves, one per lane. A ray hits the boundary of the whole curve only, not the parts of a piece that
/// lie inside the adjacent pieces.
class SolidPieces {
public:
    /// segment: index in tables.curves. number: index of the piece in the segment. key, fraction: as in KeyTime.
    ///
    /// Neighbors are found lane by lane: few lanes need them, for which gathers would take longer.
    SolidPieces(const GeometryTables& tables, UInt segment, Float number, const CurvePiece& piece, std::uint32_t key,
                float fraction, Mask m)
    {
        alignas(64) std::uint32_t segments[lanes];
        alignas(64) float numbers[lanes];
        store(segments, segment);
        store(numbers, number);
        FarEnds before, behind;
        for_each_active(m, [&](int lane) {
            const SegmentReader reader(tables, segments[lane], key, fraction);
            const auto own = std::uint32_t(numbers[lane]);
            before.put(lane, reader, own, false);
            behind.put(lane, reader, own, true);
        });
        before_ = {{before.point(), piece.a, before.radius(), piece.ra}, before.present()};
        behind_ = {{piece.b, behind.point(), piece.rb, behind.radius()}, behind.present()};
    }

    /// Lanes whose point is inside the previous or next piece.
    Mask hide(const Vec3& p) const { return before_.contains(p) | behind_.contains(p); }
    /// Lanes whose ray, which passes the piece in the span s, hits it at t > 0. w: position along the piece.
    Mask meet(const RoundSpan& s, const Vec3& o, const Vec3& d, Float& t, Float& w) const
    {
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
    /// Far ends of neighbors, in columns.
    struct FarEnds {
        alignas(64) float x[lanes] = {}, y[lanes] = {}, z[lanes] = {}, r[lanes] = {};
        std::uint32_t found = 0;

        void put(int lane, const SegmentReader& reader, std::uint32_t number, bool next)
        {
            CurvePoint<float> p;
            if (!reader.find_neighbor(number, next, p)) return;
            x[lane] = p.x, y[lane] = p.y, z[lane] = p.z, r[lane] = p.r;
            found |= 1u << lane;
        }
        Vec3 point() const { return load_vec3(x, y, z); }
        Float radius() const { return load(r); }
        Mask present() const { return mask_from_bits(found); }
    };
    struct Neighbor {
        CurvePiece piece;
        Mask is_there;

        Mask contains(const Vec3& p) const { return is_there & is_within_round_piece(piece, p); }
    };

    Neighbor before_, behind_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
