// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/indirect_clamp.h"
#include "integrate/stages/path_end.h"
#include "integrate/stages/shading_point.h"
#include "kernel/lane_scene.h"
#include "kernel/pool.h"
#include "lights/environment/environment.h"
#include "media/distance.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Queue of the shadow rays of a pool, at most one per path, with the contribution of each if unoccluded. Tracing many
/// rays at once is faster than tracing each when it arises.
class ShadowQueue {
public:
    void clear() { size_ = 0; }

    /// Appends the rays of the lanes of m. path: index in the pool. needs_environment_radiance: the contribution must
    /// be multiplied by the environment's radiance along the ray.
    [[gnu::always_inline]] void push(const Ray& ray, const Spectrum& light, UInt path, Mask needs_environment_radiance,
                                     Mask m)
    {
        append(ray, light, marked(path, needs_environment_radiance), m);
    }
    /// push() for scenes with transmissive shadows. media: stack at the origin of the rays.
    void push(const Ray& ray, const Spectrum& light, const MediumStack& media, UInt path,
              Mask needs_environment_radiance, Mask m)
    {
        push_on(ray, light, media, marked(path, needs_environment_radiance), UInt(0u), m);
    }

    /// Traces all rays and adds the contributions of unoccluded ones to their paths, whose bounce counts already
    /// include the vertex that the rays left. Returns the number of unoccluded rays.
    std::size_t trace(const LaneScene& scene, PathPool& paths, const KernelSettings& settings, StageClock& clock)
    {
        if (size_ == 0) return 0;
        const bool clamp = settings.clamp_indirect > 0;
        if (scene.has(Feature::transmissive_shadows)) return trace_through(scene, paths, settings, clock);
        scene.bvh.occluded(rays(scene, size_), blocked_.data, false);
        if (scene.tables.environment.light != no_index) multiply_environment_unoccluded(scene);
        std::size_t clear = 0;
        for (std::size_t k = 0; k < size_; ++k) {
            if (blocked_[k]) continue;
            ++clear;
            add(paths, k, clamp);
        }
        return clear;
    }

private:
    /// Rounding can trap a ray inside a thin solid; this limit on passed surfaces ends it.
    static constexpr int max_passed = 1024;
    /// Flag on the path index: the ray sees the environment if unoccluded.
    static constexpr std::uint32_t environment_mark = 1u << 31;

    [[gnu::always_inline]] void append(const Ray& ray, const Spectrum& light, UInt path, Mask m)
    {
        origin_.append(size_, ray.o, m), direction_.append(size_, ray.d, m);
        t_max_.append(size_, ray.t_max, m), time_.append(size_, ray.time, m);
        radiance_.append(size_, light, m);
        path_.append(size_, path, m);
        size_ += std::size_t(count(m));
    }
    RayArrays rays(const LaneScene& scene, std::size_t size) const
    {
        return {origin_.x.data,
                origin_.y.data,
                origin_.z.data,
                direction_.x.data,
                direction_.y.data,
                direction_.z.data,
                t_max_.data,
                scene.has(Feature::motion) ? time_.data : nullptr,
                size};
    }

    void push_on(const Ray& ray, const Spectrum& light, const MediumStack& media, UInt path, UInt bounces, Mask m)
    {
        bounces_.append(size_, bounces, m);
        media_.low.append(size_, media.low(), m), media_.high.append(size_, media.high(), m);
        append(ray, light, path, m);
    }

    /// Looks up the environment for unoccluded rays, compacted: inside rooms they are few.
    void multiply_environment_unoccluded(const LaneScene& scene)
    {
        std::size_t seen = 0;
        for (std::size_t i = 0; i < size_; i += lanes) {
            const Mask m = first_lanes(size_ - i) & (blocked_.load(i) == UInt(0u)) & is_marked(path_.load(i));
            seen_.append(seen, iota() + UInt(std::uint32_t(i)), m);
            seen += std::size_t(count(m));
        }
        for (std::size_t i = 0; i < seen; i += lanes) multiply_environment(scene, seen_.load(i), first_lanes(seen - i));
    }
    /// Multiplies contributions by the environment's radiance. index: rays, in the lanes of m.
    [[gnu::noinline]] void multiply_environment(const LaneScene& scene, UInt index, Mask m)
    {
        const Spectrum seen = environment_radiance(scene.tables, direction_.gather(index, m), m);
        float values[channels][lanes];
        std::uint32_t at[lanes];
        store(at, index);
        for (int c = 0; c < channels; ++c) store(values[c], seen.c[c]);
        for_each_active(m, [&](int lane) {
            for (int c = 0; c < channels; ++c) radiance_.c[c][at[lane]] *= values[c][lane];
        });
    }
    static UInt marked(UInt path, Mask needs_environment_radiance)
    {
        return select(needs_environment_radiance, path | UInt(environment_mark), path);
    }
    static Mask is_marked(UInt path) { return (path & UInt(environment_mark)) != UInt(0u); }

    /// Traces rays from one transmissive surface to the next; each segment is attenuated by its medium.
    [[gnu::noinline]] std::size_t trace_through(const LaneScene& scene, PathPool& paths, const KernelSettings& settings,
                                                StageClock& clock)
    {
        std::size_t clear = 0;
        for (int passed = 0; size_ > 0 && passed < max_passed; ++passed) {
            clock.enter(RenderStage::shadow);
            scene.bvh.closest(rays(scene, size_),
                              {hits_.t.data, hits_.u.data, hits_.v.data, hits_.primitive.data, hits_.instance.data},
                              false);
            const std::size_t size = size_;
            size_ = 0;
            for (std::size_t i = 0; i < size; i += lanes) {
                const Mask m = first_lanes(size - i);
                const UInt primitive = hits_.primitive.load(i);
                const Mask nothing = m & (primitive == UInt(no_index));
                const UInt info = scene.shape_info_of(primitive, hits_.instance.load(i), m & !nothing);
                const Mask may_pass = m & !nothing & ((info & UInt(LaneScene::passes_shadow_rays)) != UInt(0u));
                if (scene.has(Feature::attenuation)) attenuate(scene, i, nothing | may_pass);
                const UInt ray = iota() + UInt(std::uint32_t(i));
                if (const Mask out = nothing & is_marked(path_.load(i)); any(out))
                    multiply_environment(scene, ray, out);
                for_each_active(nothing,
                                [&](int lane) { add(paths, i + std::size_t(lane), settings.clamp_indirect > 0); });
                clear += std::size_t(count(nothing));
                if (any(may_pass)) pass(scene, paths, settings, clock, i, may_pass);
            }
        }
        return clear;
    }

    void attenuate(const LaneScene& scene, std::size_t i, Mask m)
    {
        const UInt medium = media_.load(i).current();
        const Spectrum extinction = gather(scene.tables.media, &MediumRecord::extinction, medium, m);
        radiance_.store(i, radiance_.load(i) * transmittance(extinction, hits_.t.load(i)), m);
    }

    /// Appends the rays from number i on that pass the surface they hit, and counts the bounces that a path would need
    /// there. They overwrite slots that were already read.
    [[gnu::noinline]] void pass(const LaneScene& scene, const PathPool& paths, const KernelSettings& settings,
                                StageClock& clock, std::size_t i, Mask m)
    {
        const SurfaceHit hit{origin_.load(i), direction_.load(i), hits_.t.load(i),         hits_.u.load(i),
                             hits_.v.load(i), time_.load(i),      hits_.primitive.load(i), hits_.instance.load(i)};
        const MaterialReader materials(scene);
        const MediumStack media = media_.load(i);
        const ShadingPoint<GlassBsdf> at = read_shading_point<GlassBsdf>(
            SurfaceReader(scene), materials, hit, scene.has(Feature::media_stacks) ? &media : nullptr, m, clock);
        const PassedInterface there = classify_interface(scene, materials, at.material_index, at.skips_interface, m);
        const UInt path = path_.load(i), bounces = bounces_.load(i);
        const UInt number = path & UInt(~environment_mark);
        const UInt bounce = (paths.state.gather(number, m) & UInt(PathPool::bounce_mask)) + bounces;
        const Spectrum light =
            radiance_.load(i) * select(there.pane, GlassBsdf(at.material).passed(at.wo), Spectrum(Float(1)));
        const Mask passes =
            (there.pane | there.open) & any_positive(light) & (there.no_bounce | may_scatter(settings, bounce));
        const Ray ray{at.start(hit.d), hit.d, max(t_max_.load(i) - hit.t, Float(0)), hit.time};
        push_on(ray, light, scene.has(Feature::media_stacks) ? at.media_beyond : MediumStack(), path,
                bounces + select(there.no_bounce, UInt(0u), UInt(1u)), passes);
    }

    /// Adds the contribution of ray k to its path.
    void add(PathPool& paths, std::size_t k, bool clamp)
    {
        const std::size_t path = path_[k] & ~environment_mark;
        const float scale = clamp ? clamped(paths, path, radiance_, k) : 1;
        for (int c = 0; c < channels; ++c) paths.radiance.c[c][path] += scale * radiance_.c[c][k];
    }
    static float clamped(PathPool& paths, std::size_t path, const SpectrumColumn& radiance, std::size_t k)
    {
        float light[channels];
        for (int c = 0; c < channels; ++c) light[c] = radiance.c[c][k];
        return indirect_scale(paths, path, paths.state[path] & PathPool::bounce_mask, light);
    }

    std::size_t size_ = 0;
    VectorColumn origin_, direction_;
    Column<float> t_max_, time_;
    SpectrumColumn radiance_;
    Column<std::uint32_t> path_, blocked_, seen_;
    // The following members are used in scenes with transmissive shadows.
    MediaColumn media_;
    Column<std::uint32_t> bounces_;  ///< number of bounces that a path would need to pass the surfaces so far
    HitColumns hits_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
