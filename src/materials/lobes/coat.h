// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Specular lobe of a clear coat, with a normal and a roughness of its own. Directions are in the frame of the base's
/// shading normal.
class CoatLobe {
public:
    explicit CoatLobe(const LayersPoint& l)
        : frame_(l.coat_normal),
          roughness_(l.coat_roughness),
          ggx_{max(l.coat_roughness * l.coat_roughness, Float(2 * min_alpha))},
          f0_(l.coat_f0),
          f90_(min(Float(50) * l.coat_f0, Float(1)))
    {
    }
    /// Directional albedo: the fraction of light from wo that the coat reflects, by the GGX tables.
    Float albedo(Vec3 wo) const
    {
        const Float cosine = max(dot(wo, frame_.n), Float(0));
        const Float e = ggx_albedo(cosine, roughness_), w = albedo_lookup(ggx_schlick_table, cosine, roughness_);
        return clamp(fma(f0_, e - w, f90_ * w), Float(0), Float(1));
    }
    /// BSDF times cosine (f_cos), and the solid angle density of sample.
    void eval(Vec3 wo, Vec3 wi, Float& f_cos, Float& pdf) const
    {
        const Vec3 o = frame_.to_local(wo), i = frame_.to_local(wi);
        const Vec3 h = normalize(o + i + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Mask valid = (o.z > Float(0)) & (i.z > Float(0));
        const Float d = ggx_.d(h) / (Float(4) * max(o.z, Float(1e-6f)));
        const Float f = fma(f90_ - f0_, schlick_weight(dot(o, h)), f0_);
        f_cos = select(valid, f * d * ggx_.g2(o, i), Float(0));
        pdf = select(valid, d * ggx_.g1(o), Float(0));
    }
    /// Samples wi by the visible normals of the coat. The direction can lie below the surface, where eval returns 0.
    Vec3 sample(Vec3 wo, Sample2 u) const
    {
        Vec3 o = frame_.to_local(wo);
        o.z = max(o.z, Float(1e-6f));
        return frame_.to_world(reflect(o, ggx_.sample(o, u)));
    }

private:
    Frame frame_;
    Float roughness_;
    Ggx ggx_;
    /// Schlick's approximation reflects everything at grazing angles, whatever the index. f90 fades to 0 with f0, so
    /// that a coat whose index is that of its surroundings reflects nothing (Lagarde, de Rousiers 2014, "Moving
    /// Frostbite to Physically Based Rendering").
    Float f0_, f90_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
