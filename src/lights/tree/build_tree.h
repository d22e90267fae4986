// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/vector.h"
#include "lights/records.h"

namespace fathom {

/// Bounds of a moving light over the shutter interval.
struct LightExtent {
    std::uint32_t light;
    Vec3d center;
    double radius;
    Vec3d axis;              ///< axis of its normals, or of a spot's directions
    double cos_turned = -1;  ///< cosine of the largest angle from the axis; -1: the light may emit in any direction
};

/// Builds the light tree over those of the first t.positioned_lights lights that emit, and sets their tree_place.
///
/// powers       powers of the lights; those of power 0 are left out
/// open, close  times between which spheres move
/// extents      bounds of lights that move in other ways, or whose records don't contain their position; by light
void build_light_tree(LightTables& t, const std::vector<double>& powers, double open, double close,
                      const std::vector<LightExtent>& extents = {});

}  // namespace fathom
