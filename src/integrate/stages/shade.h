// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/caustic_gathering.h"
#include "integrate/stages/direct.h"
#include "integrate/stages/dispersion.h"
#include "integrate/stages/light_tracing.h"
#include "integrate/stages/path_medium.h"
#include "integrate/stages/path_profiler.h"
#include "integrate/stages/path_recorder.h"
#include "integrate/stages/scatter.h"
#include "integrate/stages/shadow.h"
#include "integrate/stages/walk.h"
#include "kernel/camera_connection.h"
#include "kernel/kernel.h"
#include "lights/sample/emission.h"
#include "media/albedo.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Shading stage: at each surface vertex, next event estimation and sampling of the next direction.
class ShadeStage {
public:
    ShadeStage(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings,
               KernelCounters& counters, StageClock& clock, PathRecorder& recorder, PathProfiler& profiler)
        : scene_(scene),
          tables_(scene.tables),
          surfaces_(scene),
          materials_(scene),
          lights_(scene, settings.light_selection, !scene.is_flat),
          emitter_(scene, lights_, settings.light_targets),
          connector_(camera, settings),
          gathering_(settings.caustics, settings),
          settings_(settings),
          counters_(counters),
          clock_(clock),
          recorder_(recorder),
          profiler_(profiler),
          lights_are_sampled_(settings.light_sampling && !tables_.lights.empty()),
          has_light_chance_(settings.skips_light_samples()),
          light_paths_(float(settings.light_paths))
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
            if (profiler_.is_on()) profiler_.charge(paths, begin, end);
            begin = end;
        }
        clock_.enter(RenderStage::shadow);
        counters_.costs.clear_shadow_rays += shadows_.trace(scene_, paths, settings_, clock_);
        if (profiler_.is_on()) profiler_.charge_shadow_rays(paths, begin);
    }

private:
    /// A gang of paths at a vertex: `lanes` consecutive paths of the pool.
    struct Gang {
        std::size_t i;  ///< index of the first path in the pool
        Mask valid;     ///< lanes that have a path
        UInt state;     ///< PathPool::state on arrival
        UInt bounce;    ///< number of bounces before this one
        VertexRandom random;
        Float time;
    };
    /// Next PathPool::state of each path, and the paths that continue undeflected through a pane or open boundary.
    struct Passage {
        UInt state;
        Mask undeflected{false};
        Mask no_bounce{false};  ///< lanes of `undeflected` for which passing does not count as a bounce
    };

    /// Shades a vertex of each path of a gang: next event estimation, BSDF sampling, Russian roulette.
    template <class Closure>
    [[gnu::always_inline]] void shade(std::size_t i, Mask valid)
    {
        clock_.enter(RenderStage::surface);
        count_vertices(counters_, valid);
        const Gang gang = load_gang(i, valid);
        const SurfaceHit hit = load_hit(scene_, *paths_, *hits_, i);
        MediumStack media;
        if (scene_.has(Feature::media_stacks)) media = paths_->media.load(i);
        ShadingPoint<Closure> at = read_shading_point<Closure>(
            surfaces_, materials_, hit, scene_.has(Feature::media_stacks) ? &media : nullptr, valid, clock_);
        const Spectrum throughput = arriving_throughput(gang, at);
        const Closure closure(at.material);
        clock_.enter(RenderStage::light);
        const Guidance guidance = guide(closure, at, gang);
        const FirstVertex first = first_vertex(gang, hit, at);
        if (lights_are_sampled_) estimate_direct_light(gang, closure, at, guidance, throughput, first);
        const Mask gathers = gathering_.is_on() ? gather_caustics(gang, closure, at, throughput) : Mask(false);

        clock_.enter(RenderStage::scatter);
        Scattered next = scatter(closure, at, guidance, gang.random, throughput);
        const Passage passage = pass_interface(gang, hit, at, next);
        const Float eta_scale = update_eta_scale(gang, next);
        enter_media(gang, at, next);
        Roulette roulette = roulette_by_throughput(settings_, gang.bounce, eta_scale, next.throughput);
        if (guidance.is_on()) {
            const Float chance = expected_throughput(throughput, at.material.base_color) * guidance.survival_factor();
            roulette = efficiency_roulette(guidance.known(), chance, gang.bounce, roulette);
        }
        const Mask ends = play_roulette<Closure>(gang, passage, roulette, next.throughput);
        if constexpr (Closure::is_guided)
            if (recorder_.is_on())
                recorder_.record_directions(
                    paths_->number.load(i), gang.bounce,
                    {at.frame.n, next.wi, next.pdf, next.scatter_pdf, next.throughput,
                     expected_throughput(throughput, at.material.base_color), closure.guided_weight()},
                    valid & !ends & !next.is_delta);
        if (profiler_.is_on()) profile_scattering<Closure>(gang, at, next, passage.undeflected);
        paths_->state.store(i, select(ends, passage.state | UInt(PathPool::dead), passage.state), valid);
        store_next_ray(gang, hit, at, next, passage.undeflected);
        if (light_paths_ > 0) store_connection(gang, at, next, first, passage.undeflected);
        if (gathering_.is_on()) store_gathered(gang, at, next, gathers, passage.undeflected);
    }

    /// Adds the photons of caustics in the lanes whose path light tracing cannot find. Returns these lanes.
    template <class Closure>
    [[gnu::noinline]] Mask gather_caustics(const Gang& gang, const Closure& closure, const ShadingPoint<Closure>& at,
                                           const Spectrum& throughput)
    {
        // Light paths end at fibers, so photons are never there.
        if constexpr (Closure::is_fiber) return Mask(false);
        PathPool& p = *paths_;
        const Mask m = gang.valid & (p.connection.load(gang.i) >= Float(infinity));
        if (none(m)) return m;
        const UInt sample = reverse_bits(gang.random.key.reversed_index);
        Spectrum add = throughput * gathering_.gather(closure, at, sample, gang.bounce, m);
        if (settings_.clamp_indirect > 0) add = clamped(gang.i, add, m);
        p.radiance.store(gang.i, p.radiance.load(gang.i) + select(m, add, Spectrum(Float(0))), m);
        return m;
    }
    /// Stores PathPool::gathered of paths that leave a vertex, where the lanes of `gathers` have gathered photons.
    template <class Closure>
    [[gnu::noinline]] void store_gathered(const Gang& gang, const ShadingPoint<Closure>& at, const Scattered& next,
                                          Mask gathers, Mask undeflected)
    {
        const UInt before = paths_->gathered.load(gang.i);
        // Light paths end where a delta lobe is not reversible, so no photon stands for what follows.
        const Mask goes_on = is_reversible(at, next.wi) & !next.enters_subsurface & (before != UInt(PathPool::nothing));
        const UInt by_delta = select(goes_on, UInt(PathPool::caustics_before), UInt(PathPool::nothing));
        const UInt by_others = select(gathers, UInt(PathPool::caustics), UInt(PathPool::nothing));
        paths_->gathered.store(gang.i, select(next.is_delta, by_delta, by_others), gang.valid & !undeflected);
    }

    template <class Closure>
    [[gnu::noinline]] void profile_scattering(const Gang& gang, const ShadingPoint<Closure>& at, const Scattered& next,
                                              Mask undeflected)
    {
        const Mask transmits = Closure::transmits ? dot(next.wi, at.ng) < Float(0) : Mask(false);
        const UInt event = select(next.is_delta, PathProfiler::delta_event(transmits),
                                  PathProfiler::lobe_event<Closure>(next.scatter_pdf, transmits));
        profiler_.note_scattering(*paths_, gang.i, select(undeflected, UInt(0u), event), gang.valid);
    }
    template <class Closure>
    [[gnu::noinline]] void profile_light(const Gang& gang, const ShadingPoint<Closure>& at, const LightSample& s,
                                         Float scatter_pdf, Mask lit)
    {
        const Mask transmits = Closure::transmits ? dot(s.wi, at.ng) < Float(0) : Mask(false);
        profiler_.note_light(*paths_, gang.i, s.light, PathProfiler::lobe_event<Closure>(scatter_pdf, transmits), lit);
    }

    /// First vertices of paths as seen from the camera, where PathPool::connection begins: see light_tracing.h.
    struct FirstVertex {
        Mask is_it{false};  ///< lanes whose path has no vertex before this one
        Float pixels;       ///< per unit of area of the surface
    };
    template <class Closure>
    [[gnu::always_inline]] FirstVertex first_vertex(const Gang& gang, const SurfaceHit& hit,
                                                    const ShadingPoint<Closure>& at) const
    {
        if (!(light_paths_ > 0)) return {};
        const Mask is_it = gang.valid & (paths_->connection.load(gang.i) < Float(0));
        if (none(is_it)) return {};
        Float distance = hit.t;
        if (scene_.has(Feature::exit_offsets)) distance = distance + paths_->exit_offset.load(gang.i);
        return {is_it, connector_.pixels_per_area(hit.d, distance) * abs(dot(hit.d, at.ng))};
    }
    /// PathPool::connection of paths that continue along wi, which the closure samples with this density.
    template <class Closure>
    [[gnu::always_inline]] Float connection(const Gang& gang, const ShadingPoint<Closure>& at, const FirstVertex& first,
                                            const Vec3& wi, Float scatter_pdf) const
    {
        // Light paths end at fibers: how a fiber is hit depends on the direction.
        if constexpr (Closure::is_fiber) return Float(infinity);
        const Float own = first.pixels * scatter_pdf / max(abs(dot(wi, at.ng)), Float(1e-20f));
        return select(first.is_it, own, paths_->connection.load(gang.i));
    }
    /// Weight of a light sample against light tracing. inverse_pdf: of a sample that is taken at each vertex.
    template <class Closure>
    [[gnu::noinline]] Float weight_of_light_sample(const Gang& gang, const ShadingPoint<Closure>& at,
                                                   const FirstVertex& first, const LightSample& s, Float inverse_pdf,
                                                   Float scatter_pdf, Mask m) const
    {
        const Float emission = emitter_.density(s.light, at.eye(), s.wi, s.distance, gang.time, m);
        const Float nee_pdf = Float(1) / max(inverse_pdf, Float(1e-37f));
        return path_tracing_weight(connection(gang, at, first, s.wi, scatter_pdf), emission * Float(light_paths_),
                                   path_variants(nee_pdf, scatter_pdf, first.is_it, s.is_delta));
    }
    template <class Closure>
    [[gnu::noinline]] void store_connection(const Gang& gang, const ShadingPoint<Closure>& at, const Scattered& next,
                                            const FirstVertex& first, Mask undeflected)
    {
        const std::size_t i = gang.i;
        const Mask lost = (next.is_delta & (first.is_it | !is_reversible(at, next.wi))) | next.enters_subsurface;
        const Float own = select(lost, Float(infinity), connection(gang, at, first, next.wi, next.scatter_pdf));
        paths_->connection.store(i, own, gang.valid & !undeflected);
        paths_->scatter_pdf.store(i, select(first.is_it, -next.scatter_pdf, next.scatter_pdf),
                                  gang.valid & !undeflected);
    }

    [[gnu::always_inline]] Gang load_gang(std::size_t i, Mask valid) const
    {
        const PathPool& p = *paths_;
        const UInt state = p.state.load(i), bounce = state & UInt(PathPool::bounce_mask);
        const UInt steps = scene_.has(Feature::open_media) ? group_of_steps(p.walk_steps.load(i)) : UInt(0u);
        return {i,
                valid,
                state,
                bounce,
                VertexRandom({p.pixel_hash.load(i), p.reversed_index.load(i)}, (bounce + UInt(1u)) | steps),
                scene_.has(Feature::motion) ? p.time.load(i) : Float(0)};
    }
    /// Vertices after scattering events within media use groups of random dimensions of their own.
    static UInt group_of_steps(UInt steps) { return select(steps == UInt(0u), UInt(0u), steps << 16 | UInt(1u << 31)); }

    /// Throughput of paths before they are scattered. It is 0 on the back of one-sided surfaces, and that of the chosen
    /// channel on dispersive surfaces, whose index of refraction becomes that of the channel.
    template <class Closure>
    [[gnu::always_inline]] Spectrum arriving_throughput(const Gang& gang, ShadingPoint<Closure>& at) const
    {
        Spectrum throughput = paths_->throughput.load(gang.i);
        if (scene_.has(Feature::one_sided) && !Closure::transmits)
            throughput = black_on_back(at, throughput, gang.valid);
        if constexpr (is_layered<Closure> && Closure::transmits)
            choose_channel(gang.random.key, gang.random.seed, at.material, throughput);
        return throughput;
    }

    /// Guiding distribution at the vertices; off if the closure cannot use it.
    template <class Closure>
    [[gnu::always_inline]] Guidance guide(const Closure& closure, const ShadingPoint<Closure>& at,
                                          const Gang& gang) const
    {
        if constexpr (Closure::is_guided)
            if (settings_.guiding) {
                const UInt seed = pair_seed(gang.random.seed, pair_guiding);
                const Vec3 noise = guiding_noise(sample_hash(gang.random.key, seed));
                return {*settings_.guiding, at.p, at.frame.n, noise, closure.guided_weight(), gang.valid};
            }
        return {};
    }

    /// Scale that cancels the scaling of radiance by refraction, for Russian roulette.
    [[gnu::always_inline]] Float update_eta_scale(const Gang& gang, const Scattered& next)
    {
        if (!scene_.has(Feature::transmission)) return Float(1.f);
        const Float eta_scale = paths_->eta_scale.load(gang.i) * next.eta * next.eta;
        paths_->eta_scale.store(gang.i, eta_scale, gang.valid);
        return eta_scale;
    }

    /// Updates the media around the paths that leave the surface.
    template <class Closure>
    [[gnu::always_inline]] void enter_media(const Gang& gang, const ShadingPoint<Closure>& at, const Scattered& next)
    {
        if (Closure::transmits && scene_.has(Feature::media_stacks)) {
            MediumStack beyond = at.media_beyond;
            if constexpr (is_layered<Closure>) beyond = select(next.enters_subsurface, at.media_below, beyond);
            paths_->media.store(gang.i, select(dot(next.wi, at.ng) < Float(0), beyond, at.media), gang.valid);
            if constexpr (is_layered<Closure>)
                if (scene_.has(Feature::textured_media))
                    store_subsurface_medium(gang.i, gang.valid & next.enters_subsurface, at);
        }
        if (scene_.has(Feature::scattering_media) && !scene_.has(Feature::open_media))
            paths_->walk_steps.store(gang.i, UInt(0u), gang.valid);
    }

    /// Plays Russian roulette. Returns the lanes whose path ends; scales up the throughput of the others.
    template <class Closure>
    [[gnu::always_inline]] Mask play_roulette(const Gang& gang, const Passage& passage, Roulette roulette,
                                              Spectrum& throughput) const
    {
        roulette.plays &= !passage.no_bounce;
        Mask ends = apply_roulette(roulette, gang.random.key, gang.random.seed, throughput);
        // A path that could only continue through a null interface and did not is finished.
        if (passes_interfaces<Closure>(scene_)) ends |= !passage.no_bounce & !may_scatter(settings_, gang.bounce);
        return ends;
    }

    /// Stores the rays that leave the surface, their throughput and their density for MIS.
    template <class Closure>
    [[gnu::always_inline]] void store_next_ray(const Gang& gang, const SurfaceHit& hit, const ShadingPoint<Closure>& at,
                                               const Scattered& next, Mask undeflected)
    {
        PathPool& p = *paths_;
        const std::size_t i = gang.i;
        Float exit_offset = at.exit_offset(next.wi);
        // Lights are sampled only with a probability at this vertex; dividing by the probability scales their density
        // in the MIS weight.
        Float mis_pdf = next.pdf;
        if (has_light_chance_) mis_pdf = mis_pdf / abs(p.nee_probability.load(i));
        if (passes_interfaces<Closure>(scene_)) {
            mis_pdf = select(undeflected, p.bsdf_pdf.load(i), mis_pdf);
            exit_offset =
                select(undeflected, p.exit_offset.load(i) + dot(at.start(next.wi) - hit.o, hit.d), exit_offset);
        }
        p.origin.store(i, at.start(next.wi), gang.valid);
        p.direction.store(i, next.wi, gang.valid);
        p.throughput.store(i, next.throughput, gang.valid);
        p.bsdf_pdf.store(i, mis_pdf, gang.valid);
        if (scene_.has(Feature::exit_offsets)) p.exit_offset.store(i, exit_offset, gang.valid);
    }

    /// The state of paths after scattering, and those that pass an interface undeflected.
    template <class Closure>
    [[gnu::always_inline]] Passage pass_interface(const Gang& gang, const SurfaceHit& hit,
                                                  const ShadingPoint<Closure>& at, const Scattered& next)
    {
        UInt next_state = (gang.state & UInt(~PathPool::specular)) + UInt(1u);
        next_state = next_state | select(next.is_delta, UInt(PathPool::specular), UInt(PathPool::scattered));
        if (!passes_interfaces<Closure>(scene_)) return {next_state};
        return pass_interface(gang, hit, at, next.wi, next_state);
    }
    /// Determines the paths that continue undeflected. If passing is not a bounce, a path keeps its flags of previous
    /// scattering.
    template <class Closure>
    [[gnu::noinline]] Passage pass_interface(const Gang& gang, const SurfaceHit& hit, const ShadingPoint<Closure>& at,
                                             const Vec3& wi, UInt next_state)
    {
        const auto [undeflected, no_bounce] = find_undeflected(scene_, materials_, at, hit, wi, gang.valid);
        next_state = select(undeflected, gang.state + UInt(1u), next_state);
        if (scene_.has(Feature::open_media)) {
            // Passing an open boundary counts as a step, so that the next vertex uses new random numbers.
            const UInt step = paths_->walk_steps.load(gang.i) + UInt(1u);
            paths_->walk_steps.store(gang.i, step, no_bounce);
            const UInt over = select(less(step, UInt(MediumStage::max_steps)), UInt(0u), UInt(PathPool::dead));
            next_state = select(no_bounce, gang.state | over, next_state);
        }
        return {next_state, undeflected, no_bounce};
    }

    /// Throughput, set to 0 on the back of one-sided surfaces.
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

    /// Next event estimation for the paths of the gang that sample a light at this vertex.
    template <class Closure>
    [[gnu::always_inline]] void estimate_direct_light(const Gang& gang, const Closure& closure,
                                                      const ShadingPoint<Closure>& at, const Guidance& guidance,
                                                      const Spectrum& throughput, const FirstVertex& first)
    {
        const Mask samples =
            has_light_chance_ ? gang.valid & (paths_->nee_probability.load(gang.i) > Float(0)) : gang.valid;
        counters_.costs.light_samples += std::uint64_t(count(samples));
        if (any(samples)) sample_light(gang, samples, closure, at, guidance, throughput, first);
    }

    /// Samples a light in the lanes of m; adds its contribution, or queues its shadow ray.
    template <class Closure>
    [[gnu::always_inline]] void sample_light(const Gang& gang, Mask m, const Closure& closure,
                                             const ShadingPoint<Closure>& at, const Guidance& guidance,
                                             const Spectrum& throughput, const FirstVertex& first)
    {
        // Lights are sampled from the origin of the shadow ray. If they were sampled from the surface itself, a light
        // that passes through the surface, or a distance that ends behind it, would depend on rounding.
        const Vec3 eye = at.eye();
        const auto& [key, seed, index] = gang.random;
        LightSample s = lights_.sample(m, eye, key, seed, gang.random.light(), gang.time);
        const Float nee_inverse_pdf = s.inverse_pdf;
        if (has_light_chance_) s.inverse_pdf = s.inverse_pdf / abs(paths_->nee_probability.load(gang.i));
        Mask lit = m & (s.inverse_pdf > Float(0));
        Float scatter_pdf;
        Spectrum add = direct_light(closure, at, guidance, s, throughput, lit, scatter_pdf);
        if (light_paths_ > 0) add = add * weight_of_light_sample(gang, at, first, s, nee_inverse_pdf, scatter_pdf, lit);
        MediumStack media;
        if (scene_.has(Feature::media_stacks)) {
            const Mask beyond = Closure::transmits ? dot(s.wi, at.ng) < Float(0) : Mask(false);
            media = select(beyond, at.media_beyond, at.media);
        }
        if (scene_.has(Feature::attenuation) && !scene_.has(Feature::transmissive_shadows))
            add = add * transmittance(extinction_of(scene_, *paths_, gang.i, media.current(), lit), s.distance);
        lit &= any_positive(add);
        if (guidance.is_on()) roulette_shadow_ray(guidance, mean(add) * s.likely, key, seed, add, lit);
        if (none(lit)) return;
        counters_.count_rays(RayKind::shadow, std::uint64_t(count(lit)));
        if (profiler_.is_on()) profile_light<Closure>(gang, at, s, scatter_pdf, lit);
        const Ray ray = shadow_ray(at, eye, s, gang.time);
        if (scene_.is_flat) return add_unoccluded(gang.i, ray, add, m, lit);
        const UInt path = iota() + UInt(std::uint32_t(gang.i));
        if (scene_.has(Feature::transmissive_shadows))
            shadows_.push(ray, add, media, path, s.needs_environment_radiance, lit);
        else
            shadows_.push(ray, add, path, s.needs_environment_radiance, lit);
    }
    /// Traces the shadow rays of the lanes `lit` of m and adds the contributions of those that nothing blocks.
    [[gnu::always_inline]] void add_unoccluded(std::size_t i, const Ray& ray, Spectrum add, Mask m, Mask lit)
    {
        PathPool& p = *paths_;
        clock_.enter(RenderStage::shadow);
        const Mask clear = lit & !scene_.flat.occluded(tables_, ray, lit);
        counters_.costs.clear_shadow_rays += std::uint64_t(count(clear));
        if (settings_.clamp_indirect > 0) add = clamped(i, add, clear);
        p.radiance.store(i, p.radiance.load(i) + select(clear, add, Spectrum(Float(0))), m);
    }

    /// Plays Russian roulette for shadow rays: keeps lanes of `lit` by chance and scales up their contributions.
    /// brings: estimated contribution of the light sample if unoccluded.
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
    const LightEmitter emitter_;
    const CameraConnector connector_;
    const CausticGathering gathering_;
    const KernelSettings& settings_;
    KernelCounters& counters_;
    StageClock& clock_;
    PathRecorder& recorder_;
    PathProfiler& profiler_;
    bool lights_are_sampled_, has_light_chance_;
    float light_paths_;  ///< per sample index; 0: no light tracing

    PathPool* paths_ = nullptr;
    const HitColumns* hits_ = nullptr;
    ShadowQueue shadows_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
