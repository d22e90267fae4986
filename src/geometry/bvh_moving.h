#pragma once
/// Leaves of triangles whose vertices move, seen from a ray.
///
/// A vertex stands in a leaf once, however many triangles share it: it is put where it is at the ray's time, moved and
/// sheared once, and what the triangles see of it is then taken from registers.
#include "geometry/bvh_hits.h"

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

/// What the watertight test needs of triangles, one per lane: their corners, relative to the ray's origin, axes
/// permuted, sheared so that the ray runs along z.
class SeenTriangles {
public:
    /// at: of the first lane's triangle.
    [[gnu::always_inline]] SeenTriangles(const MovingLeaf& leaf, const PreparedRay& r, const LeafTime& time, int at)
        : leaf_(leaf), ray_(r), time_(time), corner_{{leaf, 0, at}, {leaf, 1, at}, {leaf, 2, at}}
    {
    }
    /// z: of the corners.
    [[gnu::always_inline]] TriangleWeights weights(Vec3& z) const
    {
        const std::ptrdiff_t axis = ray_.integer(PreparedRays::axis);
        const std::ptrdiff_t ix = axis == 2 ? 0 : axis + 1, iy = axis == 0 ? 2 : axis - 1;
        const auto seen_z = [this, o = origin(axis)](const float* p) { return time_.row(p) - o; };
        const auto sheared = [&](std::ptrdiff_t other, int shear) {
            return [this, seen_z, to_z = (axis - other) * leaf_.vertices(), o = origin(other),
                    by = Float(ray_.number(shear))](const float* p) {
                return fma(-by, seen_z(p + to_z), time_.row(p) - o);
            };
        };
        const auto x = sheared(ix, PreparedRays::shear_x), y = sheared(iy, PreparedRays::shear_y);
        const auto point = [&](int k) {
            return Point2{corner_[k].of(leaf_.axis(ix), x), corner_[k].of(leaf_.axis(iy), y)};
        };
        const auto depth = [&](int k) { return corner_[k].of(leaf_.axis(axis), seen_z); };
        z = {depth(0), depth(1), depth(2)};
        return triangle_weights(point(0), point(1), point(2));
    }

private:
    Float origin(std::ptrdiff_t axis) const { return Float(ray_.number(PreparedRays::origin_x + int(axis))); }

    const MovingLeaf leaf_;
    const PreparedRay ray_;
    const LeafTime time_;
    const CornerNumbers corner_[3];
};

}  // namespace fathom::inline FATHOM_LANES
