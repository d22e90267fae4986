// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "geometry/flat/flat.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Finds parallelepipeds of which at least four faces, two of them opposite, are quads of the scene.
///
/// used: by quad, whether it belongs to a box already; updated. tolerance: largest distance between corners that count
/// as equal.
std::vector<FlatScene::OrientedBox> find_oriented_boxes(const GeometryTables& tables, std::vector<bool>& used,
                                                        double tolerance);

}  // namespace FATHOM_LANES
}  // namespace fathom
