// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Intersection of rays with indexed leaves, which store each vertex once.
///
/// Each vertex is interpolated to the ray's time, translated and sheared once, however many triangles share it;
/// triangles then take the results from registers.
#include "geometry/bvh/traversal/hits.h"
#include "geometry/bvh/traversal/triangles.h"

namespace fathom {
inline namespace FATHOM_LANES {

#if defined(__AVX2__)

static_assert(lanes == IndexedLeaf::max_vertices);

/// The vertex index of one corner of each triangle. F: Float, or half of one for leaves with few triangles and
/// vertices.
template <class F>
class CornerNumbers {
public:
    CornerNumbers(const IndexedLeaf& leaf, int corner, int)
    {
        const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(leaf.corners(corner)));
#if defined(__AVX512F__)
        number_ = _mm512_cvtepu8_epi32(bytes);
#else
        number_[0] = _mm256_cvtepu8_epi32(bytes);
        number_[1] = _mm256_cvtepu8_epi32(_mm_srli_si128(bytes, 8));
#endif
    }
    /// Returns, for each triangle, the value of f at its corner; f computes it for all vertices from the coordinate
    /// array at p.
    template <class Find>
    [[gnu::always_inline]] Float of(const float* p, const Find& f) const
    {
        const Float vertices = f(p);
#if defined(__AVX512F__)
        return native::Float(_mm512_permutexvar_ps(number_, vertices.v));
#else
        const auto half = [&](__m256i number) {
            const __m256 low = _mm256_permutevar8x32_ps(vertices.a.v, number);
            const __m256 high = _mm256_permutevar8x32_ps(vertices.b.v, number);
            return native::Float(_mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(number, 28))));
        };
        return {half(number_[0]), half(number_[1])};
#endif
    }

private:
#if defined(__AVX512F__)
    __m512i number_;
#else
    __m256i number_[2];
#endif
};

#if FATHOM_LANE_PAIRS
template <>
class CornerNumbers<native::Float> {
public:
    CornerNumbers(const IndexedLeaf& leaf, int corner, int)
        : number_(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(leaf.corners(corner)))))
    {
    }
    template <class Find>
    [[gnu::always_inline]] native::Float of(const float* p, const Find& f) const
    {
        return native::Float(_mm256_permutevar8x32_ps(f(p).v, number_));
    }

private:
    __m256i number_;
};
#endif

#else

template <class F>
class CornerNumbers {
public:
    CornerNumbers(const IndexedLeaf& leaf, int corner, int at) : number_(leaf.corners(corner)[at]) {}
    template <class Find>
    F of(const float* p, const Find& f) const
    {
        return f(p + number_);
    }

private:
    std::uint8_t number_;
};

#endif

/// Vertices of a leaf at one time, `fraction` of the way from vertex_times[key] to the next. moving: whether anything
/// in the scene moves; otherwise positions are read directly.
template <bool moving, class F>
class LeafVertices {
public:
    LeafVertices(const IndexedLeaf& leaf, std::uint32_t key, F fraction)
        : step_(moving && leaf.moves() ? 3 * leaf.vertices() : 0),
          begin_(step_ * std::ptrdiff_t(key)),
          fraction_(fraction)
    {
    }
    /// A coordinate of as many vertices as there are lanes, at p.
    [[gnu::always_inline]] F row(const float* p) const
    {
        return between(p, [](const float* q) { return load_as<F>(q); });
    }
    /// A coordinate of one vertex, for a ray in each lane.
    [[gnu::always_inline]] F one(const float* p) const
    {
        return between(p, [](const float* q) { return F(*q); });
    }

private:
    template <class Read>
    [[gnu::always_inline]] F between(const float* p, const Read& read) const
    {
        if constexpr (!moving) return read(p);
        // The interpolation is that of geometry/motion.h; it is exact where nothing moves.
        const F from = read(p + begin_);
        return fma(read(p + begin_ + step_) - from, fraction_, from);
    }

    std::ptrdiff_t step_, begin_;
    F fraction_;
};

/// Range of the times of a packet's rays; members are those of RayTimes.
struct PacketTimes {
    float first_shutter = 0, last_shutter = 0, first_fraction = 0, last_fraction = 0;
    std::uint32_t key = 0;
    bool same_key = true;  ///< all rays have the same key

    PacketTimes() = default;
    PacketTimes(const RayTimes& times, RayMask rays) : key(times.key[std::countr_zero(rays)])
    {
        Float low[2] = {Float(infinity), Float(infinity)}, minus_high[2] = {Float(infinity), Float(infinity)};
        for (int i = 0; i < stream_size; i += lanes) {
            const Mask m = mask_from_bits(std::uint32_t(rays >> i) & std::uint32_t((RayMask(1) << lanes) - 1));
            same_key &= none(m & !(load(times.key + i) == UInt(key)));
            const Float x[2] = {load(times.shutter + i), load(times.fraction + i)};
            for (int k = 0; k < 2; ++k) {
                low[k] = select(m, min(low[k], x[k]), low[k]);
                minus_high[k] = select(m, min(minus_high[k], -x[k]), minus_high[k]);
            }
        }
        first_shutter = least(low[0]), last_shutter = -least(minus_high[0]);
        first_fraction = least(low[1]), last_fraction = -least(minus_high[1]);
    }

    /// Bounds of each triangle over all times of the packet, which must share a key. Motion is linear, so the first and
    /// last time suffice.
    template <bool moving>
    [[gnu::always_inline]] void bounds(const IndexedLeaf& leaf, Float low[3], Float high[3]) const
    {
        const CornerNumbers<Float> corner[] = {{leaf, 0, 0}, {leaf, 1, 0}, {leaf, 2, 0}};
        const LeafVertices<moving, Float> first(leaf, key, Float(first_fraction)),
            last(leaf, key, Float(last_fraction));
        const auto least = [&](const float* v) { return moving ? min(first.row(v), last.row(v)) : first.row(v); };
        const auto most = [&](const float* v) { return moving ? max(first.row(v), last.row(v)) : first.row(v); };
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = Float(infinity), high[axis] = Float(-infinity);
            for (const CornerNumbers<Float>& c : corner) {
                low[axis] = min(low[axis], c.of(leaf.axis(axis), least));
                high[axis] = max(high[axis], c.of(leaf.axis(axis), most));
            }
        }
    }
};

template <class F, bool moving>
[[gnu::always_inline]] inline TriangleIntersections intersect_triangles(const IndexedLeaf& leaf,
                                                                        const LeafVertices<moving, F>& vertices, int at,
                                                                        const PreparedRay& r)
{
    const CornerNumbers<F> corner[] = {{leaf, 0, at}, {leaf, 1, at}, {leaf, 2, at}};
    const std::ptrdiff_t axis = r.integer(PreparedRays::axis), ix = r.integer(PreparedRays::row_x),
                         iy = r.integer(PreparedRays::row_y);
    const auto z = [&, o = F(r.number(PreparedRays::seen_z))](const float* p) { return vertices.row(p) - o; };
    const auto sheared = [&](std::ptrdiff_t i, int seen, int shear) {
        return [&, to_z = (axis - i) * leaf.vertices(), o = F(r.number(seen)),
                by = F(r.number(shear))](const float* p) { return fma(-by, z(p + to_z), vertices.row(p) - o); };
    };
    const auto x = sheared(ix, PreparedRays::seen_x, PreparedRays::shear_x),
               y = sheared(iy, PreparedRays::seen_y, PreparedRays::shear_y);
    const auto seen = [&](int k) {
        return SeenCorner<F>{corner[k].of(leaf.axis(ix), x), corner[k].of(leaf.axis(iy), y)};
    };
    const TriangleWeightsOf<F> w = triangle_weights(seen(0), seen(1), seen(2));
    const auto corner_z = [&](int k) { return corner[k].of(leaf.axis(axis), z); };
    return first_triangles(w, corner_z(0), corner_z(1), corner_z(2), leaf.count() - at);
}

/// Intersects a ray with the triangles of a leaf from index `at` on, at most one per lane. key, fraction: as in
/// LeafVertices.
template <bool moving>
[[gnu::always_inline]] inline TriangleIntersections intersect_triangles(const IndexedLeaf& leaf, std::uint32_t key,
                                                                        float fraction, int at, const PreparedRay& r)
{
    if (FATHOM_LANE_PAIRS && leaf.count() <= native::lanes && leaf.vertices() <= native::lanes)
        return intersect_triangles(leaf, LeafVertices<moving, native::Float>(leaf, key, native::Float(fraction)), at,
                                   r);
    return intersect_triangles(leaf, LeafVertices<moving, Float>(leaf, key, Float(fraction)), at, r);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
