// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/vector.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// N vectors, one per lane. Vectors are in render space (src/geometry/records.h) unless the name has a suffix.
struct Vec3 {
    Float x, y, z;
    Vec3() = default;
    Vec3(Float a, Float b, Float c) : x(a), y(b), z(c) {}
    explicit Vec3(Vec3f a) : x(a.x), y(a.y), z(a.z) {}
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(Vec3 a, Float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 fma(Vec3 a, Float s, Vec3 b) { return {fma(a.x, s, b.x), fma(a.y, s, b.y), fma(a.z, s, b.z)}; }
inline Vec3 select(Mask m, Vec3 a, Vec3 b) { return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)}; }
inline Float dot(Vec3 a, Vec3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
inline Vec3 cross(Vec3 a, Vec3 b)
{
    return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}
inline Float length(Vec3 a) { return sqrt(dot(a, a)); }
/// Unit vector along a, which must not be zero.
inline Vec3 normalize(Vec3 a) { return a * inverse_sqrt(dot(a, a)); }
inline Vec3 flip_sign(Vec3 a, Float sign) { return {flip_sign(a.x, sign), flip_sign(a.y, sign), flip_sign(a.z, sign)}; }
inline Vec3 abs(Vec3 a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
inline Float max_abs(Vec3 a) { return max(max(abs(a.x), abs(a.y)), abs(a.z)); }

/// Orthonormal basis around a unit normal; n is the local z axis.
struct Frame {
    Vec3 s, t, n;

    Frame() = default;
    /// Builds tangents for a unit normal: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    explicit Frame(Vec3 normal) : n(normal)
    {
        const Float sign = copysign(Float(1), n.z);
        const Float a = flip_sign(reciprocal(Float(1) + abs(n.z)), -sign);
        const Float b = n.x * n.y * a;
        s = {fma(sign * n.x * n.x, a, Float(1)), sign * b, -(sign * n.x)};
        t = {b, fma(n.y * n.y, a, sign), -n.y};
    }
    Frame(Vec3 tangent, Vec3 bitangent, Vec3 normal) : s(tangent), t(bitangent), n(normal) {}
    Vec3 to_world(Vec3 local) const { return fma(s, local.x, fma(t, local.y, n * local.z)); }
    Vec3 to_local(Vec3 world) const { return {dot(world, s), dot(world, t), dot(world, n)}; }
};

inline Vec3 load_vec3(const float* x, const float* y, const float* z) { return {load(x), load(y), load(z)}; }

}  // namespace FATHOM_LANES
}  // namespace fathom
