// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/sample/aiming.h"
#include "lights/sample/light_stage.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Emission of light paths: chooses a light, a point of it and a direction, by its power or aimed at targets. Light
/// from infinity starts on a disk across its direction that covers the scene or a target. Curves emit nothing here.
class LightEmitter {
public:
    /// targets: nullptr if light paths are not aimed
    LightEmitter(const LaneScene& scene, const LightSampler& lights, const LightTargets* targets)
        : tables_(scene.tables),
          scene_(scene),
          surfaces_(scene),
          lights_(lights),
          aiming_(scene.tables, targets),
          ball_center_(Float(tables_.ball_center[0]), Float(tables_.ball_center[1]), Float(tables_.ball_center[2])),
          ball_radius_(tables_.ball_radius)
    {
    }

    /// Uniform numbers for one emission each.
    struct Random {
        Float light;
        Sample2 position, direction;
    };
    /// The start of a light path.
    struct Emission {
        UInt light;
        Vec3 o, d;
        Spectrum power;  ///< along the ray, per density; 0: nothing is emitted
    };
    Emission emit(const Random& random, Float time, Mask m) const
    {
        const LightAiming::Choice choice = aiming_.choose(random.light);
        Emission e = emit_from(choice, random.position, random.direction, time, m);
        e.power = e.power * (Float(1) / LightReader<false>(tables_.lights.data(), choice.light).pmf());
        return e;
    }
    /// emit() from given lights, per density of position and direction alone.
    Emission emit_from(LightAiming::Choice choice, Sample2 position, Sample2 direction, Float time, Mask m) const
    {
        Emission e;
        e.light = choice.light;
        const LightAiming::Sphere target = aiming_.target(choice.target, m);
        const LightReader<false> light(tables_.lights.data(), e.light);
        const UInt kind = light.kind();
        const Vec3 zero(Float(0), Float(0), Float(0));
        EmittedRay ray{zero, Vec3(Float(0), Float(0), Float(1)), zero, Float(0), Float(0)};
        e.power = light.radiance();
        lights_.with_placed(light, time, m, [&](const auto& placed) {
            LightKinds::for_each([&]<class Kind>() {
                const Mask mine = m & is_kind(kind, Kind::Record::kind);
                if (none(mine)) return;
                EmittedRay own = Kind::emit(placed, time, position, direction);
                aim<Kind>(placed, choice, target, direction, own);
                ray = select(mine, own, ray);
            });
            e.o = ray.o;
            leave_surface(placed, ray, time, m, e);
            if (const Mask pictured = m & is_kind(kind, LightRecordKind::pictured); any(pictured))
                e.power = e.power * lights_.picture_at(placed, -ray.d, pictured);
        });
        const Mask environment = m & is_kind(kind, LightRecordKind::environment);
        if (any(environment)) {
            const EnvironmentSample s = sample_environment(tables_, direction);
            ray.d = select(environment, -s.wi, ray.d);
            ray.scale = select(environment, s.inverse_pdf, ray.scale);
            e.power = select(environment, environment_radiance(tables_, s, environment), e.power);
        }
        if (const Mask far = is_infinite(kind, m); any(far)) {
            const Vec3 center = select(target.valid, target.center, ball_center_);
            const Float radius = select(target.valid, target.radius, Float(ball_radius_));
            const DiskPoint disk = sample_disk(position);
            const Frame frame(ray.d);
            const Vec3 p = center + fma(frame.s, disk.x * radius, frame.t * (disk.y * radius));
            const Float along = dot(p - ball_center_, ray.d);
            e.o = select(far, p - ray.d * (along + Float(1.01f * ball_radius_)), e.o);
            const Float ratio = aiming_.ratio_of_line(e.light, p, ray.d, ball_radius_, covers(p, ray.d), choice.target);
            ray.scale = select(far, ray.scale * Float(pi * ball_radius_ * ball_radius_) / ratio, ray.scale);
        }
        e.d = ray.d;
        e.power = e.power * ray.scale;
        return e;
    }

    /// Density with which emit() starts a path that comes to o along -wi, in the measure of light_tracing.h: per area
    /// and solid angle, divided by the cosine at the light; for lights without a surface per unit of area across the
    /// path at o. 0 where emit() finds no path.
    Float density(UInt index, const Vec3& o, const Vec3& wi, Float distance, Float time, Mask m) const
    {
        const LightReader<false> light(tables_.lights.data(), index);
        const UInt kind = light.kind();
        const EmissionDensity own = own_density(index, wi, distance, time, m);
        Float density = own.ray;
        const Mask environment = m & is_kind(kind, LightRecordKind::environment);
        if (any(environment)) density = select(environment, environment_pdf(tables_, wi), density);
        if (const Mask far = is_infinite(kind, m); any(far)) {
            const Float ratio = aiming_.ratio_of_line(index, o, wi, ball_radius_, covers(o, wi));
            const float area = pi * ball_radius_ * ball_radius_;
            density = select(far, density * ratio * Float(1 / area), density);
        }
        const Mask near = m & !is_infinite(kind, m);
        if (aiming_.has_targets() && any(near)) {
            const Float ratio = aiming_.ratio_from(index, fma(wi, distance, o), -wi, own.direction);
            density = select(near, density * ratio, density);
        }
        return density * light.pmf();
    }

    /// Density by the kind of the light alone.
    EmissionDensity own_density(UInt index, const Vec3& wi, Float distance, Float time, Mask m) const
    {
        const LightReader<false> light(tables_.lights.data(), index);
        const UInt kind = light.kind();
        EmissionDensity density{Float(0), Float(0)};
        lights_.with_placed(light, time, m, [&](const auto& placed) {
            LightKinds::for_each([&]<class Kind>() {
                const Mask mine = m & is_kind(kind, Kind::Record::kind);
                if (none(mine)) return;
                const EmissionDensity own = Kind::emission_density(placed, wi, distance);
                density.ray = select(mine, own.ray, density.ray);
                density.direction = select(mine, own.direction, density.direction);
            });
        });
        return density;
    }

    /// Whether light that comes along -wi is gathered from photons of caustics. Where an environment is not much
    /// brighter than elsewhere, path tracing finds its light with less noise than photons, which are rare there.
    Mask makes_caustics(UInt index, const Vec3& wi, Mask m) const
    {
        const Mask environment =
            m & is_kind(LightReader<false>(tables_.lights.data(), index).kind(), LightRecordKind::environment);
        if (none(environment)) return m;
        return m & (!environment | (environment_pdf(tables_, wi) > Float(least_caustic_density)));
    }

    bool is_infinite(std::uint32_t light) const
    {
        return tables_.lights[light].kind == std::uint32_t(LightRecordKind::environment) ||
               tables_.lights[light].kind == std::uint32_t(LightRecordKind::directional);
    }

private:
    /// Ten times the density with which a diffuse surface samples its normal.
    static constexpr float least_caustic_density = 10 * inv_pi;

    static Mask is_infinite(UInt kind, Mask m)
    {
        return m & (is_kind(kind, LightRecordKind::environment) | is_kind(kind, LightRecordKind::directional));
    }
    /// Whether a line passes through the disk across it that covers the scene.
    Mask covers(const Vec3& p, const Vec3& d) const
    {
        const Vec3 from = p - ball_center_, across = fma(d, -dot(from, d), from);
        return dot(across, across) < Float(0.9999f * ball_radius_ * ball_radius_);
    }

    /// Turns rays towards their target, if they have one, and divides by their density relative to that of the light's
    /// own emission.
    template <class Kind, class Light>
    void aim(const Light& light, const LightAiming::Choice& choice, const LightAiming::Sphere& target,
             Sample2 direction, EmittedRay& ray) const
    {
        // Light from infinity is aimed where its rays are placed.
        if (!aiming_.has_targets() || Kind::Record::kind == LightRecordKind::directional) return;
        if constexpr (can_be_aimed<Kind, Light>)
            if (any(target.valid)) {
                EmittedRay aimed = ray;
                Kind::aim(light, aimed, LightAiming::direction_to(target, ray.o, direction));
                ray = select(target.valid, aimed, ray);
            }
        ray.scale = ray.scale / aiming_.ratio_from(choice.light, ray.o, ray.d, ray.pdf, choice.target);
    }

    /// Moves the start of rays from surfaces in front of their surface, and applies the surface's emission texture and
    /// opacity.
    template <class Light>
    void leave_surface(const Light& light, const EmittedRay& ray, Float time, Mask m, Emission& e) const
    {
        const Mask on_surface = m & (light.primitive() != UInt(no_index)) & (dot(ray.n, ray.n) > Float(0.5f));
        if (none(on_surface)) return;
        // The surface is read as if a ray along -d had hit it.
        const Float distance = Float(1);
        const Vec3 from = fma(ray.d, distance, ray.o);
        const SurfaceHit hit = LightSampler::hit_on(light, from, -ray.d, distance, time);
        const Surface s = surfaces_.read(hit, on_surface);
        e.o = select(on_surface, fma(flip_sign(s.ng, dot(s.ng, ray.d)), s.offset, s.p), e.o);
        if (!scene_.has(Feature::textured_lights)) return;
        const Mask varied = on_surface & (light.material() != UInt(no_index));
        if (any(varied)) e.power = e.power * lights_.factor_at(light, light.material(), s, hit.primitive, varied);
    }

    const SceneTables& tables_;
    const LaneScene& scene_;
    const SurfaceReader surfaces_;
    const LightSampler& lights_;
    const LightAiming aiming_;
    const Vec3 ball_center_;
    const float ball_radius_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
