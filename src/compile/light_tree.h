#pragma once
#include <vector>

#include "light/records.h"

namespace fathom {

/// Makes the light tree over the first t.placed_lights lights, and notes in each its place there.
///
/// powers  of the lights, above 0
/// open, close  times between which spheres move
void build_light_tree(LightTables& t, const std::vector<double>& powers, double open, double close);

}  // namespace fathom
