#pragma once
/// Leaves of triangles whose vertices move, seen from a ray.
///
/// A vertex stands in a leaf once, however many triangles share it: it is put where it is at the ray's time, moved and
/// sheared once, and what the triangles see of it is then taken from registers.
#include "geometry/bvh_hits.h"
#include "geometry/bvh_triangles.h"

namespace fathom::inline FATHOM_LANES {

#if defined(__AVX2__)

static_assert(lanes == MovingLeaf::max_vertices);

/// Of each triangle the number of one of its corners.
class CornerNumbers {
public:
    CornerNumbers(const MovingLeaf& leaf, int corner, int)
    {
        const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(leaf.corners(corner)));
#if defined(__AVX512F__)
        number_ = _mm512_cvtepu8_epi32(bytes);
#else
        number_[0] = _mm256_cvtepu8_epi32(bytes);
        number_[1] = _mm256_cvtepu8_epi32(_mm_srli_si128(bytes, 8));
#endif
    }
    /// By triangle, what f finds for all vertices of which one coordinate begins at p.
    template <class F>
    [[gnu::always_inline]] Float of(const float* p, const F& f) const
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

#else

class CornerNumbers {
public:
    CornerNumbers(const MovingLeaf& leaf, int corner, int at) : number_(leaf.corners(corner)[at]) {}
    template <class F>
    Float of(const float* p, const F& f) const
    {
        return f(p + number_);
    }

private:
    std::uint8_t number_;
};

#endif

/// The time among the scene's vertex_times that a leaf is looked at.
class LeafTime {
public:
    LeafTime(const MovingLeaf& leaf, std::uint32_t key, Float fraction)
        : step_(3 * leaf.vertices()), begin_(step_ * std::ptrdiff_t(key)), fraction_(fraction)
    {
    }
    /// Of as many vertices as there are lanes.
    [[gnu::always_inline]] Float row(const float* p) const
    {
        return mix(load(p + begin_), load(p + begin_ + step_), fraction_);
    }
    /// Of one vertex, for rays of all lanes.
    [[gnu::always_inline]] Float one(const float* p) const
    {
        return mix(Float(p[begin_]), Float(p[begin_ + step_]), fraction_);
    }

private:
    std::ptrdiff_t step_, begin_;
    Float fraction_;
};

/// Between which times rays are that keep together; as in RayTimes.
struct PacketTimes {
    float first_shutter = 0, last_shutter = 0, first_fraction = 0, last_fraction = 0;
    std::uint32_t key = 0;
    bool same_key = true;  ///< for all of the rays

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

    /// Of each triangle's box at all of these times, which must have the same key: what is linear is so between the
    /// first and the last.
    [[gnu::always_inline]] void bounds(const MovingLeaf& leaf, Float low[3], Float high[3]) const
    {
        const CornerNumbers corner[] = {{leaf, 0, 0}, {leaf, 1, 0}, {leaf, 2, 0}};
        const LeafTime first(leaf, key, Float(first_fraction)), last(leaf, key, Float(last_fraction));
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = Float(infinity), high[axis] = Float(-infinity);
            for (const CornerNumbers& c : corner) {
                const float* const p = leaf.axis(axis);
                low[axis] = min(low[axis], c.of(p, [&](const float* v) { return min(first.row(v), last.row(v)); }));
                high[axis] = max(high[axis], c.of(p, [&](const float* v) { return max(first.row(v), last.row(v)); }));
            }
        }
    }
};

/// The ray with a leaf's triangles from `at` on, as many as there are lanes at most.
[[gnu::always_inline]] inline void weigh_triangles(const MovingLeaf& leaf, const LeafTime& time, int at,
                                                   const PreparedRay& r, WeighedTriangles& out)
{
    const CornerNumbers corner[] = {{leaf, 0, at}, {leaf, 1, at}, {leaf, 2, at}};
    const std::ptrdiff_t axis = r.integer(PreparedRays::axis), ix = axis == 2 ? 0 : axis + 1,
                         iy = axis == 0 ? 2 : axis - 1;
    const auto origin = [&](std::ptrdiff_t i) { return Float(r.number(PreparedRays::origin_x + int(i))); };
    const auto z = [&, o = origin(axis)](const float* p) { return time.row(p) - o; };
    const auto sheared = [&](std::ptrdiff_t i, int shear) {
        return [&, to_z = (axis - i) * leaf.vertices(), o = origin(i), by = Float(r.number(shear))](const float* p) {
            return fma(-by, z(p + to_z), time.row(p) - o);
        };
    };
    const auto x = sheared(ix, PreparedRays::shear_x), y = sheared(iy, PreparedRays::shear_y);
    const auto seen = [&](int k) {
        return SeenCorner<Float>{corner[k].of(leaf.axis(ix), x), corner[k].of(leaf.axis(iy), y)};
    };
    const TriangleWeights w = triangle_weights(seen(0), seen(1), seen(2));
    store(out.a, w.a), store(out.b, w.b), store(out.c, w.c);
    for (int k = 0; k < 3; ++k) store(out.z[k], corner[k].of(leaf.axis(axis), z));
    out.inside = mask_bits(w.inside & first_lanes(std::size_t(leaf.count() - at)));
}

}  // namespace fathom::inline FATHOM_LANES
