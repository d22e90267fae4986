#pragma once
#include <map>
#include <set>
#include <vector>

#include "fathom/description.h"
#include "fathom/memory.h"

namespace fathom {

/// Adds up what shapes take when they are compiled, while the tree is built over them, which is when most is needed.
/// Measured: docs/performance.md.
class ShapeNeeds {
public:
    ShapeNeeds(const SceneDescription& scene, TreeBuild build) : scene_(scene), build_(build) {}

    /// A shape in `places` places. mesh: what it is shown as, null if it is no mesh; emits: whether it is a light.
    void add(const Shape& shape, const Mesh* mesh, double places, bool emits);
    std::vector<MemoryEstimate> needs() const;

private:
    double triangle_bytes(const Mesh& mesh) const;
    double add_curves(const Curves& curves);
    double add_points(const Points& points);

    const SceneDescription& scene_;
    const TreeBuild build_;
    std::map<const Mesh*, double> places_of_;  ///< of meshes
    std::set<const void*> counted_;            ///< curves and points are there once
    double curves_ = 0, points_ = 0, places_ = 0, lights_ = 0;
};

}  // namespace fathom
