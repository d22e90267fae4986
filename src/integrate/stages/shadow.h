#pragma once
#include "integrate/pool.h"
#include "integrate/scene.h"
#include "integrate/stages/indirect_clamp.h"

namespace fathom::inline FATHOM_LANES {

/// The shadow rays of a pool's paths, at most one a path, and what each brings if nothing blocks it. The tree traces
/// many rays at once faster than one after the other.
class ShadowQueue {
public:
    void clear() { size_ = 0; }

    /// Appends the rays of the lanes of m, of the paths numbered from `first_path` on.
    [[gnu::always_inline]] void push(const Ray& ray, const Spectrum& light, std::size_t first_path, Mask m)
    {
        origin_.append(size_, ray.o, m), direction_.append(size_, ray.d, m);
        t_max_.append(size_, ray.t_max, m), time_.append(size_, ray.time, m);
        radiance_.append(size_, light, m);
        path_.append(size_, iota() + UInt(std::uint32_t(first_path)), m);
        size_ += std::size_t(count(m));
    }

    /// Traces all, and adds what those that nothing blocks bring to the radiance of their paths, whose bounces count
    /// the surface that the rays left. Returns how many these are.
    std::size_t trace(const LaneScene& scene, PathPool& paths, bool clamp)
    {
        if (size_ == 0) return 0;
        const RayArrays rays{origin_.x.data,
                             origin_.y.data,
                             origin_.z.data,
                             direction_.x.data,
                             direction_.y.data,
                             direction_.z.data,
                             t_max_.data,
                             scene.tables.moving ? time_.data : nullptr,
                             size_};
        scene.bvh.occluded(rays, blocked_.data, false);
        std::size_t clear = 0;
        for (std::size_t k = 0; k < size_; ++k) {
            if (blocked_[k]) continue;
            ++clear;
            const float scale = clamp ? clamped(paths, path_[k], radiance_, k) : 1;
            for (int c = 0; c < channels; ++c) paths.radiance.c[c][path_[k]] += scale * radiance_.c[c][k];
        }
        return clear;
    }

private:
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
};

}  // namespace fathom::inline FATHOM_LANES
