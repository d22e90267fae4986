#pragma once
/// The rays of a picture, kind by kind, to measure with. Nothing here knows who casts them.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fathom/vector.h"
#include "geometry/bvh/bvh.h"

namespace fathom {

struct RaySet {
    std::string kind;
    bool shadow = false;    ///< it only matters whether they hit anything
    bool coherent = false;  ///< neighbours keep together
    std::vector<float> o[3], d[3], t_max;
    std::vector<float> time;  ///< none: all at 0

    std::size_t count() const { return t_max.size() - padding; }
    RayArrays arrays(std::size_t first, std::size_t n) const;
    static constexpr std::size_t padding = 64;
};

/// A camera: axes of unit length, and half the picture's extent at distance 1 or, if orthographic, everywhere; and
/// where it is up in the world.
struct RayView {
    Vec3d position, right, up, forward, world_up;
    double half_width = 1, half_height = 1;
    bool orthographic = false;
    int width = 1920, height = 1080;
};

/// Where a ray met something, and the normal there, towards where it came from.
struct RayPoint {
    Vec3d p, n;
};
/// The points that rays hit, in the order of the rays, without those that hit nothing.
using HitPoints = std::function<std::vector<RayPoint>(const RaySet&)>;

/// primary, shadow, bounce-1, bounce-3, occlusion, in Morton order of the pixels; where nothing is hit there are none.
/// Shadow rays go towards a square lamp above the camera, below whatever is there; occlusion rays as far as a fiftieth
/// of the scene's diagonal. With `parts` > 1 only every so many runs of 1024 pixels.
std::vector<RaySet> make_ray_sets(const RayView& view, double diagonal, const HitPoints& hit_points, std::size_t parts);

}  // namespace fathom
