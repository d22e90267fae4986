// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Spheres for points without radii. The radius makes points that are spread evenly over a surface as large as the
/// bounding box just touch; it is 1 cm for a single point. Points that are not finite are removed with a warning, so
/// the result may be empty.
///
/// file  name of the file, for warnings
Points fitting_points(std::vector<Vec3f> points, const std::string& file, Warnings& warnings);

/// Round curves for lines without a width. The radius is 1/1000 of the diagonal of the bounding box, or 1 cm if that is
/// 0. Points that are not finite are removed, as by fitting_points.
///
/// counts  number of points of each line
Curves fitting_lines(const std::vector<Vec3f>& points, const std::vector<std::uint32_t>& counts,
                     const std::string& file, Warnings& warnings);

/// Adds the points as a root node, if there are any.
void add_point_cloud(SceneDescription& scene, Points cloud);

}  // namespace fathom
