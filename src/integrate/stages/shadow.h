#pragma once
#include "integrate/pool.h"
#include "integrate/scene.h"

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

    /// Traces all, and adds what those that nothing blocks bring to the radiance of their paths.
    void trace(const LaneScene& scene, PathPool& paths)
    {
        if (size_ == 0) return;
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
        for (std::size_t k = 0; k < size_; ++k)
            if (!blocked_[k])
                for (int c = 0; c < channels; ++c) paths.radiance.c[c][path_[k]] += radiance_.c[c][k];
    }

private:
    std::size_t size_ = 0;
    VectorColumn origin_, direction_;
    Column<float> t_max_, time_;
    SpectrumColumn radiance_;
    Column<std::uint32_t> path_, blocked_;
};

}  // namespace fathom::inline FATHOM_LANES
