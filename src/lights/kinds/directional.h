// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Light from infinity, from one direction or a disk of directions; rays can't hit it.
struct DirectionalLight {
    using Record = DirectionalLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3, Float, Sample2 random, Mask)
    {
        const Float spread = light.get(&Record::one_minus_cos);
        const Vec3 wi = Frame(-light.get(&Record::axis)).to_world(sample_cone(random, spread));
        return {wi,       Float(infinity), select(spread <= Float(0), Float(1), Float(2 * pi) * spread),
                Float(1), Float(1),        Mask(true)};
    }

    template <class Light>
    static Float sample_pdf(const Light& light, const Vec3&, const Vec3&)
    {
        return Float(1) / solid_angle(light.get(&Record::one_minus_cos));
    }

    /// A direction without a point: LightEmitter places rays from infinity.
    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2, Sample2 direction)
    {
        const Float spread = light.get(&Record::one_minus_cos);
        const Vec3 d = Frame(light.get(&Record::axis)).to_world(sample_cone(direction, spread));
        return {Vec3(Float(0), Float(0), Float(0)), d, Vec3(Float(0), Float(0), Float(0)), solid_angle(spread),
                Float(0)};
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3& wi, Float)
    {
        const Float spread = light.get(&Record::one_minus_cos);
        // A delta light's direction needs no test: only its own samples ask.
        const Mask inside =
            (spread <= Float(0)) | (Float(1) + dot(wi, light.get(&Record::axis)) <= spread * Float(1.0001f));
        return {select(inside, Float(1) / solid_angle(spread), Float(0)), Float(0)};
    }

private:
    static Float solid_angle(Float spread)
    {
        return select(spread <= Float(0), Float(1), Float(2 * pi) * max(spread, Float(1e-30f)));
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
