#pragma once
#include <algorithm>

#include "integrate/camera_paths.h"
#include "integrate/stages/path_medium.h"
#include "media/phase.h"
#include "media/stack.h"

namespace fathom::inline FATHOM_LANES {

/// Ways through what fills solids: what they leave of the light, and in a medium that scatters, where a path turns.
///
/// A path that is scattered before it gets to what it was about to hit is put there and goes on along another
/// direction: a step of a random walk, in which it is not shaded. It has no light sampled, since no light gets in but
/// through a surface that scatters it.
class WalkStage {
public:
    WalkStage(const LaneScene& scene, const KernelSettings& settings)
        : scene_(scene), tables_(scene.tables), settings_(settings)
    {
    }

    /// Hits of paths that were scattered before become misses at this distance.
    static constexpr float scattered_before = -1;
    /// So many steps, and the path ends: a number too large to be met but where next to nothing is absorbed in a solid
    /// of some hundred mean free paths.
    static constexpr std::uint32_t most_steps = 0xffff;

    void run(PathPool& p, HitColumns& hits, std::size_t active) const
    {
        for (std::size_t i = 0; i < active; i += lanes) {
            const UInt medium = p.media.load(i).current();
            const Mask inside = first_lanes(active - i) & (medium != UInt(0u));
            if (none(inside)) continue;
            if (scene_.scatters_inside) {
                const Spectrum scattering = scattering_of(scene_, p, i, medium, inside);
                const Mask scatters = inside & any_positive(scattering);
                if (any(scatters)) go(p, hits, i, medium, scattering, scatters);
                if (none(inside & !scatters)) continue;
                attenuate(p, hits, i, medium, inside & !scatters);
            } else {
                attenuate(p, hits, i, medium, inside);
            }
        }
    }

private:
    /// Pairs of random dimensions of a step, whose group has its number in the upper half.
    enum WalkPair : std::uint32_t { pair_distance, pair_phase, pair_survival };

    void attenuate(PathPool& p, const HitColumns& hits, std::size_t i, UInt medium, Mask m) const
    {
        const Spectrum left = transmittance(extinction_of(scene_, p, i, medium, m), hits.t.load(i));
        p.throughput.store(i, p.throughput.load(i) * left, m);
    }

    [[gnu::noinline]] void go(PathPool& p, HitColumns& hits, std::size_t i, UInt medium, const Spectrum& scattering,
                              Mask m) const
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
        const Mask ends = end_by_chance(turns, key, seed, bounce + step, p.eta_scale.load(i), next) |
                          (turns & !less(step, UInt(most_steps)));
        p.throughput.store(i, next, m);
        if (none(turns)) return;

        const Vec3 o = p.origin.load(i), d = p.direction.load(i);
        const Float g = gather(tables_.media, &MediumRecord::anisotropy, medium, m);
        const Vec3 turned = sample_phase(g, sample_2d(key, pair_seed(seed, pair_phase)));
        p.origin.store(i, fma(d, kept_inside(o, way.distance(), t_hit), o), turns);
        p.direction.store(i, normalize(Frame(d).to_world(turned)), turns);
        p.walk_steps.store(i, step, turns);
        p.bsdf_pdf.store(i, Float(0), turns);
        // A camera in a medium sees no first hit through it: the path has left the camera.
        const UInt left_camera = select(bounce == UInt(0u), UInt(1u), UInt(0u));
        const UInt dead = select(ends, UInt(PathPool::dead), UInt(0u));
        p.state.store(i, (state + left_camera) | UInt(PathPool::specular | PathPool::scattered) | dead, turns);
        hits.t.store(i, Float(scattered_before), turns);
        hits.primitive.store(i, UInt(no_index), turns);
    }

    /// Rounding must not put a path onto the other side of what lies ahead, whence it would not find back.
    static Float kept_inside(const Vec3& o, Float distance, Float t_hit)
    {
        const Float size = max(max(abs(o.x), abs(o.y)), abs(o.z)) + min(t_hit, Float(1e30f));
        return min(distance, max(fma(size, Float(-0x1p-20f), t_hit), t_hit * Float(0.5f)));
    }

    /// Russian roulette for the lanes of m, by what is left, without refraction's scaling. What loses nothing goes on
    /// for sure: a step that ended one in twenty would add more noise than it saves, since walks are long.
    Mask end_by_chance(Mask m, const SampleKey& key, UInt seed, UInt bounce, Float eta_scale,
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
};

}  // namespace fathom::inline FATHOM_LANES
