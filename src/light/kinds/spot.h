#pragma once
#include "light/kinds/point.h"

namespace fathom::inline FATHOM_LANES {

/// A point light whose intensity falls off from the inner to the outer cone.
struct SpotLight {
    static constexpr LightRecordKind kind = LightRecordKind::spot;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float time, Sample2 random, Mask active)
    {
        LightPoint s = PointLight::sample(light, p, time, random, active);
        // Linear in the cosine from the outer to the inner cone, squared as KHR_lights_punctual suggests. 1 - cos is
        // half the square of the chord, which keeps its digits where the cosine is nearly 1.
        const Vec3 chord = s.wi + light.edge_u();
        const Float inside = fma(dot(chord, chord), Float(-0.5f), light.outer());
        const Float x = clamp(inside / max(light.falloff(), Float(1e-30f)), Float(0), Float(1));
        s.strength = s.strength * x * x;
        return s;
    }
};

}  // namespace fathom::inline FATHOM_LANES
