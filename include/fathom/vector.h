#pragma once
#include <array>
#include <cmath>

#include "fathom/api.h"

namespace fathom {

/// A point or direction of a scene description, in double: scenes are large and far from the origin.
struct Vec3d {
    double x = 0, y = 0, z = 0;

    friend Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3d operator-(Vec3d a) { return {-a.x, -a.y, -a.z}; }
    friend Vec3d operator*(Vec3d a, double s) { return {a.x * s, a.y * s, a.z * s}; }
    friend Vec3d operator*(double s, Vec3d a) { return a * s; }
    friend bool operator==(Vec3d a, Vec3d b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

inline double dot(Vec3d a, Vec3d b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3d cross(Vec3d a, Vec3d b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3d a)
{
    return std::sqrt(dot(a, a));
}
/// Zero stays zero.
inline Vec3d normalize(Vec3d a)
{
    const double l = length(a);
    return l > 0 ? a * (1 / l) : a;
}

struct Vec2f {
    float x = 0, y = 0;
};
struct Vec3f {
    float x = 0, y = 0, z = 0;
};
struct Vec4f {
    float x = 0, y = 0, z = 0, w = 0;
};

inline Vec3f to_float(const Vec3d& v)
{
    return {float(v.x), float(v.y), float(v.z)};
}
inline Vec3d to_double(const Vec3f& v)
{
    return {v.x, v.y, v.z};
}

/// Linear Rec.709 (the primaries of sRGB), not limited to 1.
struct Color {
    float r = 0, g = 0, b = 0;
    friend bool operator==(const Color&, const Color&) = default;
};

/// An affine map, as the upper three rows of a matrix that acts on column vectors: p' = m * (p, 1).
struct FATHOM_API Transform {
    std::array<std::array<double, 4>, 3> m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    Vec3d point(Vec3d p) const { return vector(p) + Vec3d{m[0][3], m[1][3], m[2][3]}; }
    Vec3d vector(Vec3d v) const
    {
        return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
    }
    /// `(a * b).point(p) == a.point(b.point(p))` up to rounding.
    friend FATHOM_API Transform operator*(const Transform& a, const Transform& b);
    double determinant() const;
    /// The inverse map; the identity's zero matrix if the map is singular.
    Transform inverse() const;

    static Transform translate(Vec3d t);
    static Transform scale(Vec3d s);
    /// Right-handed rotation about an axis through the origin. axis need not be unit; angle in radians.
    static Transform rotate(Vec3d axis, double angle);
    /// Rotation by the unit quaternion (x, y, z, w); it is normalised first.
    static Transform rotate_quaternion(double x, double y, double z, double w);
};

}  // namespace fathom
