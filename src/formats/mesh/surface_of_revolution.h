// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// A point of a profile curve in the (radius, z) plane, with its normal and texture coordinate v.
struct ProfilePoint {
    double radius, z, normal_radius, normal_z, v;
};

inline constexpr int sides_of_circle = 256;

/// Rotates a profile about z by angles from 0 to `phi_max` and returns triangles; u follows the angle.
///
/// Normals are those of the profile. Triangles face outward if the profile is ordered upward.
Mesh turned(const std::vector<ProfilePoint>& profile, double phi_max, int sides);

}  // namespace fathom
