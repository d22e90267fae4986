// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/direct.h"
#include "integrate/stages/dispersion.h"
#include "integrate/stages/path_medium.h"
#include "integrate/stages/path_recorder.h"
#include "integrate/stages/scatter.h"
#include "integrate/stages/shadow.h"
#include "integrate/stages/walk.h"
#include "kernel/kernel.h"
#include "lights/sample/light_stage.h"
#include "media/albedo.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Shading stage: at each surface vertex, next event estimation and sampling of the next direction.
class ShadeStage {
public:
    ShadeStage(const LaneScene& scene, const KernelSettings& settings, KernelCounters& counters, StageClock& clock,
               PathRecorder& recorder)
        : scene_(scene),
          tables_(scene.tables),
          surfaces_(scene),
          materials_(scene),
          lights_(scene, settings.light_selection, !scene.is_flat),
          settings_(settings),
          counters_(counters),
          clock_(clock),
          recorder_(recorder),
          lights_are_sampled_(settings.light_sampling && !tables_.lights.empty()),
          has_light_chance_(settings.skips_light_samples()),
          has_time_(scene.tables.moving)
    {
    }

    /// Shades paths that are sorted by closure kind. kind_end: end of each ClosureKind in the pool.
    void run(PathPool& paths, const HitColumns& hits, const std::size_t* kind_end)
    {
        paths_ = &paths, hits_ = &hits;
        shadows_.clear();
        std::size_t begin = 0;
        for (std::uint32_t kind = 0; kind < closure_kind_count; ++kind) {
            const std::size_t end = kind_end[kind];
            if (begin < end)
                Closures::visit(ClosureKind(kind), [&]<class Closure>() {
                    for (std::size_t i = begin; i < end; i += lanes) {
                        const std::size_t next = i + fetched_ahead;
                        if (next < end)
                            surfaces_.fetch_vertices(&hits.primitive.data[next],
                                                     std::min<std::size_t>(lanes, end - next));
                        shade<Closure>(i, first_lanes(end - i));
                    }
                });
            begin = end;
        }
        clock_.enter(RenderStage::shadow);
        counters_.costs.clear_shadow_rays += shadows_.trace(scene_, paths, settings_, clock_);
    }

private:
    /// Lanes of m that sample a light at this vertex.
    Mask samples_light(std::size_t i, Mask m) const
    {
        return has_light_chance_ ? m & (paths_->nee_probability.load(i) > Float(0)) : m;
    }

    /// Random numbers of a gang for its next bounce.
    struct Randomness {
        SampleKey key;
        UInt state, bounce, seed;
        UInt index;  ///< shuffled sample index; light samples and directions share it because they never enter one
                     ///< product
        Randomness(const PathPool& p, std::size_t i, bool has_steps)
            : key{p.pixel_hash.load(i), p.reversed_index.load(i)},
              state(p.state.load(i)),
              bounce(state & UInt(PathPool::bounce_mask)),
              seed(group_seed(key, (bounce + UInt(1u)) | (has_steps ? after(p.walk_steps.load(i)) : UInt(0u)))),
              index(shuffled_index(key, seed))
        {
        }
        /// Scattering events within media use groups of random dimensions of their own.
        static UInt after(UInt steps) { return select(steps == UInt(0u), UInt(0u), steps << 16 | UInt(1u << 31)); }
    };

    /// Next event estimation for each path of a gang, then its next direction.
    template <class Closure>
    [[gnu::always_inline]] void shade(std::size_t i, Mask valid)
    {
        clock_.enter(RenderStage::surface);
        count_vertices(counters_, valid);
        PathPool& p = *paths_;
        const auto [key, state, bounce, seed, index] = Randomness(p, i, scene_.open_media);
        const Float time = has_time_ ? p.time.load(i) : Float(0);
        const SurfaceHit hit{p.origin.load(i),
                             p.direction.load(i),
                             hits_->t.load(i),
                             hits_->u.load(i),
                             hits_->v.load(i),
                             time,
                             hits_->primitive.load(i),
                             scene_.is_flat ? UInt(no_index) : hits_->instance.load(i),
                             scene_.has_mixtures ? hits_->material.load(i) : UInt(no_index)};
        MediumStack media;
        if (scene_.tracks_media) media = p.media.load(i);
        ShadingPoint<Closure> at = read_shading_point<Closure>(surfaces_, materials_, hit,
                                                               scene_.tracks_media ? &media : nullptr, valid, clock_);
        Spectrum throughput = p.throughput.load(i);
        if (scene_.one_sided && !Closure::transmits) throughput = black_on_back(at, throughput, valid);
        if constexpr (is_layered<Closure> && Closure::transmits) choose_channel(key, seed, at.material, throughput);
        const Closure closure(at.material);
        clock_.enter(RenderStage::light);
        const Guidance guidance = guide(closure, at, key, seed, valid);
        if (lights_are_sampled_) {
            const Mask samples = samples_light(i, valid);
            counters_.costs.light_samples += std::uint64_t(count(samples));
            if (any(samples))
                sample_light<Closure>(i, samples, closure, at, guidance, key, seed, index, throughput, time);
        }

        clock_.enter(RenderStage::scatter);
        Scattered next = scatter(closure, at, guidance, key, seed, index, throughput);
        UInt next_state = (state & UInt(~PathPool::specular)) + UInt(1u);
        next_state = next_state | select(next.is_delta, UInt(PathPool::specular), UInt(PathPool::scattered));
        Mask undeflected(false), no_bounce(false);
        if (Closure::kind == ClosureKind::glass && scene_.transmissive_shadows)
            pass_interface(i, at, next.wi, valid & (hit.material == UInt(no_index)), state, next_state, undeflected,
                           no_bounce);
        Float eta_scale(1.f);
        if (scene_.refracts) {
            eta_scale = p.eta_scale.load(i) * next.eta * next.eta;
            p.eta_scale.store(i, eta_scale, valid);
        }
        if (Closure::transmits && scene_.tracks_media) {
            MediumStack beyond = at.media_beyond;
            if constexpr (is_layered<Closure>) beyond = select(next.enters_subsurface, at.media_below, beyond);
            p.media.store(i, select(dot(next.wi, at.ng) < Float(0), beyond, at.media), valid);
            if constexpr (is_layered<Closure>)
                if (scene_.textured_media) store_subsurface_medium(i, valid & next.enters_subsurface, at);
        }
        if (scene_.scatters_inside && !scene_.open_media) p.walk_steps.store(i, UInt(0u), valid);
        Roulette roulette = roulette_by_throughput(settings_, bounce, eta_scale, next.throughput);
        if (guidance.is_on()) {
            const Float chance = mean(throughput * at.material.base_color) * guidance.survival_factor();
            roulette = efficiency_roulette(guidance.known(), chance, bounce, roulette);
        }
        roulette.plays &= !no_bounce;
        Mask ends = apply_roulette(roulette, key, seed, next.throughput);
        // A path that could only continue through a null interface and did not is finished.
        if (Closure::kind == ClosureKind::glass && scene_.transmissive_shadows)
            ends |= !no_bounce & !may_scatter(settings_, bounce);
        next_state = select(ends, next_state | UInt(PathPool::dead), next_state);
        Float exit_offset = at.exit_offset(next.wi);
        // Lights are sampled at this vertex with a probability only; dividing by it scales their density in the MIS
        // weight.
        Float mis_pdf = next.pdf;
        if (has_light_chance_) mis_pdf = mis_pdf / abs(p.nee_probability.load(i));
        if (Closure::kind == ClosureKind::glass && scene_.transmissive_shadows) {
            mis_pdf = select(undeflected, p.bsdf_pdf.load(i), mis_pdf);
            exit_offset =
                select(undeflected, p.exit_offset.load(i) + dot(at.start(next.wi) - hit.o, hit.d), exit_offset);
        }
        if (Closure::is_guided && recorder_.is_on())
            recorder_.record_directions(p.number.load(i), bounce, at.frame.n, next.wi, next.pdf, next.throughput,
                                        valid & !ends & !next.is_delta);
        p.origin.store(i, at.start(next.wi), valid);
        p.direction.store(i, next.wi, valid);
        p.throughput.store(i, next.throughput, valid);
        p.bsdf_pdf.store(i, mis_pdf, valid);
        if (scene_.has_exit_offset) p.exit_offset.store(i, exit_offset, valid);
        p.state.store(i, next_state, valid);
    }

    /// Determines the paths that continue undeflected through a pane or open boundary, as shadow rays do, and the next
    /// state of those for which that is no bounce: their flags of previous scattering stay. m: lanes whose material was
    /// not chosen by a mixture.
    template <class Closure>
    [[gnu::noinline]] void pass_interface(std::size_t i, const ShadingPoint<Closure>& at, const Vec3& wi, Mask m,
                                          UInt state, UInt& next_state, Mask& undeflected, Mask& no_bounce)
    {
        const PassedInterface there = classify_interface(scene_, materials_, at.material_index, at.skips_interface, m);
        undeflected = (there.pane & (dot(wi, at.ng) < Float(0))) | there.open;
        no_bounce = there.no_bounce & undeflected;
        next_state = select(undeflected, state + UInt(1u), next_state);
        if (!scene_.open_media) return;
        // Passing an open boundary counts as a step, so that the next vertex uses new random numbers.
        const UInt step = paths_->walk_steps.load(i) + UInt(1u);
        paths_->walk_steps.store(i, step, no_bounce);
        const UInt over = select(less(step, UInt(MediumStage::max_steps)), UInt(0u), UInt(PathPool::dead));
        next_state = select(no_bounce, state | over, next_state);
    }

    /// Throughput set to 0 on the back of one-sided surfaces.
    template <class Closure>
    Spectrum black_on_back(const ShadingPoint<Closure>& at, const Spectrum& throughput, Mask valid) const
    {
        const LaneFeatures features = materials_.features(at.material_index, valid & at.inside);
        const Mask black = at.inside & features.has(MaterialFeature::one_sided);
        return select(black, Spectrum(Float(0)), throughput);
    }

    /// Stores the coefficients of the subsurface medium that paths enter, from the color and radius textures at the
    /// point of entry.
    template <class Closure>
    void store_subsurface_medium(std::size_t i, Mask enters, const ShadingPoint<Closure>& at)
    {
        if (none(enters)) return;
        const UInt medium = materials_.get(&MaterialRecord::subsurface_medium, at.material_index, enters);
        const Float anisotropy = gather(tables_.media, &MediumRecord::anisotropy, medium, enters);
        const LayersPoint& layers = at.material.layers;
        paths_->walk_albedo.store(i, scattering_albedo(layers.subsurface_color, anisotropy), enters);
        Spectrum extinction;
        for (int k = 0; k < channels; ++k)
            extinction.c[k] = Float(1) / max(layers.subsurface_radius.c[k], Float(min_mean_free_path));
        paths_->walk_extinction.store(i, extinction, enters);
    }

    /// Guiding distribution at the vertices; off if the closure cannot use it.
    template <class Closure>
    [[gnu::always_inline]] Guidance guide(const Closure& closure, const ShadingPoint<Closure>& at, const SampleKey& key,
                                          UInt seed, Mask valid) const
    {
        if constexpr (Closure::is_guided)
            if (settings_.guiding) {
                const Vec3 noise = guiding_noise(sample_hash(key, pair_seed(seed, pair_guiding)));
                return {*settings_.guiding, at.p, at.frame.n, noise, closure.guided_weight(), valid};
            }
        return {};
    }

    /// Next event estimation: adds the light sample's contribution, or queues its shadow ray.
    template <class Closure>
    [[gnu::always_inline]] void sample_light(std::size_t i, Mask valid, const Closure& closure,
                                             const ShadingPoint<Closure>& at, const Guidance& guidance,
                                             const SampleKey& key, UInt seed, UInt index, const Spectrum& throughput,
                                             Float time)
    {
        // Lights are sampled from the origin of the shadow ray. Sampled from the surface itself, a light that passes
        // through the surface, or a distance that ends behind it, would depend on rounding.
        const Vec3 eye = at.eye();
        const Sample2 random = sample_2d(index, pair_seed(seed, pair_light));
        LightSample s = lights_.sample(valid, eye, key, seed, random, time);
        if (has_light_chance_) s.inverse_pdf = s.inverse_pdf / abs(paths_->nee_probability.load(i));
        Mask lit = valid & (s.inverse_pdf > Float(0));
        Spectrum add = direct_light(closure, at, guidance, s, throughput, lit);
        MediumStack media;
        if (scene_.tracks_media) {
            const Mask beyond = Closure::transmits ? dot(s.wi, at.ng) < Float(0) : Mask(false);
            media = select(beyond, at.media_beyond, at.media);
        }
        if (scene_.has_absorption && !scene_.transmissive_shadows)
            add = add * transmittance(extinction_of(scene_, *paths_, i, media.current(), lit), s.distance);
        lit &= any_positive(add);
        if (guidance.is_on()) roulette_shadow_ray(guidance, mean(add) * s.likely, key, seed, add, lit);
        if (none(lit)) return;
        counters_.count_rays(RayKind::shadow, std::uint64_t(count(lit)));
        const Ray ray = shadow_ray(at, eye, s, time);
        if (!scene_.is_flat) {
            const UInt path = iota() + UInt(std::uint32_t(i));
            if (scene_.transmissive_shadows)
                shadows_.push(ray, add, media, path, s.needs_environment_radiance, lit);
            else
                shadows_.push(ray, add, path, s.needs_environment_radiance, lit);
            return;
        }
        PathPool& p = *paths_;
        clock_.enter(RenderStage::shadow);
        const Mask clear = lit & !scene_.flat.occluded(tables_, ray, lit);
        counters_.costs.clear_shadow_rays += std::uint64_t(count(clear));
        if (settings_.clamp_indirect > 0) add = clamped(i, add, clear);
        p.radiance.store(i, p.radiance.load(i) + select(clear, add, Spectrum(Float(0))), valid);
    }

    /// Russian roulette for shadow rays: keeps lanes of `lit` by chance and scales up their contributions. brings:
    /// estimated contribution of the light sample if unoccluded.
    static void roulette_shadow_ray(const Guidance& guidance, Float brings, const SampleKey& key, UInt seed,
                                    Spectrum& light, Mask& lit)
    {
        const Float chance = guidance.shadow_ray_probability(brings, lit);
        lit &= sample_hash(key, pair_seed(seed, pair_shadow_chance)) < chance;
        light = light * (Float(1) / chance);
    }

    /// Applies the indirect clamp (indirect_clamp.h) to the contribution of a light sample.
    [[gnu::noinline]] Spectrum clamped(std::size_t i, Spectrum light, Mask m)
    {
        const UInt surfaces = (paths_->state.load(i) & UInt(PathPool::bounce_mask)) + UInt(1u);
        return light * indirect_scale(*paths_, iota() + UInt(std::uint32_t(i)), surfaces, light, m);
    }

    /// Vertices of hits are prefetched this many paths ahead.
    static constexpr std::size_t fetched_ahead = 32;

    const LaneScene& scene_;
    const SceneTables& tables_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    const LightSampler lights_;
    const KernelSettings& settings_;
    KernelCounters& counters_;
    StageClock& clock_;
    PathRecorder& recorder_;
    bool lights_are_sampled_, has_light_chance_, has_time_;

    PathPool* paths_ = nullptr;
    const HitColumns* hits_ = nullptr;
    ShadowQueue shadows_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
