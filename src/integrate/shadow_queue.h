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
        const auto keep = [&](int field, Float value) { compress_store(&data_[field][size_], value, m); };
        keep(origin, ray.o.x), keep(origin + 1, ray.o.y), keep(origin + 2, ray.o.z);
        keep(direction, ray.d.x), keep(direction + 1, ray.d.y), keep(direction + 2, ray.d.z);
        keep(t_max, ray.t_max), keep(time, ray.time);
        for (int c = 0; c < channels; ++c) keep(radiance + c, light.c[c]);
        compress_store(&path_[size_], iota() + UInt(std::uint32_t(first_path)), m);
        size_ += std::size_t(count(m));
    }

    /// Traces all, and adds what those that nothing blocks bring to the radiance of their paths.
    void trace(const LaneScene& scene, PathPool& paths)
    {
        if (size_ == 0) return;
        const auto& f = data_;
        scene.bvh.occluded({f[origin], f[origin + 1], f[origin + 2], f[direction], f[direction + 1], f[direction + 2],
                            f[t_max], scene.tables.moving ? f[time] : nullptr, size_},
                           blocked_, false);
        for (std::size_t k = 0; k < size_; ++k)
            if (!blocked_[k])
                for (int c = 0; c < channels; ++c) paths.data[PathPool::radiance + c][path_[k]] += f[radiance + c][k];
    }

private:
    enum Field { origin = 0, direction = 3, t_max = 6, time, radiance, field_count = radiance + channels };
    static constexpr std::size_t padded = PathPool::padded;

    std::size_t size_ = 0;
    alignas(64) float data_[field_count][padded];
    std::uint32_t path_[padded], blocked_[padded];
};

}  // namespace fathom::inline FATHOM_LANES
