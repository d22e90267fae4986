#pragma once
#include <cstdint>
#include <vector>

#include "fathom/description.h"

/// Shapes as triangles.
namespace fathom::pbrt {

/// What a profile of radii and heights makes when it is turned about z, from angle 0 to `phi_max`; u goes around, v
/// along the profile. The normals are the profile's, turned along.
struct ProfilePoint {
    double radius, z, normal_radius, normal_z, v;
};
Mesh turned(const std::vector<ProfilePoint>& profile, double phi_max, int sides);

/// Loop's subdivision (C. Loop: Smooth Subdivision Surfaces Based on Triangles, 1987), at last moved to the limit.
Mesh loop_subdivided(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int levels);

}  // namespace fathom::pbrt
