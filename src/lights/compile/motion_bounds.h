// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "fathom/description.h"
#include "geometry/records.h"
#include "lights/tree/build_tree.h"

namespace fathom {

/// Cone of normals about an axis, by the cosine of its half angle. Default: all directions.
struct NormalCone {
    Vec3d axis;
    double cosine = -1;
};

/// A cone that contains all positive combinations of the directions; all directions if it would be wider than a
/// hemisphere.
NormalCone cone_around(const std::vector<Vec3d>& directions);

/// Bounds on the motion of points and directions that follow poses over the shutter interval, valid at every time. The
/// interval is sampled; between samples translation and stretch change linearly and the rotation at constant speed,
/// which bounds the deviation.
class LightMotionBounds {
public:
    explicit LightMotionBounds(std::span<const PoseRecord> poses);

    /// Whether all poses preserve shapes: no stretch but uniform scaling.
    bool keeps_shape() const { return keeps_shape_; }
    /// Mean scale factor of areas over the shutter interval, approximately.
    double mean_area_factor() const { return area_factor_; }
    /// Bounds the positions of a ball that moves with the poses.
    void set_bounding_ball(Vec3d center, double radius, LightExtent& to) const;
    /// Bounds the directions of a normal that moves with the poses.
    NormalCone cone(Vec3d normal) const;

private:
    /// A sampled time, and the largest change up to half of the way to its neighbors.
    struct Step {
        Transform place;
        double shift, turn, stretch;
    };
    std::vector<Step> steps_;
    double largest_stretch_ = 0, area_factor_ = 0;
    bool keeps_shape_ = true, turns_ = false;
};

}  // namespace fathom
