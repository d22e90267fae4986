// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sets of rays by kind, as in rendering an image, for measurements. They don't depend on the ray caster.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fathom/vector.h"
#include "geometry/bvh/bvh.h"

namespace fathom {

/// Rays of one kind, as arrays.
struct RaySet {
    std::string kind;
    bool shadow = false;    ///< occlusion test only
    bool coherent = false;  ///< neighboring rays are similar
    std::vector<float> o[3], d[3], t_max;
    std::vector<float> time;  ///< empty: all at time 0

    std::size_t count() const { return t_max.size() - padding; }
    RayArrays arrays(std::size_t first, std::size_t n) const;
    static constexpr std::size_t padding = 64;
};

/// A camera: unit axes, half the image's extent at distance 1 (orthographic: everywhere), and the world's up direction.
struct RayView {
    Vec3d position, right, up, forward, world_up;
    double half_width = 1, half_height = 1;
    bool orthographic = false;
    int width = 1920, height = 1080;
};

/// A hit point, with the normal on the side of the ray's origin.
struct RayPoint {
    Vec3d p, n;
};
/// Points that rays hit, in the order of the rays, without those that hit nothing.
using HitPoints = std::function<std::vector<RayPoint>(const RaySet&)>;

/// Ray sets primary, shadow, bounce-1, bounce-3, occlusion, in Morton order of the pixels; rays that hit nothing have
/// no successors. Shadow rays go towards a square lamp above the camera, below any geometry above it; occlusion rays
/// reach a fiftieth of the scene's diagonal. With `parts` > 1 only one in `parts` runs of 1024 pixels is used.
std::vector<RaySet> make_ray_sets(const RayView& view, double diagonal, const HitPoints& hit_points, std::size_t parts);

}  // namespace fathom
