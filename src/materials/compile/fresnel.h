// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

namespace fathom {

/// Fresnel reflectance of a boundary to a medium of index ior, for unpolarized light.
inline double fresnel(double cosine, double ior)
{
    const double t = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (ior * ior)));
    const double p = (ior * cosine - t) / (ior * cosine + t), s = (cosine - ior * t) / (cosine + ior * t);
    return (p * p + s * s) / 2;
}

}  // namespace fathom
