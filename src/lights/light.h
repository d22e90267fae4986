// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Light sampling for all lanes, and the density of sampling a given point of a light, for multiple importance sampling
/// (MIS).
#include "lights/kinds/beam.h"
#include "lights/kinds/directional.h"
#include "lights/kinds/flat.h"
#include "lights/kinds/pictured.h"
#include "lights/kinds/rectangle.h"
#include "lights/kinds/sphere.h"
#include "lights/kinds/spot.h"
#include "lights/kinds/tube.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A sampled direction towards a light.
struct LightSample {
    Vec3 wi;  ///< unit, from the shading point towards the light
    Float distance;
    Float inverse_pdf;  ///< inverse density of wi with respect to solid angle, without the probability of choosing the
                        ///< light; 1 for delta lights; 0: no light arrives
    Spectrum radiance;  ///< unoccluded incident radiance (delta lights: irradiance at normal incidence)
    Mask is_delta;      ///< delta light, or one that BSDF sampling can't hit: MIS weight 1
    /// Lanes whose radiance must be multiplied by that of the environment along wi if the ray is unoccluded; see
    /// LightSampler.
    Mask needs_environment_radiance = Mask(false);
    Float likely = Float(1);  ///< approximate luminance of that environment radiance, before it is looked up
    UInt light = UInt(0u);    ///< index of the light
};

/// Returns the lanes whose light is of the wanted kind.
inline Mask is_kind(UInt kind, LightRecordKind wanted)
{
    return kind == UInt(std::uint32_t(wanted));
}

/// A list of light kinds. for_each calls f.template operator()<Kind>() for each of them.
template <class... Kind>
struct LightKindList {
    template <class F>
    [[gnu::always_inline]] static void for_each(F&& f)
    {
        (f.template operator()<Kind>(), ...);
    }
};

/// All light kinds except environments, which are sampled by their images (environment.h).
using LightKinds = LightKindList<RectangleLight, ParallelogramLight, TriangleLight, DiskLight, SphereLight, PointLight,
                                 SpotLight, DirectionalLight, PicturedLight, BeamLight, TubeLight>;

/// sample_light() for gangs with lights other than rectangles.
template <class Light>
[[gnu::noinline]] LightSample sample_any_light(const Light& light, Vec3 p, Float time, Sample2 random, Mask active)
{
    LightPoint s{{Float(0), Float(0), Float(1)}, Float(1), Float(1), Float(1), Float(1), Mask(false)};
    const UInt kind = light.kind();
    LightKinds::for_each([&]<class Kind>() {
        const Mask mine = is_kind(kind, Kind::Record::kind);
        if (none(mine)) return;
        const LightPoint point = Kind::sample(light, p, time, random, active & mine);
        s.wi = select(mine, point.wi, s.wi);
        s.distance = select(mine, point.distance, s.distance);
        s.inverse_pdf = select(mine, point.inverse_pdf, s.inverse_pdf);
        s.cosine = select(mine, point.cosine, s.cosine);
        s.strength = select(mine, point.strength, s.strength);
        s.is_delta |= mine & point.is_delta;
    });
    const Mask shines = (s.cosine > Float(0)) | light.has(LightRecord::two_sided);
    s.is_delta |= light.has(LightRecord::not_hit_by_rays);
    return {s.wi, s.distance, select(shines, s.inverse_pdf, Float(0)), light.radiance() * s.strength, s.is_delta};
}

/// Samples a point of the light as seen from p at shutter time `time`. Results are valid in active lanes only.
template <class Light>
[[gnu::always_inline]] inline LightSample sample_light(const Light& light, Vec3 p, Float time, Sample2 random,
                                                       Mask active)
{
    if (!all(is_kind(light.kind(), LightRecordKind::rectangle)))
        return sample_any_light(light, p, time, random, active);
    const auto point = RectangleLight::sample(light, p, time, random, active);
    const Mask shines = (point.cosine > Float(0)) | light.has(LightRecord::two_sided);
    return {point.wi, point.distance, select(shines, point.inverse_pdf, Float(0)), light.radiance(),
            light.has(LightRecord::not_hit_by_rays)};
}

/// Kinds of lights that rays never hit: Kind::sample_pdf(light, p, wi) is the density with respect to solid angle with
/// which their sample() returns the direction wi; 1 for delta lights.
template <class Kind, class Light>
concept is_never_hit = requires(const Light& light, Vec3 p) { Kind::sample_pdf(light, p, p); };

namespace detail {

template <class Kind, class Light>
concept HasAngularDensity = requires(const Light& light, Vec3 p) { Kind::by_solid_angle(light, p); };

/// Densities in lanes whose lights are not sampled uniformly by area; by_area in the other lanes.
template <class Light>
[[gnu::noinline]] Float pdf_by_solid_angle(const Light& light, Vec3 p, Float time, Float by_area, Mask by_solid_angle)
{
    Float pdf = by_area;
    LightKinds::for_each([&]<class Kind>() {
        if constexpr (HasAngularDensity<Kind, Light>) {
            const Mask mine = by_solid_angle & is_kind(light.kind(), Kind::Record::kind);
            if (any(mine)) pdf = select(mine, Kind::pdf(light, p, time, by_area), pdf);
        }
    });
    return pdf;
}

}  // namespace detail

/// Density with respect to solid angle at p with which sample_light returns the point p + distance * wi of an emissive
/// surface, without the probability of choosing the light. Valid in active lanes only.
template <class Light>
[[gnu::always_inline]] inline Float pdf_light(const Light& light, Vec3 p, Float time, Vec3 wi, Float distance,
                                              Mask active)
{
    const UInt kind = light.kind();
    const Float cosine = abs(dot(wi, light.get(&FlatLightRecord::normal))), area = light.get(&FlatLightRecord::area);
    const Float by_area = distance * distance * reciprocal(max(cosine * area, Float(1e-30f)));
    Mask by_solid_angle(false);
    LightKinds::for_each([&]<class Kind>() {
        if constexpr (detail::HasAngularDensity<Kind, Light>)
            by_solid_angle |= active & is_kind(kind, Kind::Record::kind) & Kind::by_solid_angle(light, p);
    });
    return any(by_solid_angle) ? detail::pdf_by_solid_angle(light, p, time, by_area, by_solid_angle) : by_area;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
