// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Perlin 2002, "Improving Noise", with the permutation of the reference implementation: values equal those of other
/// renderers.
#include <cstdint>

#include "math/elementary.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

inline constexpr std::uint32_t perlin_permutation[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

/// Quintic interpolant from 0 to 1 with zero first and second derivatives at both ends.
inline Float fade(Float t)
{
    return t * t * t * fma(t, fma(t, Float(6), Float(-15)), Float(10));
}

/// Dot product of an offset from a lattice corner and the corner's gradient. There are 12 gradients, towards the
/// midpoints of a cube's edges; four of them are used twice.
inline Float dot_gradient(UInt hashed, Vec3 way)
{
    const UInt h = hashed & UInt(15u);
    const Mask twice = (h & UInt(14u)) == UInt(12u);
    const Float a = select(less(h, UInt(8u)) | twice, way.x, way.y),
                b = select(less(h, UInt(4u)) | twice, way.y, way.z);
    return bits_float(float_bits(a) ^ (h << 31)) + bits_float(float_bits(b) ^ ((h >> 1) << 31));
}

}  // namespace detail

/// Noise in about -1 to 1; 0 at integer points.
[[gnu::noinline]] inline Float improved_noise(Vec3 p)
{
    const Vec3 cell{floor(p.x), floor(p.y), floor(p.z)};
    const Vec3 f = p - cell;
    const auto whole = [](Float x) { return to_uint(clamp(x, Float(-1e9f), Float(1e9f))); };
    const auto permuted = [](UInt x) { return gather(detail::perlin_permutation, x & UInt(255u)); };
    const UInt x = whole(cell.x), y = whole(cell.y), z = whole(cell.z), one(1u);
    const auto mix = [](Float t, Float a, Float b) { return fma(t, b - a, a); };
    const Float u = detail::fade(f.x), v = detail::fade(f.y), w = detail::fade(f.z);
    // Interpolates first along z (line), then y (square), then x.
    const auto line = [&](UInt column, float dx, float dy) {
        const Float fx = f.x - Float(dx), fy = f.y - Float(dy);
        return mix(w, detail::dot_gradient(permuted(column + z), {fx, fy, f.z}),
                   detail::dot_gradient(permuted(column + z + one), {fx, fy, f.z - Float(1)}));
    };
    const auto square = [&](UInt plane, float dx) {
        return mix(v, line(permuted(plane + y), dx, 0), line(permuted(plane + y + one), dx, 1));
    };
    return mix(u, square(permuted(x), 0), square(permuted(x + one), 1));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
