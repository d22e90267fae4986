#pragma once
#include <algorithm>
#include <vector>

#include "guiding/guidance.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Notes where paths are scattered, what light samples bring them there, which directions they take, and what comes
/// back along these.
class PathRecorder {
public:
    /// to: where records go when all paths have ended; nullptr: nothing is noted. paths: how many there will be,
    /// numbered from 0 on.
    PathRecorder(GuidingRecords* to, std::size_t paths) : to_(to)
    {
        if (!to_) return;
        vertices_.resize(paths * max_vertices);
        to_->radiance.resize(paths);
    }
    bool is_on() const { return to_ != nullptr; }

    /// The first `active` paths of the pool have met surfaces that are going to scatter them.
    void record_surfaces(const PathPool& paths, const HitColumns& hits, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) {
            const std::uint32_t bounce = paths.state[i] & PathPool::bounce_mask;
            if (bounce >= max_vertices) continue;
            const auto along = [&](const Column<float>& o, const Column<float>& d) { return o[i] + hits.t[i] * d[i]; };
            Vertex v;
            v.position[0] = along(paths.origin.x, paths.direction.x);
            v.position[1] = along(paths.origin.y, paths.direction.y);
            v.position[2] = along(paths.origin.z, paths.direction.z);
            v.throughput = mean_of(paths.throughput, i);
            v.before = v.lit = mean_of(paths.radiance, i);
            vertices_[first_vertex(paths, i) + bounce] = v;
        }
    }
    /// Paths that have met `bounce` surfaces before leave one whose normal is n along wi.
    ///
    /// number: of each path. throughput: from there on. pdf: of having sampled wi.
    void record_directions(UInt number, UInt bounce, const Vec3& n, const Vec3& wi, Float pdf, const Spectrum& throughput, Mask m)
    {
        const Float factor = abs(dot(n, wi)) / (pdf * mean(throughput));
        m &= less(bounce, UInt(max_vertices)) & (factor > Float(0)) & (factor < Float(1e30f));
        const UInt side = guiding_side(n);
        float factors[lanes];
        std::uint32_t at[lanes], sides[lanes], bins[lanes];
        store(factors, factor), store(at, number * UInt(max_vertices) + bounce);
        store(sides, side), store(bins, guiding_bin(side, wi));
        for_each_active(m, [&](int i) {
            Vertex& v = vertices_[at[i]];
            v.side = std::uint16_t(sides[i]), v.bin = std::uint16_t(bins[i]), v.factor = factors[i];
        });
    }
    /// Notes what light samples have brought the pool's paths, before these see what lies along their last directions.
    void record_light_samples(const PathPool& paths, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) note_light(paths, i);
    }
    /// A path has ended.
    void end_path(const PathPool& paths, std::size_t i)
    {
        // By its surface, where it came by its light sample, or by what it met after that, which came before.
        if (paths.state[i] & PathPool::dead) note_light(paths, i);
        to_->radiance[paths.number[i]] = mean_of(paths.radiance, i);
    }
    /// Hands all records over, path by path.
    void finish()
    {
        if (!to_) return;
        const auto is_there = [](const Vertex& v) { return v.throughput > 0; };
        to_->surfaces.reserve(std::size_t(std::count_if(vertices_.begin(), vertices_.end(), is_there)));
        to_->counts.reserve(to_->radiance.size());
        for (std::size_t path = 0; path < to_->radiance.size(); ++path) {
            const std::size_t before = to_->surfaces.size();
            for (std::size_t i = path * max_vertices; i < (path + 1) * max_vertices; ++i)
                if (is_there(vertices_[i])) to_->surfaces.push_back(record(vertices_[i], to_->radiance[path]));
            to_->counts.push_back(std::uint8_t(to_->surfaces.size() - before));
        }
    }

private:
    static constexpr std::uint32_t max_vertices = 8;
    struct Vertex {
        float position[3];
        std::uint16_t side = 0, bin = GuidingRecord::no_bin;
        float factor = 0;      ///< of radiance in the record's value
        float throughput = 0;  ///< of the path when it came there; 0: there was no such vertex
        float before = 0;      ///< radiance of the path by then
        float lit = 0;         ///< the same with what the light sample brought
    };

    void note_light(const PathPool& paths, std::size_t i)
    {
        const std::uint32_t bounce = paths.state[i] & PathPool::bounce_mask;
        if (bounce > 0 && bounce <= max_vertices)
            vertices_[first_vertex(paths, i) + bounce - 1].lit = mean_of(paths.radiance, i);
    }
    /// all: radiance of the path at its end.
    static GuidingRecord record(const Vertex& v, float all)
    {
        GuidingRecord r{{v.position[0], v.position[1], v.position[2]}, v.side, v.bin, 0, 0};
        r.value = v.factor * std::max(all - v.lit, 0.f);
        r.light = std::max(v.lit - v.before, 0.f) / v.throughput;
        return r;
    }
    static std::size_t first_vertex(const PathPool& paths, std::size_t i)
    {
        return std::size_t(paths.number[i]) * max_vertices;
    }
    static float mean_of(const SpectrumColumn& column, std::size_t i)
    {
        float sum = 0;
        for (int k = 0; k < channels; ++k) sum += column.c[k][i];
        return sum * (1.f / channels);
    }

    GuidingRecords* to_;
    std::vector<Vertex> vertices_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
