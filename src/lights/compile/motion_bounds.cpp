// SPDX-License-Identifier: Apache-2.0
#include "lights/compile/motion_bounds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/motion.h"

namespace fathom {

namespace {

constexpr int steps_per_piece = 16;

Pose to_pose(const PoseRecord& r)
{
    Pose p;
    p.translation = {double(r.translation[0]), double(r.translation[1]), double(r.translation[2])};
    std::copy(std::begin(r.rotation), std::end(r.rotation), p.rotation.begin());
    std::copy(std::begin(r.stretch), std::end(r.stretch), p.stretch.begin());
    return p;
}

/// Upper bound on how much the symmetric matrix stretches a vector; exact for uniform scaling.
double norm(const std::array<double, 6>& s)
{
    const double off = s[1] * s[1] + s[2] * s[2] + s[4] * s[4];
    return std::max({std::abs(s[0]), std::abs(s[3]), std::abs(s[5])}) + std::sqrt(2 * off);
}

bool is_uniform(const std::array<double, 6>& s)
{
    const double tolerance = 1e-5 * std::abs(s[0]);
    return std::abs(s[3] - s[0]) <= tolerance && std::abs(s[5] - s[0]) <= tolerance && std::abs(s[1]) <= tolerance &&
           std::abs(s[2]) <= tolerance && std::abs(s[4]) <= tolerance;
}

}  // namespace

NormalCone cone_around(const std::vector<Vec3d>& directions)
{
    Vec3d sum;
    std::vector<Vec3d> units;
    for (const Vec3d& d : directions) {
        const double size = length(d);
        if (!(size > 0)) continue;
        units.push_back(d * (1 / size));
        sum = sum + units.back();
    }
    if (!(length(sum) > 0)) return {};
    NormalCone cone{normalize(sum), 1};
    for (const Vec3d& d : units) cone.cosine = std::min(cone.cosine, dot(d, cone.axis));
    return cone.cosine > 0 ? cone : NormalCone();
}

LightMotionBounds::LightMotionBounds(std::span<const PoseRecord> poses)
{
    for (const PoseRecord& pose : poses) {
        const Pose p = to_pose(pose);
        keeps_shape_ &= is_uniform(p.stretch);
        largest_stretch_ = std::max(largest_stretch_, norm(p.stretch));
    }
    for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
        const Pose a = to_pose(poses[i]), b = to_pose(poses[i + 1]);
        std::array<double, 6> change;
        double cosine = 0;
        for (std::size_t k = 0; k < 6; ++k) change[k] = b.stretch[k] - a.stretch[k];
        for (std::size_t k = 0; k < 4; ++k) cosine += a.rotation[k] * b.rotation[k];
        constexpr double half = 0.5 / steps_per_piece;
        // The angle between quaternions is half the angle of rotation.
        const double turn = half * 2 * std::acos(std::clamp(std::abs(cosine), 0.0, 1.0));
        turns_ |= turn > 1e-6;
        for (int k = 0; k < steps_per_piece; ++k) {
            const Transform place = interpolate(a, b, (k + 0.5) / steps_per_piece).transform();
            steps_.push_back({place, half * length(b.translation - a.translation), turn, half * norm(change)});
            area_factor_ += std::cbrt(std::pow(place.determinant(), 2));
        }
    }
    area_factor_ /= double(steps_.size());
}

void LightMotionBounds::set_bounding_ball(Vec3d center, double radius, LightExtent& to) const
{
    Vec3d lo, hi;
    bool is_first = true;
    for (const Step& s : steps_) {
        const Vec3d p = s.place.point(center);
        lo = is_first ? p : Vec3d{std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = is_first ? p : Vec3d{std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
        is_first = false;
    }
    to.center = (lo + hi) * 0.5;
    to.radius = 0;
    for (const Step& s : steps_) {
        const double way = s.shift + (s.turn * largest_stretch_ + s.stretch) * length(center);
        to.radius = std::max(to.radius, length(s.place.point(center) - to.center) + way);
    }
    to.radius += largest_stretch_ * std::abs(radius);
}

NormalCone LightMotionBounds::cone(Vec3d normal) const
{
    if (!keeps_shape_) return {};
    std::vector<Vec3d> directions;
    double turn = 0;
    for (const Step& s : steps_) {
        directions.push_back(s.place.vector(normal));
        if (turns_) turn = std::max(turn, s.turn);
    }
    NormalCone cone = cone_around(directions);
    if (turn > 0 && cone.cosine > 0) cone.cosine = std::cos(std::acos(std::min(cone.cosine, 1.0)) + turn);
    return cone.cosine > 0 ? cone : NormalCone();
}

}  // namespace fathom
