#pragma once
#include <vector>

#include "fathom/vector.h"
#include "lights/records.h"

namespace fathom {

/// Where a light is, at some time or other while the shutter is open.
struct LightExtent {
    std::uint32_t light;
    Vec3d center;
    double radius;
    Vec3d axis;              ///< the middle of its normals, or of a spot's directions
    double cos_turned = -1;  ///< how far from there they go; -1: the light may shine anywhere
};

/// Makes the light tree over the first t.placed_lights lights, and notes in each its place there.
///
/// powers  of the lights, above 0
/// open, close  times between which spheres move
/// extents  of the lights that move otherwise, and of those whose records don't tell where they are
void build_light_tree(LightTables& t, const std::vector<double>& powers, double open, double close,
                      const std::vector<LightExtent>& extents = {});

}  // namespace fathom
