// SPDX-License-Identifier: Apache-2.0
#include "formats/common/lights.h"

#include <cmath>

namespace fathom {

Color scaled(Color c, double factor)
{
    const auto f = float(factor);
    return {c.r * f, c.g * f, c.b * f};
}

Transform rotation_from_z(Vec3d direction)
{
    const Vec3d w = normalize(direction);
    const Vec3d u = normalize(cross(std::abs(w.y) > 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, w)), v = cross(w, u);
    Transform t;
    const Vec3d columns[] = {u, v, w};
    for (std::size_t c = 0; c < 3; ++c) t.m[0][c] = columns[c].x, t.m[1][c] = columns[c].y, t.m[2][c] = columns[c].z;
    return t;
}

}  // namespace fathom
