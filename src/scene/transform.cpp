// SPDX-License-Identifier: Apache-2.0
#include "fathom/vector.h"

namespace fathom {

Transform operator*(const Transform& a, const Transform& b)
{
    Transform r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) {
            double sum = j == 3 ? a.m[i][3] : 0;
            for (int k = 0; k < 3; ++k) sum += a.m[i][k] * b.m[k][j];
            r.m[i][j] = sum;
        }
    return r;
}

double Transform::determinant() const
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Transform Transform::inverse() const
{
    Transform r;
    const double d = determinant();
    const double s = d != 0 ? 1 / d : 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            // Cofactor (j, i): with cyclic indices of rows and columns no explicit sign is needed.
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
            r.m[i][j] = (m[a][c] * m[b][e] - m[a][e] * m[b][c]) * s;
        }
    for (int i = 0; i < 3; ++i) r.m[i][3] = -(r.m[i][0] * m[0][3] + r.m[i][1] * m[1][3] + r.m[i][2] * m[2][3]);
    return r;
}

Transform Transform::translate(Vec3d t)
{
    Transform r;
    r.m[0][3] = t.x;
    r.m[1][3] = t.y;
    r.m[2][3] = t.z;
    return r;
}

Transform Transform::scale(Vec3d s)
{
    Transform r;
    r.m[0][0] = s.x;
    r.m[1][1] = s.y;
    r.m[2][2] = s.z;
    return r;
}

Transform Transform::rotate(Vec3d axis, double angle)
{
    const Vec3d a = normalize(axis);
    const double s = std::sin(angle / 2);
    return rotate_quaternion(a.x * s, a.y * s, a.z * s, std::cos(angle / 2));
}

Transform Transform::rotate_quaternion(double x, double y, double z, double w)
{
    const double l = std::sqrt(x * x + y * y + z * z + w * w);
    if (l == 0) return {};
    x /= l, y /= l, z /= l, w /= l;
    Transform r;
    r.m = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
    return r;
}

}  // namespace fathom
