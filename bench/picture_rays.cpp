// SPDX-License-Identifier: Apache-2.0
#include "picture_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {

RayArrays RaySet::arrays(std::size_t first, std::size_t n) const
{
    return {&o[0][first],
            &o[1][first],
            &o[2][first],
            &d[0][first],
            &d[1][first],
            &d[2][first],
            &t_max[first],
            time.empty() ? nullptr : &time[first],
            n};
}

namespace {

constexpr float infinity_f = std::numeric_limits<float>::infinity();

class Maker {
public:
    Maker(const RayView& view, double diagonal) : view_(view), diagonal_(diagonal) {}

    RaySet primary(std::size_t parts)
    {
        RaySet set;
        set.kind = "primary";
        set.coherent = true;
        std::uint32_t side = 1;
        while (side < std::uint32_t(std::max(view_.width, view_.height))) side *= 2;
        std::size_t pixel = 0;
        for (std::uint64_t code = 0; code < std::uint64_t(side) * side; ++code) {
            const int x = compact(code), y = compact(code >> 1);
            if (x >= view_.width || y >= view_.height || pixel++ / 1024 % parts != 0) continue;
            const double sx = (2 * (x + uniform()) / view_.width - 1) * view_.half_width,
                         sy = (1 - 2 * (y + uniform()) / view_.height) * view_.half_height;
            const Vec3d across = view_.right * sx + view_.up * sy;
            if (view_.orthographic)
                add(set, view_.position + across, view_.forward, infinity_f);
            else
                add(set, view_.position, normalize(view_.forward + across), infinity_f);
        }
        finish(set);
        return set;
    }

    RaySet diffuse(const std::vector<RayPoint>& points, const char* kind, double reach, bool shadow)
    {
        RaySet set;
        set.kind = kind;
        set.shadow = shadow;
        for (const RayPoint& point : points) {
            const double z = 2 * uniform() - 1, phi = 2 * M_PI * uniform(), r = std::sqrt(std::max(0.0, 1 - z * z));
            const Vec3d d = point.n + Vec3d{r * std::cos(phi), r * std::sin(phi), z};
            add(set, start(point), length(d) > 1e-6 ? normalize(d) : point.n, float(reach));
        }
        finish(set);
        return set;
    }

    RaySet shadow(const std::vector<RayPoint>& points, const HitPoints& hit_points)
    {
        RaySet probe;
        add(probe, view_.position, view_.world_up, infinity_f);
        finish(probe);
        const std::vector<RayPoint> roof = hit_points(probe);
        const double above = roof.empty() ? diagonal_ : length(roof[0].p - view_.position);
        const double distance = std::min(above * 0.8, diagonal_), half = distance * 0.125;
        const Vec3d center = view_.position + view_.world_up * distance, side = view_.right * half,
                    other_side = cross(view_.world_up, view_.right) * half;
        RaySet set;
        set.kind = "shadow";
        set.shadow = set.coherent = true;
        for (const RayPoint& point : points) {
            const Vec3d lamp = center + side * (2 * uniform() - 1) + other_side * (2 * uniform() - 1);
            const Vec3d from = start(point), way = lamp - from;
            if (length(way) > 0) add(set, from, normalize(way), float(length(way) * 0.9999));
        }
        finish(set);
        return set;
    }

private:
    static int compact(std::uint64_t x)
    {
        x &= 0x5555555555555555u;
        x = (x | x >> 1) & 0x3333333333333333u;
        x = (x | x >> 2) & 0x0f0f0f0f0f0f0f0fu;
        x = (x | x >> 4) & 0x00ff00ff00ff00ffu;
        x = (x | x >> 8) & 0x0000ffff0000ffffu;
        return int((x | x >> 16) & 0xffffffffu);
    }
    double uniform()
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return double(state_ >> 11) * 0x1p-53;
    }
    /// Ray origin off the surface, to avoid self-intersection.
    Vec3d start(const RayPoint& point) const { return point.p + point.n * (diagonal_ * 1e-5); }
    static void add(RaySet& set, Vec3d o, Vec3d d, float t_max)
    {
        set.o[0].push_back(float(o.x)), set.o[1].push_back(float(o.y)), set.o[2].push_back(float(o.z));
        set.d[0].push_back(float(d.x)), set.d[1].push_back(float(d.y)), set.d[2].push_back(float(d.z));
        set.t_max.push_back(t_max);
    }
    static void finish(RaySet& set)
    {
        for (auto* a : {&set.o[0], &set.o[1], &set.o[2], &set.d[0], &set.d[1], &set.d[2], &set.t_max})
            a->resize(a->size() + RaySet::padding, 1.f);
    }

    const RayView& view_;
    double diagonal_;
    std::uint64_t state_ = 1;
};

}  // namespace

std::vector<RaySet> make_ray_sets(const RayView& view, double diagonal, const HitPoints& hit_points, std::size_t parts)
{
    Maker maker(view, diagonal);
    std::vector<RaySet> sets;
    sets.push_back(maker.primary(parts));
    const std::vector<RayPoint> first = hit_points(sets[0]);
    sets.push_back(maker.shadow(first, hit_points));
    sets.push_back(maker.diffuse(first, "bounce-1", infinity_f, false));
    const RaySet second = maker.diffuse(hit_points(sets[2]), "bounce-2", infinity_f, false);
    sets.push_back(maker.diffuse(hit_points(second), "bounce-3", infinity_f, false));
    sets.push_back(maker.diffuse(first, "occlusion", diagonal * 0.02, true));
    return sets;
}

}  // namespace fathom
