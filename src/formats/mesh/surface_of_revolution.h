#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// A place of a profile, with its normal and the v of its texture coordinates.
struct ProfilePoint {
    double radius, z, normal_radius, normal_z, v;
};

inline constexpr int sides_of_circle = 256;

/// What a profile makes when it is turned about z, from angle 0 to `phi_max`, as triangles; u goes around. The normals
/// are the profile's, turned along, and so are the sides of triangles where the profile goes up outside.
Mesh turned(const std::vector<ProfilePoint>& profile, double phi_max, int sides);

}  // namespace fathom
