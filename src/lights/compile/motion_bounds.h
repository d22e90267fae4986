#pragma once
#include <span>
#include <vector>

#include "fathom/description.h"
#include "geometry/records.h"
#include "lights/tree/build_tree.h"

namespace fathom {

/// Bounds of normals: no farther from the axis than an angle. No axis: they may point anywhere.
struct NormalCone {
    Vec3d axis;
    double cosine = -1;
};

/// The cone of directions that are positive sums of these: at most half a turn wide, else anything.
NormalCone cone_around(const std::vector<Vec3d>& directions);

/// Where poses take what they carry while the shutter is open, in bounds that hold it at every time. Between times that
/// are looked at, translation and stretch change linearly and the rotation steadily: so far, at most, anything goes.
class LightMotionBounds {
public:
    explicit LightMotionBounds(std::span<const PoseRecord> poses);

    /// Whether round things remain round.
    bool keeps_shape() const { return keeps_shape_; }
    /// Of areas, about.
    double mean_area_factor() const { return area_factor_; }
    /// Around a ball that is carried along.
    void put_ball(Vec3d center, double radius, LightExtent& to) const;
    NormalCone cone(Vec3d normal) const;

private:
    /// A time looked at, and how much changes from there until half of the way to its neighbours, before and after.
    struct Step {
        Transform place;
        double shift, turn, stretch;
    };
    std::vector<Step> steps_;
    double largest_stretch_ = 0, area_factor_ = 0;
    bool keeps_shape_ = true, turns_ = false;
};

}  // namespace fathom
