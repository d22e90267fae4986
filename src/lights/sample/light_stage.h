// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera_paths.h"
#include "lights/environment/environment.h"
#include "lights/kinds/curve_light.h"
#include "lights/kinds/moving_light.h"
#include "lights/kinds/picture.h"
#include "lights/tree/selector.h"
#include "materials/opacity.h"
#include "materials/read/material.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Inverse density of a light sample times its MIS weight (power heuristic) against a strategy of density pdf.
[[gnu::always_inline]] inline Float light_weight(const LightSample& s, Float pdf)
{
    const Float r = pdf * s.inverse_pdf;
    return select(s.is_delta, Float(1), Float(1) / fma(r, r, Float(1))) * s.inverse_pdf;
}

/// Next event estimation: selects a light, then samples a point of it.
class LightSampler {
public:
    /// defer_environment: samples of the environment light leave its radiance to the caller, to be evaluated for
    /// unoccluded rays only; in interiors hardly any are.
    LightSampler(const LaneScene& scene, LightSelection selection, bool defer_environment)
        : scene_(scene),
          tables_(scene.tables),
          surfaces_(scene),
          materials_(scene),
          selector_(scene.tables, selection),
          leaves_environment_(defer_environment)
    {
        is_alone_ = tables_.lights.size() == 1 && tables_.environment.light == no_index &&
                    tables_.lights[0].material == no_index && !scene.has(Feature::moving_lights) &&
                    !scene.has(Feature::curve_lights) && !scene.has(Feature::light_pictures);
    }

    /// Samples a point of the only light, or of a selected one; the density includes the probability of selection.
    ///
    /// key, seed  random numbers of the bounce, for the selection
    /// random     random numbers for the point
    [[gnu::always_inline]] LightSample sample(Mask valid, Vec3 eye, const SampleKey& key, UInt seed, Sample2 random,
                                              Float time) const
    {
        // The index of the only light is 0.
        if (is_alone_)
            return sample_light(LightReader<true>(tables_.lights.data(), UInt(0u)), eye, time, random, valid);
        return choose(valid, eye,
                      selector_.select(eye, sample_2d(key, pair_seed(seed, pair_choice)).y,
                                       sample_hash(key, pair_seed(seed, pair_light_tree)), valid),
                      random, time);
    }

    /// Environment radiance of rays that leave the scene along d, with its MIS weight, for the lanes of m. specular:
    /// lanes with weight 1; pdf: density with which d was sampled.
    Spectrum environment(const KernelBackground& background, bool lights_are_sampled, Vec3 d, Mask from_camera,
                         Mask specular, Float pdf, Mask m) const
    {
        const Mask behind = background.given ? m & from_camera : Mask(false);
        if (none(m & !behind)) return Spectrum(background.radiance);
        Spectrum radiance =
            select(behind, Spectrum(background.radiance), environment_radiance(tables_, d, m & !behind));
        if (lights_are_sampled && tables_.environment.light != no_index && any(m & !specular)) {
            const Float pmf(selector_.pmf(tables_.environment.light));
            radiance = radiance * select(specular, Float(1), mis_weight(pdf, pmf * environment_pdf(tables_, d)));
        }
        return radiance;
    }

    /// MIS weight of emission that BSDF sampling found on a surface along d, for the lanes of m. pdf: density of d; o:
    /// origin of the ray.
    template <class Light>
    [[gnu::always_inline]] Float emission_weight(const Light& light, const Vec3& o, Float time, const Vec3& d,
                                                 Float distance, Float pdf, Mask m) const
    {
        return mis_weight(pdf, density(light, o, time, d, distance, m));
    }

    /// emission_weight() for lights given by index, which may move or be curves. u: curve parameter of the hit.
    Float emission_weight_of(UInt light, const Vec3& o, Float time, const Vec3& d, Float distance, Float u, Float pdf,
                             Mask m) const
    {
        return mis_weight(pdf, density_of(light, o, time, d, distance, u, m));
    }

    /// Density with respect to solid angle at o with which a light is chosen and sampled along d, for points of
    /// surfaces that rays hit.
    template <class Light>
    [[gnu::always_inline]] Float density(const Light& light, const Vec3& o, Float time, const Vec3& d, Float distance,
                                         Mask m) const
    {
        return selector_.pmf(light, o, m) * pdf_light(light, o, time, d, distance, m);
    }
    /// density() for lights given by index, which may move or be curves. u: of the hit.
    Float density_of(UInt light, const Vec3& o, Float time, const Vec3& d, Float distance, Float u, Mask m) const
    {
        const LightReader<false> record(tables_.lights.data(), light);
        if (!any_moves(record, m) && none(curves(record, m))) return density(record, o, time, d, distance, m);
        return selector_.pmf(record, o, m) * pdf_special(record, o, time, d, distance, u, m);
    }
    /// Density of the environment along d.
    Float environment_density(const Vec3& d) const
    {
        if (tables_.environment.light == no_index) return Float(0);
        return Float(selector_.pmf(tables_.environment.light)) * environment_pdf(tables_, d);
    }
    /// density_of() for all kinds of lights but curves: for those that rays do not hit, the reciprocal of
    /// LightSample::inverse_pdf.
    Float any_density_of(UInt light, const Vec3& o, Float time, const Vec3& d, Float distance, Mask m) const
    {
        const LightReader<false> record(tables_.lights.data(), light);
        const UInt kind = record.kind();
        Float pdf = pdf_special(record, o, time, d, distance, Float(0), m);
        with_placed(record, time, m, [&](const auto& placed) {
            LightKinds::for_each([&]<class Kind>() {
                if constexpr (is_never_hit<Kind, decltype(placed)>) {
                    const Mask mine = m & is_kind(kind, Kind::Record::kind);
                    if (any(mine)) pdf = select(mine, Kind::sample_pdf(placed, o, d), pdf);
                }
            });
        });
        const Mask environment = m & is_kind(kind, LightRecordKind::environment);
        if (any(environment)) pdf = select(environment, environment_pdf(tables_, d), pdf);
        return selector_.pmf(record, o, m) * pdf;
    }
    /// Lanes of m whose light rays do not hit, so that only light samples find it.
    Mask is_unhittable(UInt light, Mask m) const
    {
        const LightReader<false> record(tables_.lights.data(), light);
        Mask never_hit = record.has(LightRecord::not_hit_by_rays);
        LightKinds::for_each([&]<class Kind>() {
            if constexpr (is_never_hit<Kind, LightReader<false>>)
                never_hit |= is_kind(record.kind(), Kind::Record::kind);
        });
        return m & never_hit;
    }
    /// Calls f with the light as it is at a shutter time.
    template <class F>
    void with_placed(const LightReader<false>& light, Float time, Mask m, const F& f) const
    {
        if (any_moves(light, m))
            f(MovingLight(light, tables_, time, m));
        else
            f(light);
    }

    /// Factor of a light's intensity by its image, for light that travels along -wi; 1 in lanes outside m.
    template <class Light>
    [[gnu::noinline]] Spectrum picture_at(const Light& light, const Vec3& wi, Mask m) const
    {
        using Record = PicturedLightRecord;
        const Float right = -dot(wi, light.get(&Record::right)), up = -dot(wi, light.get(&Record::top)),
                    along = -dot(wi, light.get(&SpotLightRecord::axis));
        const Spectrum factor = light_picture(tables_, light.get(&Record::picture), right, up, along, m);
        return select(m, factor, Spectrum(Float(1)));
    }

    /// Factor of a light's radiance at a point of its surface: its emission texture times its alpha; 1 in lanes outside
    /// m.
    template <class Light>
    Spectrum factor_at(const Light& light, UInt material, const Surface& surface, UInt primitive, Mask m) const
    {
        const UInt texture = materials_.get(&MaterialRecord::emission_texture, material, m);
        const Texel t = evaluate_textures(tables_, texture, surface.at, m);
        Spectrum factor;
        // Only flat primitives are alpha-tested; round ones are opaque.
        const Mask flat = m & less(primitive, UInt(tables_.first_sphere()));
        // Lights that no ray hits have an alpha of 0, which does not dim them.
        const Mask masked = flat & !light.has(LightRecord::not_hit_by_rays);
        const Float stopped = opacity(tables_, material, surface.at, masked);
        for (int c = 0; c < channels; ++c) factor.c[c] = select(m, t.c[c] * stopped, Float(1));
        return factor;
    }

    /// The hit of a ray on the surface of a light.
    template <class Light>
    static SurfaceHit hit_on(const Light& light, const Vec3& from, const Vec3& wi, Float distance, Float time)
    {
        SurfaceHit hit;
        hit.o = from;
        hit.d = wi;
        hit.t = distance;
        hit.time = time;
        hit.primitive = light.primitive();
        hit.instance = light.instance();
        // Triangle lights store the barycentric coordinates of the point; other kinds compute texture coordinates from
        // the position.
        using Triangle = TriangleLightRecord;
        const Vec3 r = fma(wi, distance, from) - light.get(&Triangle::corner);
        const Vec3 u = light.get(&Triangle::edge_u), v = light.get(&Triangle::edge_v);
        const Vec3 n = cross(u, v);
        const Float scale = Float(1) / max(dot(n, n), Float(1e-30f));
        hit.u = dot(cross(r, v), n) * scale;
        hit.v = dot(cross(u, r), n) * scale;
        return hit;
    }

private:
    bool any_moves(const LightReader<false>& light, Mask m) const
    {
        return scene_.has(Feature::moving_lights) && any(m & (light.motion_flags() != UInt(0u)));
    }
    Mask curves(const LightReader<false>& light, Mask m) const
    {
        return scene_.has(Feature::curve_lights) ? m & is_kind(light.kind(), LightRecordKind::curve) : Mask(false);
    }
    [[gnu::noinline]] Float pdf_special(const LightReader<false>& light, const Vec3& o, Float time, const Vec3& d,
                                        Float distance, Float u, Mask m) const
    {
        const Float pdf = pdf_light(MovingLight(light, tables_, time, m), o, time, d, distance, m);
        const Mask curve = curves(light, m);
        if (none(curve)) return pdf;
        const CurveLight segment(tables_, light.primitive(), light.instance(), time, curve);
        return select(curve, segment.pdf(o, d, distance, u), pdf);
    }

    [[gnu::noinline]] LightSample choose(Mask valid, Vec3 eye, LightSelector::Choice choice, Sample2 random,
                                         Float time) const
    {
        const LightReader<false> light(tables_.lights.data(), choice.light);
        return any_moves(light, valid) ? sample_moving(light, valid, eye, choice, random, time)
                                       : sample_chosen(light, valid, eye, choice, random, time);
    }
    [[gnu::noinline]] LightSample sample_moving(const LightReader<false>& light, Mask valid, Vec3 eye,
                                                LightSelector::Choice choice, Sample2 random, Float time) const
    {
        return sample_chosen(MovingLight(light, tables_, time, valid), valid, eye, choice, random, time);
    }
    template <class Light>
    LightSample sample_chosen(const Light& light, Mask valid, Vec3 eye, LightSelector::Choice choice, Sample2 random,
                              Float time) const
    {
        const Mask environment = is_kind(light.kind(), LightRecordKind::environment);
        const bool only_environment = none(valid & !environment);
        LightSample s = only_environment ? LightSample{} : sample_light(light, eye, time, random, valid);
        if (any(valid & environment)) {
            const EnvironmentSample e = sample_environment(tables_, random);
            s.wi = select(environment, e.wi, s.wi);
            s.distance = select(environment, Float(infinity), s.distance);
            s.inverse_pdf = select(environment, e.inverse_pdf, s.inverse_pdf);
            const Spectrum radiance =
                leaves_environment_ ? Spectrum(Float(1)) : environment_radiance(tables_, e, valid & environment);
            s.radiance = select(environment, radiance, s.radiance);
            s.is_delta = s.is_delta & !environment;
            s.needs_environment_radiance = environment & Mask(leaves_environment_);
            s.likely = select(s.needs_environment_radiance, e.likely, Float(1));
        }
        const Mask curve = curves(light, valid);
        Float along(0.f);
        if (any(curve)) along = sample_curves(light, eye, time, random, s, curve);
        if (scene_.has(Feature::textured_lights)) {
            const UInt material = light.material();
            const Mask varied = valid & (material != UInt(no_index));
            if (any(varied)) s.radiance = s.radiance * factor_at(light, material, eye, s, time, {along, curve}, varied);
        }
        if (scene_.has(Feature::light_pictures)) {
            const Mask pictured = valid & is_kind(light.kind(), LightRecordKind::pictured);
            if (any(pictured)) s.radiance = s.radiance * picture_at(light, s.wi, pictured);
        }
        s.inverse_pdf = s.inverse_pdf / choice.pmf;
        s.light = choice.light;
        return s;
    }

    /// Samples lights that are curves, in the lanes of m; returns the curve parameters of the points.
    [[gnu::noinline]] Float sample_curves(const LightReader<false>& light, const Vec3& eye, Float time, Sample2 random,
                                          LightSample& s, Mask m) const
    {
        const CurveLight segment(tables_, light.primitive(), light.instance(), time, m);
        const CurveLight::Sample c = segment.sample(eye, random);
        s.wi = select(m, c.wi, s.wi);
        s.distance = select(m, c.distance, s.distance);
        s.inverse_pdf = select(m, c.inverse_pdf, s.inverse_pdf);
        return c.u;
    }

    /// Curve parameters of sampled points on curve lights.
    struct AlongCurves {
        Float u;
        Mask m;
    };

    /// Factor of a light's radiance at the sampled point: its emission texture times its alpha.
    template <class Light>
    Spectrum factor_at(const Light& light, UInt material, Vec3 from, const LightSample& s, Float time,
                       const AlongCurves& curves, Mask m) const
    {
        SurfaceHit hit = hit_on(light, from, s.wi, s.distance, time);
        hit.u = select(curves.m, curves.u, hit.u);
        return factor_at(light, material, surfaces_.read(hit, m), hit.primitive, m);
    }
    const LaneScene& scene_;
    const SceneTables& tables_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    const LightSelector selector_;
    const bool leaves_environment_;
    bool is_alone_;  ///< whether there is only one light, of constant radiance
};

}  // namespace FATHOM_LANES
}  // namespace fathom
