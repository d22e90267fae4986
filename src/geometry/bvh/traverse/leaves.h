#pragma once
/// One ray against a leaf of something other than triangles: lanes are primitives.
#include "geometry/bvh/traverse/ray.h"
#include "geometry/shapes/solid_curve.h"

namespace fathom::inline FATHOM_LANES {

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
bool meet_all(int n, const LeafRay& ray, const Meet& meet, const Offer& offer)
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
bool meet_spheres(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const float* table = &tables.spheres[0].center.x;
    const auto meet = [&](int at, Float& t, Float&, Float&) {
        const UInt row = ids_from(leaf, at) * UInt(std::uint32_t(sizeof(SphereRecord) / 4));
        const auto number = [&](int k) { return gather(table + k, row); };
        const Vec3 center = fma({number(3), number(4), number(5)}, ray.time, {number(0), number(1), number(2)});
        return meet_sphere(center, number(6), ray.o, ray.d, Float(infinity), t);
    };
    return meet_all<any_hit>(leaf.count(), ray, meet, offer);
}

template <bool any_hit, class Offer>
bool meet_disks(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const float* table = &tables.disks[0].center.x;
    const auto meet = [&](int at, Float& t, Float&, Float&) {
        const UInt row = ids_from(leaf, at) * UInt(std::uint32_t(sizeof(DiskRecord) / 4));
        const auto number = [&](int k) { return gather(table + k, row); };
        return meet_disk({number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6), ray.o, ray.d,
                         Float(infinity), t);
    };
    return meet_all<any_hit>(leaf.count(), ray, meet, offer);
}

/// Data: 4 arrays, centre and radius.
template <bool any_hit, class Offer>
bool meet_points(const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Float& t, Float&, Float&) {
        return meet_sphere({array_from(leaf, 0, at), array_from(leaf, 1, at), array_from(leaf, 2, at)},
                           array_from(leaf, 3, at), ray.o, ray.d, Float(infinity), t);
    };
    return meet_all<any_hit>(leaf.count(), ray, meet, offer);
}

/// Data: 10 arrays, both ends with their radii, where the piece begins along its segment, and how much of it that is;
/// of ribbons besides the tangents at both ends. The first radius of solid curves is negative, or -0.
template <bool any_hit, bool ribbons, class Offer>
bool meet_curves(const GeometryTables& tables, const BvhLeaf& leaf, const LeafRay& ray, const Offer& offer)
{
    const auto meet = [&](int at, Float& t, Float& u, Float&) {
        const auto number = [&](int k) { return array_from(leaf, k, at); };
        const auto vector = [&](int k) { return Vec3{number(k), number(k + 1), number(k + 2)}; };
        const CurvePiece piece{vector(0), vector(4), abs(number(3)), number(7)};
        Float w;
        Mask m;
        if constexpr (ribbons)
            m = meet_ribbon_piece(piece, vector(10), vector(13), ray.o, ray.d, Float(infinity), t, w);
        else {
            m = meet_round_piece(piece, ray.o, ray.d, Float(infinity), t, w);
            const Mask solid = (float_bits(number(3)) >> 31) != UInt(0u);
            if (any(solid)) {
                Float solid_t, solid_w;
                const SolidPieces pieces(tables, ids_from(leaf, at), number(8) / number(9), solid);
                const Mask met = pieces.meet(piece, ray.o, ray.d, solid_t, solid_w);
                m = (m & !solid) | (met & solid);
                t = select(solid, solid_t, t);
                w = select(solid, solid_w, w);
            }
        }
        // Powers of 2 both: the end of a piece is the beginning of the next.
        u = fma(w, number(9), number(8));
        return m;
    };
    return meet_all<any_hit>(leaf.count(), ray, meet, offer);
}

}  // namespace fathom::inline FATHOM_LANES
