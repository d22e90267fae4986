// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Pushing the children that a ray hits onto its stack: the innermost loop of traversal, written for each instruction
/// set.
#include "geometry/bvh/layout/data.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// References and the entry distances of their boxes. Pushing may write up to 16 entries past the last.
struct BvhStack {
    std::uint32_t* reference;
    float* t;
};

/// Number of vectors that a node's 16 boxes take.
inline constexpr int box_parts = bvh_width / lanes;

/// Entry and exit distances of a ray for the boxes of a node, in vectors.
struct BoxDistances {
    Float near[box_parts], far[box_parts];
};

#if defined(__AVX512F__)

static_assert(box_parts == 1);

/// Pushes those of 16 references `what` whose box has near <= far, in the given order from far to near; returns the new
/// stack size.
[[gnu::always_inline]] inline int push_in_order(const BvhStack& stack, int size, const std::uint32_t* what,
                                                const std::uint32_t* order, const BoxDistances& box)
{
    // The permutation uses only the low 4 bits of each lane.
    __m512i slots = _mm512_set1_epi32(int(order[0]));
    slots = _mm512_mask_set1_epi32(slots, 0xff00, int(order[1]));
    slots = _mm512_srlv_epi32(slots, _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 0, 4, 8, 12, 16, 20, 24, 28));
    const __m512 near = _mm512_permutexvar_ps(slots, box.near[0].v), far = _mm512_permutexvar_ps(slots, box.far[0].v);
    const __m512i child = _mm512_permutexvar_epi32(slots, _mm512_load_si512(what));
    const __mmask16 m = _mm512_cmp_ps_mask(near, far, _CMP_LE_OQ);
    _mm512_storeu_si512(stack.reference + size, _mm512_maskz_compress_epi32(m, child));
    _mm512_storeu_ps(stack.t + size, _mm512_maskz_compress_ps(m, near));
    return size + std::popcount(std::uint32_t(m));
}

[[gnu::always_inline]] inline int push_any(const BvhStack& stack, int size, const BvhNode& node,
                                           const BoxDistances& box)
{
    const __mmask16 m = _mm512_cmp_ps_mask(box.near[0].v, box.far[0].v, _CMP_LE_OQ);
    _mm512_storeu_si512(stack.reference + size, _mm512_maskz_compress_epi32(m, _mm512_load_si512(node.child)));
    return size + std::popcount(std::uint32_t(m));
}

/// Removes the entries beyond t_max; returns the new stack size.
inline int filter(const BvhStack& stack, int size, float t_max)
{
    int to = 0;
    for (int i = 0; i < size; i += 16) {
        const __m512i reference = _mm512_loadu_si512(stack.reference + i);
        const __m512 t = _mm512_loadu_ps(stack.t + i);
        const __mmask16 m =
            _mm512_mask_cmp_ps_mask(first_lanes(std::size_t(size - i)).v, t, _mm512_set1_ps(t_max), _CMP_LE_OQ);
        _mm512_storeu_si512(stack.reference + to, _mm512_maskz_compress_epi32(m, reference));
        _mm512_storeu_ps(stack.t + to, _mm512_maskz_compress_ps(m, t));
        to += std::popcount(std::uint32_t(m));
    }
    return to;
}

/// The lanes of m with the minimum t.
[[gnu::always_inline]] inline std::uint32_t min_lanes(Mask m, Float t)
{
    const __m512 masked = _mm512_mask_blend_ps(m.v, _mm512_set1_ps(std::numeric_limits<float>::infinity()), t.v);
    return _mm512_mask_cmp_ps_mask(m.v, masked, _mm512_set1_ps(_mm512_reduce_min_ps(masked)), _CMP_EQ_OQ);
}

/// The value of the first lane of m; unspecified if there is none.
[[gnu::always_inline]] inline float first_of(Float x, Mask m)
{
    return _mm512_cvtss_f32(_mm512_maskz_compress_ps(m.v, x.v));
}

#else

[[gnu::always_inline]] inline float first_of(Float x, Mask m)
{
    alignas(64) float all[lanes];
    store(all, x);
    return all[std::countr_zero(mask_bits(m) | 1u << (lanes - 1))];
}

inline int filter(const BvhStack& stack, int size, float t_max)
{
    int to = 0;
    for (int i = 0; i < size; ++i) {
        stack.reference[to] = stack.reference[i];
        stack.t[to] = stack.t[i];
        to += stack.t[i] <= t_max;
    }
    return to;
}

[[gnu::always_inline]] inline std::uint32_t boxes_hit(const BoxDistances& box)
{
    std::uint32_t bits = 0;
    for (int part = 0; part < box_parts; ++part) bits |= mask_bits(box.near[part] <= box.far[part]) << part * lanes;
    return bits;
}

#if defined(__AVX2__)

[[gnu::always_inline]] inline std::uint32_t min_lanes(Mask m, Float t)
{
    const Float masked = select(m, t, Float(std::numeric_limits<float>::infinity()));
    const auto halves = [](__m256 x) { return _mm256_min_ps(x, _mm256_permute2f128_ps(x, x, 1)); };
#if FATHOM_LANE_PAIRS
    __m256 least = halves(_mm256_min_ps(masked.a.v, masked.b.v));
#else
    __m256 least = halves(masked.v);
#endif
    least = _mm256_min_ps(least, _mm256_shuffle_ps(least, least, 0x4e));
    least = _mm256_min_ps(least, _mm256_shuffle_ps(least, least, 0xb1));
    return mask_bits(m & (masked == Float(_mm256_cvtss_f32(least))));
}

[[gnu::always_inline]] inline int push_in_order(const BvhStack& stack, int size, const std::uint32_t* what,
                                                const std::uint32_t* order, const BoxDistances& box)
{
    const std::uint32_t bits = boxes_hit(box);
    alignas(64) float near[bvh_width];
    alignas(16) std::uint8_t slots[48] = {};  // entries past the last are slot 32
    for (int part = 0; part < box_parts; ++part) store(near + part * lanes, box.near[part]);
    // `slot` is the order of slots as bytes, `met` the mask of slots that are hit; the shuffle permutes the mask into
    // that order.
    const __m128i nibbles = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(order)), low = _mm_set1_epi8(15);
    const __m128i slot = _mm_unpacklo_epi8(_mm_and_si128(nibbles, low), _mm_and_si128(_mm_srli_epi16(nibbles, 4), low));
    _mm_store_si128(reinterpret_cast<__m128i*>(slots), slot);
    const __m128i bit = _mm_setr_epi8(1, 2, 4, 8, 16, 32, 64, -128, 1, 2, 4, 8, 16, 32, 64, -128);
    const __m128i spread = _mm_setr_epi8(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
    const __m128i bytes = _mm_shuffle_epi8(_mm_cvtsi32_si128(int(bits)), spread);
    const __m128i met = _mm_cmpeq_epi8(_mm_and_si128(bytes, bit), bit);
    std::uint32_t ordered = std::uint32_t(_mm_movemask_epi8(_mm_shuffle_epi8(met, slot)));
    const int count = std::popcount(ordered);
    const auto push = [&] {
        const int s = slots[std::countr_zero(ordered)];
        stack.reference[size] = what[s];
        stack.t[size++] = near[s];
        ordered &= ordered - 1;
    };
    // The number of entries is unpredictable but small: four are always pushed, and the size is corrected after that.
    const int after = size + count;
    for (int i = 0; i < 4; ++i) push();
    while (size < after) push();
    size = after;
    return size;
}

#else

[[gnu::always_inline]] inline std::uint32_t min_lanes(Mask m, Float)
{
    return mask_bits(m);
}

[[gnu::always_inline]] inline int push_in_order(const BvhStack& stack, int size, const std::uint32_t* what,
                                                const std::uint32_t* order, const BoxDistances& box)
{
    const std::uint32_t bits = boxes_hit(box);
    float near[bvh_width];
    for (int part = 0; part < box_parts; ++part) store(near + part * lanes, box.near[part]);
    for (int i = 0; i < bvh_width; ++i) {
        const std::uint32_t s = order[i >> 3] >> 4 * (i & 7) & 15;
        stack.reference[size] = what[s];
        stack.t[size] = near[s];
        size += int(bits >> s & 1);
    }
    return size;
}

#endif

[[gnu::always_inline]] inline int push_any(const BvhStack& stack, int size, const BvhNode& node,
                                           const BoxDistances& box)
{
    std::uint32_t bits = boxes_hit(box);
    const int after = size + std::popcount(bits);
    const auto push = [&] {
        stack.reference[size++] = node.child[std::countr_zero(bits | 1u << (bvh_width - 1))];
        bits &= bits - 1;
    };
    for (int i = 0; i < 4; ++i) push();
    while (size < after) push();
    return after;
}

#endif

}  // namespace FATHOM_LANES
}  // namespace fathom
