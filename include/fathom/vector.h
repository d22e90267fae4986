// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>

#include "fathom/api.h"

namespace fathom {

/// Point or vector of a scene description. It has double precision because scenes can be large and far from the origin.
struct Vec3d {
    double x = 0, y = 0, z = 0;  ///< Components; lengths are in meters unless stated otherwise.

    /// Returns the sum of both vectors.
    friend Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    /// Returns the vector from b to a.
    friend Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    /// Returns the vector in the opposite direction.
    friend Vec3d operator-(Vec3d a) { return {-a.x, -a.y, -a.z}; }
    /// Returns the vector scaled by s.
    friend Vec3d operator*(Vec3d a, double s) { return {a.x * s, a.y * s, a.z * s}; }
    /// Returns the vector scaled by s.
    friend Vec3d operator*(double s, Vec3d a) { return a * s; }
    /// Compares components exactly.
    friend bool operator==(Vec3d a, Vec3d b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

/// Returns the dot product.
inline double dot(Vec3d a, Vec3d b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// Returns the cross product; it is right-handed: cross(x, y) = z.
inline Vec3d cross(Vec3d a, Vec3d b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Returns the Euclidean length.
inline double length(Vec3d a)
{
    return std::sqrt(dot(a, a));
}
/// Returns the unit vector of the same direction; the zero vector is returned unchanged.
inline Vec3d normalize(Vec3d a)
{
    const double l = length(a);
    return l > 0 ? a * (1 / l) : a;
}

/// Two floats, such as texture coordinates.
struct Vec2f {
    float x = 0, y = 0;  ///< Components of the vector.
};
/// Three floats, such as a vertex position or normal.
struct Vec3f {
    float x = 0, y = 0, z = 0;  ///< Components of the vector.
};
/// Four floats, such as a tangent or a color with alpha.
struct Vec4f {
    float x = 0, y = 0, z = 0, w = 0;  ///< Components of the vector.
};

/// Rounds each component to the nearest float.
inline Vec3f to_float(const Vec3d& v)
{
    return {float(v.x), float(v.y), float(v.z)};
}
/// Converts each component exactly.
inline Vec3d to_double(const Vec3f& v)
{
    return {v.x, v.y, v.z};
}

/// Color in linear Rec.709 (the primaries and white point of sRGB). Values above 1 are allowed.
struct Color {
    float r = 0, g = 0, b = 0;  ///< Red, green and blue.
    /// Compares components exactly.
    friend bool operator==(const Color&, const Color&) = default;
};

/// Affine map, stored as the upper three rows of a 4x4 matrix that multiplies column vectors. The default is the
/// identity.
struct FATHOM_API Transform {
    /// Matrix entries by row and column; the fourth column is the translation.
    std::array<std::array<double, 4>, 3> m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    /// Maps a point: the linear part and the translation are applied.
    Vec3d point(Vec3d p) const { return vector(p) + Vec3d{m[0][3], m[1][3], m[2][3]}; }
    /// Maps a vector: only the linear part is applied.
    Vec3d vector(Vec3d v) const
    {
        return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
    }
    /// Returns the map that applies b first and then a: `(a * b).point(p)` is `a.point(b.point(p))` up to rounding.
    friend FATHOM_API Transform operator*(const Transform& a, const Transform& b);
    /// Returns the determinant of the linear part; it is negative if the map mirrors, and 0 if it is singular.
    double determinant() const;
    /// Returns the inverse map. If the determinant is 0, all entries of the result are 0.
    Transform inverse() const;

    /// Returns a translation by t.
    static Transform translate(Vec3d t);
    /// Returns a scaling along the axes, by a factor for each.
    static Transform scale(Vec3d s);
    /// Returns a right-handed rotation about an axis through the origin.
    ///
    /// axis   Direction of the axis; it need not have unit length.
    /// angle  In radians.
    static Transform rotate(Vec3d axis, double angle);
    /// Returns the rotation by the quaternion (x, y, z, w), which is normalized first. The zero quaternion gives the
    /// identity.
    static Transform rotate_quaternion(double x, double y, double z, double w);
};

}  // namespace fathom
