#pragma once
#include <vector>

#include "geometry/flat/flat.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parallelepipeds whose faces are parallelograms of the scene: four at least, of which two lie opposite to each other.
///
/// used: by parallelogram, those that are not free; the faces of what is found are marked. tolerance: how far apart
/// corners may lie that are one.
std::vector<FlatScene::OrientedBox> find_oriented_boxes(const GeometryTables& tables, std::vector<bool>& used,
                                                        double tolerance);

}  // namespace FATHOM_LANES
}  // namespace fathom
