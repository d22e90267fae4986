#pragma once
#include "integrate/pool.h"
#include "integrate/scene.h"
#include "integrate/stages/indirect_clamp.h"
#include "integrate/stages/solid_boundary.h"
#include "media/distance.h"

namespace fathom::inline FATHOM_LANES {

/// The shadow rays of a pool's paths, at most one a path, and what each brings if nothing blocks it. The tree traces
/// many rays at once faster than one after the other.
class ShadowQueue {
public:
    void clear() { size_ = 0; }

    /// Appends the rays of the lanes of m. path: their number in the pool.
    [[gnu::always_inline]] void push(const Ray& ray, const Spectrum& light, UInt path, Mask m)
    {
        origin_.append(size_, ray.o, m), direction_.append(size_, ray.d, m);
        t_max_.append(size_, ray.t_max, m), time_.append(size_, ray.time, m);
        radiance_.append(size_, light, m);
        path_.append(size_, path, m);
        size_ += std::size_t(count(m));
    }
    /// The same in scenes with open media. media: where the rays begin.
    void push(const Ray& ray, const Spectrum& light, const MediumStack& media, UInt path, Mask m)
    {
        media_.low.append(size_, media.low(), m), media_.high.append(size_, media.high(), m);
        push(ray, light, path, m);
    }

    /// Traces all, and adds what those that nothing blocks bring to the radiance of their paths, whose bounces count
    /// the surface that the rays left. Returns how many these are.
    std::size_t trace(const LaneScene& scene, PathPool& paths, bool clamp)
    {
        if (size_ == 0) return 0;
        if (scene.open_media) return trace_through(scene, paths, clamp);
        scene.bvh.occluded(rays(scene, size_), blocked_.data, false);
        std::size_t clear = 0;
        for (std::size_t k = 0; k < size_; ++k) {
            if (blocked_[k]) continue;
            ++clear;
            add(paths, k, clamp);
        }
        return clear;
    }

private:
    /// A ray that has passed so many boundaries goes round and round in what rounding leaves of a solid.
    static constexpr int most_boundaries = 1024;

    RayArrays rays(const LaneScene& scene, std::size_t size) const
    {
        return {origin_.x.data,
                origin_.y.data,
                origin_.z.data,
                direction_.x.data,
                direction_.y.data,
                direction_.z.data,
                t_max_.data,
                scene.tables.moving ? time_.data : nullptr,
                size};
    }

    /// From boundary to boundary of what light passes straight; on each way the medium there takes its share.
    [[gnu::noinline]] std::size_t trace_through(const LaneScene& scene, PathPool& paths, bool clamp)
    {
        std::size_t clear = 0;
        for (int boundary = 0; size_ > 0 && boundary < most_boundaries; ++boundary) {
            scene.bvh.closest(rays(scene, size_),
                              {hits_.t.data, hits_.u.data, hits_.v.data, hits_.primitive.data, hits_.instance.data},
                              false);
            const std::size_t size = size_;
            size_ = 0;
            for (std::size_t i = 0; i < size; i += lanes) clear += pass(scene, paths, clamp, i, first_lanes(size - i));
        }
        return clear;
    }

    /// Adds what rays number i and on bring if nothing is ahead of them, and keeps those that pass what they meet, in
    /// front of those that are still to be looked at. Returns how many met nothing.
    std::size_t pass(const LaneScene& scene, PathPool& paths, bool clamp, std::size_t i, Mask m)
    {
        const MediumStack media = media_.load(i);
        const Float t = hits_.t.load(i);
        const Spectrum left =
            transmittance(gather(scene.tables.media, &MediumRecord::extinction, media.current(), m), t);
        const Spectrum light = radiance_.load(i) * left;
        radiance_.store(i, light, m);
        const UInt primitive = hits_.primitive.load(i);
        const Mask clear = m & (primitive == UInt(no_index));
        for_each_active(clear, [&](int lane) { add(paths, i + std::size_t(lane), clamp); });

        const Mask hit = m & !clear & any_positive(light);
        if (none(hit)) return std::size_t(count(clear));
        const Vec3 d = direction_.load(i);
        const SurfaceHit at{origin_.load(i),       d, t, hits_.u.load(i), hits_.v.load(i), time_.load(i), primitive,
                            hits_.instance.load(i)};
        const Surface s = SurfaceReader(scene).read(at, hit);
        const Mask inside = dot(d, s.ng) >= Float(0);
        const MaterialReader materials(scene);
        const SolidBoundary boundary = solid_boundary(materials, s.material, media, inside, hit);
        const Mask passes =
            boundary.passes_on & (materials.get(&MaterialRecord::mixture, s.material, hit) == UInt(no_index));
        if (none(passes)) return std::size_t(count(clear));
        const Vec3 o = fma(flip_sign(s.ng, dot(d, s.ng)), s.offset, s.p);
        push({o, d, max(t_max_.load(i) - t, Float(0)), time_.load(i)}, light, boundary.media.beyond, path_.load(i),
             passes);
        return std::size_t(count(clear));
    }

    /// What the ray brings, to its path.
    void add(PathPool& paths, std::size_t k, bool clamp)
    {
        const float scale = clamp ? clamped(paths, path_[k], radiance_, k) : 1;
        for (int c = 0; c < channels; ++c) paths.radiance.c[c][path_[k]] += scale * radiance_.c[c][k];
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
    Column<std::uint32_t> path_, blocked_;
    MediaColumn media_;  ///< where there are open ones
    HitColumns hits_;    ///< there, too
};

}  // namespace fathom::inline FATHOM_LANES
