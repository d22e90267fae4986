// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <set>
#include <vector>

#include "fathom/description.h"
#include "fathom/memory.h"

namespace fathom {

/// Estimates the memory that shapes take at its peak, during BVH construction. Measurements: docs/performance.md.
class ShapeMemory {
public:
    ShapeMemory(const SceneDescription& scene, BvhQuality build) : scene_(scene), build_(build) {}

    /// Adds a shape with `places` occurrences. mesh: its mesh, displaced if its material has displacement; null for
    /// other kinds; emits: whether it is a light.
    void add(const Shape& shape, const Mesh* mesh, double places, bool emits);
    /// The estimates, by kind.
    std::vector<MemoryEstimate> needs() const;

private:
    double triangle_bytes(const Mesh& mesh) const;
    double add_curves(const Curves& curves);
    double add_points(const Points& points);

    const SceneDescription& scene_;
    const BvhQuality build_;
    std::map<const Mesh*, double> places_of_;  ///< occurrences per mesh
    std::set<const void*> counted_;            ///< curves and points already counted: occurrences share them
    double curves_ = 0, points_ = 0, places_ = 0, lights_ = 0;
};

}  // namespace fathom
