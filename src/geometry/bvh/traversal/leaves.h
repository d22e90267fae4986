// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Intersection of one ray with a leaf of primitives other than triangles: lanes are primitives.
#include "geometry/bvh/traversal/ray.h"
#include "geometry/shapes/solid_curve.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Ids of the primitives from index `at` on; the last one is repeated.
inline UInt ids_from(const BvhLeaf& leaf, int at)
{
    alignas(64) std::uint32_t id[lanes];
    for (int i = 0; i < lanes; ++i) id[i] = leaf.ids()[std::min(at + i, leaf.count() - 1)];
    return load(id);
}
/// Values of the k-th array from index `at` on; unspecified past the last primitive.
inline Float array_from(const BvhLeaf& leaf, int k, int at)
{
    return load(leaf.data() + k * leaf.count() + at);
}

/// A ray with unit direction, as intersection of curved primitives requires. Rays in the space of an instance are
/// normalized.
struct LeafRay {
    Vec3 o, d;
    Float scale, inverse_scale;  ///< ratio of distances here to those of the original ray, and its inverse
    Float time;
    Float nearest;  ///< distance of the nearest hit so far along the original ray; infinity if there is none
    /// Motion key and fraction as in RayTimes; used if anything moves.
    std::uint32_t key = 0;
    float fraction = 0;

    /// placed: whether the ray is in the space of an instance.
    LeafRay(const PreparedRay& ray, bool placed, float nearest_hit)
        : o(ray.vector(PreparedRays::origin_x)),
          d(ray.vector(PreparedRays::direction_x)),
          scale(1.f),
          inverse_scale(1.f),
          time(ray.number(PreparedRays::time)),
          nearest(nearest_hit)
    {
        if (!placed) return;
        scale = length(d);
        inverse_scale = Float(1) / scale;
        d = d * inverse_scale;
    }
    /// Whether a distance here, of any sign, is not beyond the nearest hit so far.
    Mask reaches(Float t) const { return t * inverse_scale <= nearest; }
};

/// Runs an intersection over n primitives: meet(at, present, t, u, v) returns the lanes among `present` that are hit at
/// any distance, where `at` is the index of the first lane. Other lanes are past the last primitive and hold
/// unspecified values. Calls offer(at, m, t, u, v) for the hits. With any_hit it stops when offer returns true. Returns
/// whether any call did.
template <bool any_hit, class Meet, class Offer>
bool intersect_all(int n, const LeafRay& ray, const Meet& meet, const Offer& offer)
{
    bool found = false;
    for (int at = 0; at < n; at += lanes) {
        Float t, u(0.f), v(0.f);
        const Mask present = first_lanes(std::size_t(n - at));
        const Mask m = meet(at, present, t, u, v) & present;
        found |= any(m) && offer(at, m, t * ray.inverse_scale, u, v);
        if (any_hit && found) break;
    }
    return found;
}

/// Reads numbers of a leaf's primitives from index `at` on, by their place in the records. first: number 0 of the first
/// record.
template <class Record>
auto record_reader(const float* first, const BvhLeaf& leaf, int at)
{
    return [first, row = ids_from(leaf, at) * UInt(std::uint32_t(sizeof(Record) / 4))](int k) {
        return gather(first + k, row);
    };
}

/// The leaf stores no data but ids: centers, motion and radii are read from the tables.
template <bool any_hit, class Offer>
bool intersect_spheres(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Mask, Float& t, Float&, Float&) {
        const auto number = record_reader<SphereRecord>(&tables.spheres[0].center.x, leaf, at);
        const Vec3 center = fma({number(3), number(4), number(5)}, ray.time, {number(0), number(1), number(2)});
        return intersect_sphere(center, number(6), ray.o, ray.d, Float(infinity), t);
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

/// The leaf stores no data but ids: centers, normals and radii are read from the tables.
template <bool any_hit, class Offer>
bool intersect_disks(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Mask, Float& t, Float&, Float&) {
        const auto number = record_reader<DiskRecord>(&tables.disks[0].center.x, leaf, at);
        return intersect_disk({number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6), ray.o,
                              ray.d, Float(infinity), t);
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

/// The leaf stores 4 arrays: the three coordinates of the centers, and the radii.
template <bool any_hit, class Offer>
bool intersect_points(const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Mask, Float& t, Float&, Float&) {
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
    /// The sign of a radius at a key is the flag of solid curves: interpolation would lose it where both radii are 0.
    Mask solid() const { return negative(3); }
    Mask fiber() const { return negative(7); }

private:
    Mask negative(int k) const { return (float_bits(array_from(leaf_, first_ + k, at_)) >> 31) != UInt(0u); }

    const BvhLeaf& leaf_;
    int at_, first_ = CurveLeaf::first_time;
    bool moves_;
    Float fraction_;
};

/// Hits on curve pieces: mask, distance, and position along the piece.
struct PieceHits {
    Mask m;
    Float t, w;
};
/// Hits on solid curve pieces in the lanes of `solid`. A separate function keeps other curves fast.
[[gnu::noinline]] inline PieceHits intersect_solid_pieces(const GeometryTables& tables, UInt segment, Float number,
                                                          const CurvePiece& piece, const LeafRay& ray, Mask solid)
{
    const RoundSpan span = span_of_round_piece(piece, ray.o, ray.d);
    // Neighbors are read only where the ray may hit the piece, because reading them takes longer than the test.
    const Mask candidates = solid & span.met & (span.t_out > Float(0)) & ray.reaches(span.t_in);
    if (none(candidates)) return {Mask(false), Float(0), Float(0)};
    const SolidPieces solids(tables, segment, number, piece, ray.key, ray.fraction, candidates);
    PieceHits hits;
    hits.m = candidates & solids.meet(span, ray.o, ray.d, hits.t, hits.w);
    return hits;
}

/// Lanes of `near` whose hit on the end of a piece lies inside the piece itself or its neighbors.
[[gnu::noinline]] inline Mask hidden_in_fiber(const GeometryTables& tables, UInt segment, Float number,
                                              const CurvePiece& piece, const LeafRay& ray, Float t, Mask near)
{
    const Mask begins_within = near & (span_of_round_piece(piece, ray.o, ray.d).t_in <= Float(0));
    const Mask others = near & !begins_within;
    if (none(others)) return begins_within;
    const SolidPieces neighbors(tables, segment, number, piece, ray.key, ray.fraction, others);
    return begins_within | (others & neighbors.hide(fma(ray.d, t, ray.o)));
}

/// moving: whether anything in the scene moves.
template <bool any_hit, bool ribbons, bool moving, class Offer>
bool intersect_curves(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Mask present, Float& t, Float& u, Float&) {
        const CurveLeafReader<ribbons, moving> pieces(leaf, ray, at);
        const CurvePiece piece{pieces.vector(0), pieces.vector(4), abs(pieces.number(3)),
                               ribbons ? pieces.number(7) : abs(pieces.number(7))};
        Float w;
        Mask m;
        if constexpr (ribbons)
            m = intersect_ribbon_piece({piece, pieces.vector(8), pieces.vector(11)}, ray.o, ray.d, Float(infinity), t,
                                       w);
        else {
            if (none(present & may_meet_round_piece(piece, ray.o, ray.d))) return Mask(false);
            m = intersect_round_piece(piece, ray.o, ray.d, Float(infinity), t, w);
            const Mask solid = present & pieces.solid();
            if (any(solid)) {
                const Float number = pieces.begin() / pieces.share();
                const PieceHits hits = intersect_solid_pieces(tables, ids_from(leaf, at), number, piece, ray, solid);
                m = (m & !solid) | (hits.m & solid);
                t = select(solid, hits.t, t);
                w = select(solid, hits.w, w);
            }
            // Only rays that start inside a fiber may hit the internal ends of its pieces, close to their origin unless
            // they run along the fiber.
            constexpr float far_in_radii = 32;
            const Mask near =
                m & present & pieces.fiber() & ray.reaches(t) & (t < max(piece.ra, piece.rb) * Float(far_in_radii));
            if (any(near)) {
                const Float number = pieces.begin() / pieces.share();
                m = m & !hidden_in_fiber(tables, ids_from(leaf, at), number, piece, ray, t, near);
            }
        }
        // The share is a power of 2 and `begin` a multiple of it, so the end of a piece equals the beginning of the
        // next.
        u = fma(w, pieces.share(), pieces.begin());
        return m;
    };
    return intersect_all<any_hit>(leaf.count(), ray, meet, offer);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
