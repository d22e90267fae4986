// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parameters of FuzzMetalBsdf, with textures applied: see FuzzMetalRecord.
struct FuzzMetalPoint : MaterialPoint {
    using Record = FuzzMetalRecord;
    Float fuzz;  ///< radius of the ball around the mirror direction

    void read(const ParameterReader<Record>& r) { fuzz = r.get(&Record::fuzz); }
};

/// The metal of "Ray Tracing in One Weekend": the mirror direction plus fuzz times a random point of the unit ball.
/// Directions below the surface are absorbed.
///
/// The density has a closed form: along wi, the integral of r^2 over the part of the ray that lies in the ball of
/// radius fuzz about the mirror direction, divided by the ball's volume. Therefore lights can be sampled, without
/// changing the look of the original.
class FuzzMetalBsdf : public ClosureOf<ClosureKind::fuzz_metal, FuzzMetalPoint> {
public:
    explicit FuzzMetalBsdf(const FuzzMetalPoint& m) : color_(m.base_color), fuzz_(clamp(m.fuzz, Float(0), Float(1)))
    {
        is_mirror_ = fuzz_ < Float(1e-3f);
    }
    Mask has_non_delta() const { return !is_mirror_; }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Float p = select((wi.z > Float(0)) & has_non_delta(), pdf(wo, wi), Float(0));
        return {color_ * p, p};
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        // A uniform point of the unit ball has a distance from the center that is the cube root of a uniform number.
        const Float z = fma(u.x, Float(-2), Float(1));
        const Float s = sqrt(max(fma(-z, z, Float(1)), Float(0)));
        const SinCos phi = sincos_2pi(u.y);
        const Float r = select(is_mirror_, Float(0), fuzz_ * pow(u1, Float(1.0f / 3)));
        const Vec3 mirror{-wo.x, -wo.y, wo.z};
        const Vec3 wi = normalize(fma(Vec3{s * phi.cos, s * phi.sin, z}, r, mirror));
        return {wi, color_ * select(wi.z > Float(0), Float(1), Float(0)), pdf(wo, wi), is_mirror_, Float(1)};
    }

private:
    Float pdf(Vec3 wo, Vec3 wi) const
    {
        const Vec3 mirror{-wo.x, -wo.y, wo.z};
        const Float b = dot(mirror, wi);
        const Vec3 off = mirror - wi * b;
        const Float root2 = fma(fuzz_, fuzz_, -dot(off, off));
        const Float root = sqrt(max(root2, Float(0)));
        const Float far = b + root, near = max(b - root, Float(0));
        const Float f3 = max(fuzz_ * fuzz_ * fuzz_, Float(1e-12f));
        const Float p = (far * far * far - near * near * near) / (Float(4 * pi) * f3);
        return select((root2 > Float(0)) & (far > Float(0)), p, Float(0));
    }

    Spectrum color_;
    Float fuzz_;
    Mask is_mirror_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
