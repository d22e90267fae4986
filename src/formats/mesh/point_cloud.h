#pragma once
#include <string>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Balls of points that a file gives without a size: of a radius with which points that are spread evenly over a
/// surface as large as the box around them just touch, 1 cm for a single one. Points that are not finite are left out,
/// with a warning: there may be none left.
///
/// file  for warnings
Points fitting_points(std::vector<Vec3f> points, const std::string& file, Warnings& warnings);

/// Lines that a file gives without a width: round, of a radius of a thousandth of the diagonal of the box around them,
/// 1 cm where that is nothing. As fitting_points without points that are not finite.
///
/// counts  of the points of each line
Curves fitting_lines(const std::vector<Vec3f>& points, const std::vector<std::uint32_t>& counts,
                     const std::string& file, Warnings& warnings);

/// Adds them as a node at the root, if there are some.
void add_point_cloud(SceneDescription& scene, Points cloud);

}  // namespace fathom
