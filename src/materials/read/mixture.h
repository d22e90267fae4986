// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Resolves mixtures: materials that are one of two others, chosen at random or by the side that the path arrives on.
#include "geometry/surface/surface.h"
#include "kernel/camera_paths.h"
#include "kernel/pool.h"
#include "textures/record_inputs.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Chooses a material for each path that hit a mixture, before paths are sorted by closure.
class MixtureStage {
public:
    explicit MixtureStage(const LaneScene& scene) : scene_(scene), t_(scene.tables), surfaces_(scene) {}

    /// Writes the chosen material of each of the first `active` paths to hits.material; no_index for paths that did not
    /// hit a mixture.
    [[gnu::noinline]] void choose(const PathPool& p, HitColumns& hits, std::size_t active, bool has_time) const
    {
        for (std::size_t i = 0; i < active; i += lanes) {
            hits.material.store(i, UInt(no_index));
            const UInt primitive = hits.primitive.load(i);
            const UInt instance = scene_.is_flat ? UInt(no_index) : hits.instance.load(i);
            // A negative t marks a path that scattered in a medium before it reached the surface.
            Mask m = first_lanes(active - i) & (primitive != UInt(no_index)) & !(hits.t.load(i) < Float(0));
            m &= (scene_.shape_info_of(primitive, instance, m) & UInt(LaneScene::is_mixture)) != UInt(0u);
            if (none(m)) continue;
            const SurfaceHit hit{p.origin.load(i), p.direction.load(i),
                                 hits.t.load(i),   hits.u.load(i),
                                 hits.v.load(i),   has_time ? p.time.load(i) : Float(0),
                                 primitive,        instance};
            const SampleKey key{p.pixel_hash.load(i), p.reversed_index.load(i)};
            const UInt bounce = p.state.load(i) & UInt(PathPool::bounce_mask);
            const UInt seed = pair_seed(group_seed(key, bounce + UInt(1u)), pair_mixture);
            hits.material.store(i, material_of(hit, sample_2d(key, seed).x, m), m);
        }
    }

    /// Sort bucket of a path: that of the chosen material, or `bucket` if none was chosen.
    UInt bucket(UInt material, UInt bucket, Mask m) const
    {
        const Mask chosen = m & (material != UInt(no_index));
        return select(chosen, gather(scene_.material_bucket.data(), material, chosen), bucket);
    }

private:
    /// Descends through nested mixtures to a material that is not a mixture. random: in [0, 1); it is rescaled after
    /// each choice and used for the next.
    UInt material_of(const SurfaceHit& hit, Float random, Mask m) const
    {
        const Surface s = surfaces_.read(hit, m);
        const Float side = select(dot(hit.d, s.ng) < Float(0), Float(0), Float(1));
        UInt material = s.material;
        for (;;) {
            const UInt mixture = gather(t_.materials, &MaterialRecord::mixture, material, m);
            const Mask open = m & (mixture != UInt(no_index));
            if (none(open)) return material;
            const Mask by_side = gather(t_.mixtures, &MixtureRecord::by_side, mixture, open) != UInt(0u);
            const Float share = select(by_side, side, factor(s, mixture, open));
            const Mask second = open & (random < share);
            material = select(open & !second, gather(t_.mixtures, &MixtureRecord::first, mixture, open), material);
            material = select(second, gather(t_.mixtures, &MixtureRecord::second, mixture, second), material);
            const Float rest = select(second, random / share, (random - share) / (Float(1) - share));
            random = select(open & !by_side, min(rest, Float(0x1.fffffep-1f)), random);
        }
    }

    /// Probability of the second material, clamped to [0, 1].
    Float factor(const Surface& s, UInt mixture, Mask m) const
    {
        const Float f = RecordInputs<MixtureRecord>(t_, t_.mixtures, s.at, mixture, m).number(&MixtureRecord::factor);
        return min(max(f, Float(0)), Float(1));
    }

    const LaneScene& scene_;
    const SceneTables& t_;
    const SurfaceReader surfaces_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
