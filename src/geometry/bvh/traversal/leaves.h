#pragma once
/// One ray against a leaf of something other than triangles: lanes are primitives.
#include "geometry/bvh/traversal/ray.h"
#include "geometry/shapes/solid_curve.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Numbers of the primitives from the at-th on; the last is repeated.
inline UInt ids_from(const BvhLeaf& leaf, int at)
{
    alignas(64) std::uint32_t id[lanes];
    for (int i = 0; i < lanes; ++i) id[i] = leaf.ids()[std::min(at + i, leaf.count() - 1)];
    return load(id);
}
/// Their k-th array; past the last anything.
inline Float array_from(const BvhLeaf& leaf, int k, int at)
{
    return load(leaf.data() + k * leaf.count() + at);
}

/// A ray as leaves of round things want it: with a direction of length 1, which it does not have in the space of what
/// an instance places.
struct LeafRay {
    Vec3 o, d;
    Float scale, inverse_scale;  ///< of distances here to those of the ray
    Float time;
    /// As in RayTimes, where anything moves.
    std::uint32_t key = 0;
    float fraction = 0;

    LeafRay(const PreparedRay& ray, bool placed)
        : o(ray.vector(PreparedRays::origin_x)),
          d(ray.vector(PreparedRays::direction_x)),
          scale(1.f),
          inverse_scale(1.f),
          time(ray.number(PreparedRays::time))
    {
        if (!placed) return;
        scale = length(d);
        inverse_scale = Float(1) / scale;
        d = d * inverse_scale;
    }
};

/// Each calls offer(at, m, t, u, v) for lanes that are hit, at any distance, at being the number of the first lane in
/// the leaf, until it returns true for any_hit. True if any call did.
template <bool any_hit, class Meet, class Offer>
bool intersect_all(int n, const LeafRay& ray, const Meet& meet, const Offer& offer)
{
    bool found = false;
    for (int at = 0; at < n; at += lanes) {
        Float t, u(0.f), v(0.f);
        const Mask m = meet(at, t, u, v) & first_lanes(std::size_t(n - at));
        found |= any(m) && offer(at, m, t * ray.inverse_scale, u, v);
        if (any_hit && found) break;
    }
    return found;
}

template <bool any_hit, class Offer>
bool intersect_spheres(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const float* table = &tables.spheres[0].center.x;
    const auto meet = [&](int at, Float& t, Float&, Float&) {
        const UInt row = ids_from(leaf, at) * UInt(std::uint32_t(sizeof(SphereRecord) / 4));
        const auto number = [&](int k) { return gather(table + k, row); };
        const Vec3 center = fma({number(3), number(4), number(5)}, ray.time, {number(0), number(1), number(2)});
        return intersect_sphere(center, number(6), ray.o, ray.d, Float(infinity), t);
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

template <bool any_hit, class Offer>
bool intersect_disks(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const float* table = &tables.disks[0].center.x;
    const auto meet = [&](int at, Float& t, Float&, Float&) {
        const UInt row = ids_from(leaf, at) * UInt(std::uint32_t(sizeof(DiskRecord) / 4));
        const auto number = [&](int k) { return gather(table + k, row); };
        return intersect_disk({number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6), ray.o,
                              ray.d, Float(infinity), t);
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

/// Data: 4 arrays, centre and radius.
template <bool any_hit, class Offer>
bool intersect_points(const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Float& t, Float&, Float&) {
        return intersect_sphere({array_from(leaf, 0, at), array_from(leaf, 1, at), array_from(leaf, 2, at)},
                                array_from(leaf, 3, at), ray.o, ray.d, Float(infinity), t);
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

/// The arrays of a CurveLeaf at the time of a ray.
template <bool ribbons, bool moving>
class CurveLeafReader {
public:
    CurveLeafReader(const BvhLeaf& leaf, const LeafRay& ray, int at)
        : leaf_(leaf), at_(at), moves_(moving && leaf.moves()), fraction_(ray.fraction)
    {
        if (moves_) first_ += int(ray.key) * CurveLeaf::arrays_at_time(ribbons);
    }
    Float begin() const { return array_from(leaf_, 0, at_); }
    Float share() const { return array_from(leaf_, 1, at_); }
    Float number(int k) const
    {
        const Float now = array_from(leaf_, first_ + k, at_);
        if (!moving || !moves_) return now;
        return mix(now, array_from(leaf_, first_ + CurveLeaf::arrays_at_time(ribbons) + k, at_), fraction_);
    }
    Vec3 vector(int k) const { return {number(k), number(k + 1), number(k + 2)}; }
    /// By the sign of a radius at a key, which would be lost in between where both are 0.
    Mask solid() const { return negative(3); }
    Mask fiber() const { return negative(7); }

private:
    Mask negative(int k) const { return (float_bits(array_from(leaf_, first_ + k, at_)) >> 31) != UInt(0u); }

    const BvhLeaf& leaf_;
    int at_, first_ = CurveLeaf::first_time;
    bool moves_;
    Float fraction_;
};

struct PieceHits {
    Mask m;
    Float t, w;
};
/// Of the lanes of the mask. Apart, so that other curves don't pay.
[[gnu::noinline]] inline PieceHits meet_solid_pieces(const GeometryTables& tables, UInt segment, Float number,
                                                     const CurvePiece& piece, const LeafRay& ray, Mask solid)
{
    const KeyTime time{UInt(ray.key), Float(ray.fraction)};
    const SolidPieces solids(tables, segment, number, time, solid);
    PieceHits hits;
    hits.m = solids.meet(piece, ray.o, ray.d, hits.t, hits.w);
    return hits;
}

/// Lanes of `near` whose ray meets the end of a piece at t within the piece itself, or within its neighbours.
[[gnu::noinline]] inline Mask hidden_in_fibre(const GeometryTables& tables, UInt segment, Float number,
                                              const CurvePiece& piece, const LeafRay& ray, Float t, Mask near)
{
    const Mask begins_within = span_of_round_piece(piece, ray.o, ray.d).t_in <= Float(0);
    const KeyTime time{UInt(ray.key), Float(ray.fraction)};
    return near & (begins_within | SolidPieces(tables, segment, number, time, near).hide(fma(ray.d, t, ray.o)));
}

/// moving  whether anything in the scene does
template <bool any_hit, bool ribbons, bool moving, class Offer>
bool intersect_curves(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Float& t, Float& u, Float&) {
        const CurveLeafReader<ribbons, moving> pieces(leaf, ray, at);
        const CurvePiece piece{pieces.vector(0), pieces.vector(4), abs(pieces.number(3)),
                               ribbons ? pieces.number(7) : abs(pieces.number(7))};
        Float w;
        Mask m;
        if constexpr (ribbons)
            m = intersect_ribbon_piece(piece, pieces.vector(8), pieces.vector(11), ray.o, ray.d, Float(infinity), t, w);
        else {
            m = intersect_round_piece(piece, ray.o, ray.d, Float(infinity), t, w);
            const Mask solid = pieces.solid();
            if (any(solid)) {
                const Float number = pieces.begin() / pieces.share();
                const PieceHits hits = meet_solid_pieces(tables, ids_from(leaf, at), number, piece, ray, solid);
                m = (m & !solid) | (hits.m & solid);
                t = select(solid, hits.t, t);
                w = select(solid, hits.w, w);
            }
            // Rays that begin within a fibre, and no others, may meet the ends of its pieces: not far from there but
            // for those that go almost along it.
            constexpr float far_in_radii = 32;
            const Mask near = m & pieces.fiber() & (t < max(piece.ra, piece.rb) * Float(far_in_radii));
            if (any(near)) {
                const Float number = pieces.begin() / pieces.share();
                m = m & !hidden_in_fibre(tables, ids_from(leaf, at), number, piece, ray, t, near);
            }
        }
        // Powers of 2 both: the end of a piece is the beginning of the next.
        u = fma(w, pieces.share(), pieces.begin());
        return m;
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
