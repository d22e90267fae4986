#pragma once
#include <string>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Adds points that a file gives without a size, as a node with balls: of a radius with which points that are spread
/// evenly over a surface as large as the box around them just touch, 1 cm for a single one. Points that are not finite
/// are a warning.
///
/// file  for warnings
void add_point_cloud(SceneDescription& scene, std::vector<Vec3f> points, const std::string& name,
                     const std::string& file, Warnings& warnings);

}  // namespace fathom
