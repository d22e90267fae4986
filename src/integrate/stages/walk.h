// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "integrate/stages/path_end.h"
#include "integrate/stages/path_medium.h"
#include "integrate/stages/path_profiler.h"
#include "integrate/stages/shadow.h"
#include "kernel/camera_paths.h"
#include "kernel/stage_clock.h"
#include "lights/sample/light_stage.h"
#include "media/phase.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Medium stage: attenuates path segments in absorbing media, and samples scattering events in scattering ones.
///
/// A path that scatters before its hit is moved to the scattering event and continues in a sampled direction without
/// shading: a step of a random walk. Next event estimation runs only in open (index-matched) media, since light reaches
/// the inside of other media only through a refracting surface.
class MediumStage {
public:
    MediumStage(const LaneScene& scene, const KernelSettings& settings, KernelCounters& counters, StageClock& clock,
                PathProfiler& profiler)
        : scene_(scene),
          tables_(scene.tables),
          settings_(settings),
          counters_(counters),
          clock_(clock),
          profiler_(profiler),
          lights_(scene, settings.light_selection, true),
          lights_are_sampled_(settings.light_sampling && !tables_.lights.empty())
    {
    }

    /// Values of HitColumns::t that mark paths as scattered before their hit. scattered_first: the path came straight
    /// from the camera, in an open medium.
    static constexpr float scattered_in_medium = -1, scattered_first = -2;
    /// Largest number of steps of a path. Walks get this long only in solids of hundreds of mean free paths that absorb
    /// almost nothing.
    static constexpr std::uint32_t max_steps = 0x7fff;

    /// Processes the segments from the paths' origins to their hits.
    void run(PathPool& p, HitColumns& hits, std::size_t active)
    {
        shadows_.clear();
        for (std::size_t i = 0; i < active; i += lanes) {
            const UInt medium = p.media.load(i).current();
            const Mask inside = first_lanes(active - i) & (medium != UInt(0u));
            if (none(inside)) continue;
            if (scene_.has(Feature::scattering_media)) {
                const Spectrum scattering = scattering_of(scene_, p, i, medium, inside);
                const Mask scatters = inside & any_positive(scattering);
                if (any(scatters)) scatter_in_medium(p, hits, i, medium, scattering, scatters);
                if (none(inside & !scatters)) continue;
                attenuate(p, hits, i, medium, inside & !scatters);
            } else {
                attenuate(p, hits, i, medium, inside);
            }
        }
        if (!scene_.has(Feature::open_media)) return;
        clock_.enter(RenderStage::shadow);
        counters_.costs.clear_shadow_rays += shadows_.trace(scene_, p, settings_, clock_);
        clock_.enter(RenderStage::arrival);
    }

private:
    /// Pairs of random dimensions of a step. The step's number is in the upper half of the group.
    enum WalkPair : std::uint32_t { pair_distance, pair_phase, pair_survival };
    /// Bit that separates the group of a step's light sample from that of the step.
    static constexpr std::uint32_t light_group = 1u << 15;

    void attenuate(PathPool& p, const HitColumns& hits, std::size_t i, UInt medium, Mask m) const
    {
        const Spectrum left = transmittance(extinction_of(scene_, p, i, medium, m), hits.t.load(i));
        p.throughput.store(i, p.throughput.load(i) * left, m);
    }

    [[gnu::noinline]] void scatter_in_medium(PathPool& p, HitColumns& hits, std::size_t i, UInt medium,
                                             const Spectrum& scattering, Mask m)
    {
        const SampleKey key{p.pixel_hash.load(i), p.reversed_index.load(i)};
        const UInt state = p.state.load(i), bounce = state & UInt(PathPool::bounce_mask);
        const UInt step = p.walk_steps.load(i) + UInt(1u);
        const UInt seed = group_seed(key, step << 16 | (bounce + UInt(1u)));
        const Spectrum extinction = extinction_of(scene_, p, i, medium, m);
        const Sample2 u = sample_2d(key, pair_seed(seed, pair_distance));
        const Spectrum throughput = p.throughput.load(i);
        const DistanceSample way(extinction, throughput, u.x, u.y);
        const Float t_hit = hits.t.load(i);
        const Mask turns = m & (way.distance() < t_hit);
        Spectrum next = throughput * select(turns, way.scattered(scattering), way.passed(t_hit));
        Mask open(false);
        if (scene_.has(Feature::open_media)) {
            open = turns & (gather(tables_.media, &MediumRecord::is_index_matched, medium, m) != UInt(0u));
            // The step count selects the random numbers at the boundary ahead, if it is passed.
            p.walk_steps.store(i, step, m);
        }
        Mask counts = open;
        // Scattering counts as a bounce only if there is a depth limit: otherwise `counts` must not change the image.
        if (settings_.max_depth >= 0)
            counts |= turns & (gather(tables_.media, &MediumRecord::counts, medium, m) != UInt(0u));
        const Spectrum scattered = next;
        const Mask ends = play_roulette(turns, key, seed, bounce + step, p.eta_scale.load(i), next) |
                          (turns & !less(step, UInt(max_steps))) | (counts & !may_scatter(settings_, bounce));
        p.throughput.store(i, next, m);
        if (none(turns)) return;

        const Vec3 o = p.origin.load(i), d = p.direction.load(i);
        const Float g = gather(tables_.media, &MediumRecord::anisotropy, medium, m);
        const Vec3 turned = sample_phase(g, sample_2d(key, pair_seed(seed, pair_phase)));
        const Vec3 at = fma(d, clamp_to_segment(o, way.distance(), t_hit), o);
        const Mask lit = open & may_scatter(settings_, bounce);
        if (lights_are_sampled_ && any(lit))
            sample_light(p, {i, at, g, key, step << 16 | UInt(light_group) | (bounce + UInt(1u)), scattered}, lit);
        p.origin.store(i, at, turns);
        p.direction.store(i, normalize(Frame(d).to_world(turned)), turns);
        p.walk_steps.store(i, step, turns);
        p.bsdf_pdf.store(i, select(open, phase_pdf(g, turned.z), Float(0)), turns);
        if (scene_.has(Feature::exit_offsets)) p.exit_offset.store(i, Float(0), turns);
        // Light paths end where a medium scatters them.
        if (settings_.light_paths > 0) p.connection.store(i, Float(infinity), turns);
        if (settings_.caustics) p.gathered.store(i, UInt(PathPool::nothing), turns);
        // The path no longer counts as coming from the camera, since first hits behind a scattering event are not
        // recorded.
        const Mask from_camera = bounce == UInt(0u);
        const UInt left = select(counts | from_camera, UInt(1u), UInt(0u));
        const UInt dead = select(ends, UInt(PathPool::dead), UInt(0u));
        const UInt specular = select(open, UInt(0u), UInt(PathPool::specular));
        const UInt others = state & UInt(~PathPool::specular);
        p.state.store(i, (others + left) | specular | UInt(PathPool::scattered) | dead, turns);
        hits.t.store(i, select(open & from_camera, Float(scattered_first), Float(scattered_in_medium)), turns);
        hits.primitive.store(i, UInt(no_index), turns);
    }

    /// Scattering events of a gang of paths in a medium.
    struct ScatteringEvents {
        std::size_t i;  ///< index of the gang's first path
        Vec3 at;
        Float anisotropy;
        SampleKey key;
        UInt group;          ///< group of the light sample's random dimensions
        Spectrum scattered;  ///< throughput after scattering, without the factor of the phase function
    };
    /// Next event estimation at scattering events: queues the shadow rays.
    [[gnu::noinline]] void sample_light(const PathPool& p, const ScatteringEvents& events, Mask m)
    {
        const auto& [i, at, anisotropy, key, group, scattered] = events;
        const UInt seed = group_seed(key, group);
        const Float time = scene_.has(Feature::motion) ? p.time.load(i) : Float(0);
        const LightSample s = lights_.sample(m, at, key, seed, sample_2d(key, pair_seed(seed, pair_light)), time);
        const Float pdf = phase_pdf(anisotropy, dot(s.wi, p.direction.load(i)));
        const Spectrum light = scattered * s.radiance * (pdf * light_weight(s, pdf));
        const Mask lit = m & (s.inverse_pdf > Float(0)) & any_positive(light);
        if (none(lit)) return;
        counters_.count_rays(RayKind::shadow, std::uint64_t(count(lit)));
        if (profiler_.is_on()) profiler_.note_light(p, i, s.light, UInt(std::uint32_t(PathEvent::volume)), lit);
        shadows_.push({at, s.wi, s.distance * Float(1 - 0x1p-16f), time}, light, p.media.load(i),
                      iota() + UInt(std::uint32_t(i)), s.needs_environment_radiance, lit);
    }

    /// Limits the distance so that rounding cannot put the path beyond the surface ahead, from where it would not
    /// return.
    static Float clamp_to_segment(const Vec3& o, Float distance, Float t_hit)
    {
        const Float size = max(max(abs(o.x), abs(o.y)), abs(o.z)) + min(t_hit, Float(1e30f));
        return min(distance, max(fma(size, Float(-0x1p-20f), t_hit), t_hit * Float(0.5f)));
    }

    /// Plays Russian roulette in the lanes of m by throughput, without refraction's scaling of radiance. Paths without
    /// loss always survive: walks are long, and ending 5 % at each step would add more noise than it saves time.
    Mask play_roulette(Mask m, const SampleKey& key, UInt seed, UInt bounce, Float eta_scale,
                       Spectrum& throughput) const
    {
        const Float largest = max_component(throughput);
        const Mask roulette = m & !less(bounce, UInt(std::uint32_t(settings_.roulette_depth)));
        const Float survival = select(roulette, clamp(largest * eta_scale, Float(1e-3f), Float(1)), Float(1));
        throughput = throughput * reciprocal(survival);
        return m & (!(largest > Float(0)) | (sample_hash(key, pair_seed(seed, pair_survival)) >= survival));
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const KernelSettings& settings_;
    KernelCounters& counters_;
    StageClock& clock_;
    PathProfiler& profiler_;
    const LightSampler lights_;
    const bool lights_are_sampled_;
    ShadowQueue shadows_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
