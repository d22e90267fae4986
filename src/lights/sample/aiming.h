// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/sphere.h"
#include "lights/records.h"
#include "lights/targets.h"
#include "sampling/inversion.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Aims light paths at LightTargets. A path follows its light's own emission or is aimed at one of the targets; its
/// density is that of all these choices together, as in one-sample multiple importance sampling with the balance
/// heuristic (Veach 1997, section 9.2.4).
class LightAiming {
public:
    /// targets: nullptr if paths follow the light's own emission only
    LightAiming(const LightTables& tables, const LightTargets* targets)
        : light_count_(std::uint32_t(tables.lights.size())),
          light_cdf_(targets ? targets->light_cdf.data() : tables.light_cdf.data()),
          targets_(targets)
    {
    }

    bool has_targets() const { return targets_ != nullptr; }

    /// A light, and what its path is aimed at.
    struct Choice {
        UInt target;  ///< number of a target, or no_index for the light's own emission
        UInt light;
    };
    Choice choose(Float u) const
    {
        UInt row(0u);
        if (targets_) {
            Float begin(0.f), share(targets_->own_share);
            float end = targets_->own_share;
            for (std::size_t k = 0; k < targets_->targets.size(); ++k) {
                const Mask beyond = u >= Float(end);
                row = select(beyond, UInt(std::uint32_t(k + 1)), row);
                begin = select(beyond, Float(end), begin);
                share = select(beyond, Float(targets_->targets[k].share), share);
                end += targets_->targets[k].share;
            }
            u = min((u - begin) / share, Float(0x1.fffffep-1f));
        }
        // The cumulative probabilities of a row have a last value of 1 behind those of the lights.
        const UInt first = row * UInt(light_count_ + 1);
        return {row - UInt(1u), find_interval(light_cdf_, first, int(light_count_), u)};
    }

    /// The target of each lane.
    struct Sphere {
        Vec3 center;
        Float radius;
        Mask valid;  ///< lanes that have a target
    };
    Sphere target(UInt number, Mask m) const
    {
        Sphere s{Vec3(Float(0), Float(0), Float(0)), Float(1), Mask(false)};
        for (std::size_t k = 0; targets_ && k < targets_->targets.size(); ++k) {
            const Mask mine = m & (number == UInt(std::uint32_t(k)));
            s.center = select(mine, center(k), s.center);
            s.radius = select(mine, Float(targets_->targets[k].radius), s.radius);
            s.valid |= mine;
        }
        return s;
    }

    /// A direction from p into the cone of directions towards a sphere; from inside, any direction.
    static Vec3 direction_to(const Sphere& s, const Vec3& p, Sample2 random)
    {
        const Vec3 to = s.center - p;
        const Float distance2 = max(dot(to, to), Float(1e-37f));
        return Frame(to * inverse_sqrt(distance2)).to_world(sample_cone(random, spread(s.radius, distance2)));
    }

    /// Density of emission from the point p of a light along d, by all choices, divided by that of the light's own
    /// emission. own_pdf: density of d in the latter with respect to solid angle. chosen: target that d was sampled
    /// for; rounding may put d beside its edge.
    Float ratio_from(UInt light, const Vec3& p, const Vec3& d, Float own_pdf, UInt chosen = UInt(no_index)) const
    {
        if (!targets_) return Float(1);
        Float sum(0.f);
        for_each_target(light, [&](std::size_t k, Float share) {
            const Mask known = chosen == UInt(std::uint32_t(k));
            const Vec3 to = center(k) - p;
            const float radius = targets_->targets[k].radius;
            const Float distance2 = max(dot(to, to), Float(1e-37f)), along = dot(to, d);
            const Vec3 across = fma(d, -along, to);
            const Mask inside = distance2 <= Float(radius * radius);
            const Mask passes = known | inside | ((dot(across, across) <= Float(radius * radius)) & (along > Float(0)));
            const Float pdf = Float(0.5f * inv_pi) / spread(Float(radius), distance2);
            sum = sum + select(passes, share * pdf, Float(0));
        });
        return Float(targets_->own_share) + sum / max(own_pdf, Float(1e-30f));
    }
    /// ratio_from() for light from infinity: density of the line through p along d. The light's own emission is
    /// uniform over a disk of this radius across its direction. covered: lanes whose line passes through that disk.
    Float ratio_of_line(UInt light, const Vec3& p, const Vec3& d, float disk_radius, Mask covered,
                        UInt chosen = UInt(no_index)) const
    {
        const Float own = select(covered, Float(1), Float(0));
        if (!targets_) return own;
        Float sum = own * Float(targets_->own_share);
        for_each_target(light, [&](std::size_t k, Float share) {
            const Vec3 to = center(k) - p, across = fma(d, -dot(to, d), to);
            const float radius = targets_->targets[k].radius, relative = disk_radius / radius;
            const Mask passes = (chosen == UInt(std::uint32_t(k))) | (dot(across, across) <= Float(radius * radius));
            sum = sum + select(passes, share * Float(relative * relative), Float(0));
        });
        return sum;
    }

private:
    /// 1 - cos of the angle that a sphere subtends; 2 from inside.
    static Float spread(Float radius, Float distance2)
    {
        const Float sin2 = radius * radius / distance2;
        return select(sin2 < Float(1), one_minus_cos_of(sin2), Float(2));
    }
    Vec3 center(std::size_t k) const
    {
        const float* const c = targets_->targets[k].center;
        return {Float(c[0]), Float(c[1]), Float(c[2])};
    }
    /// Calls f with the number of each target and the share of a light's paths that are aimed at it.
    template <class F>
    void for_each_target(UInt light, const F& f) const
    {
        for (std::size_t k = 0; k < targets_->targets.size(); ++k) {
            const float* const ratios = targets_->light_ratios.data() + k * light_count_;
            f(k, gather(ratios, light) * Float(targets_->targets[k].share));
        }
    }

    const std::uint32_t light_count_;
    const float* const light_cdf_;
    const LightTargets* const targets_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
