// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <vector>

#include "guiding/guidance.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Records training data for path guiding: where paths scatter, the contributions of light samples there, the
/// directions taken, and the radiance that arrives along them.
class PathRecorder {
public:
    /// to: receives the records after all paths have ended; nullptr disables recording. paths: number of paths,
    /// numbered from 0.
    PathRecorder(GuidingRecords* to, std::size_t paths) : to_(to)
    {
        if (!to_) return;
        vertices_.resize(paths * max_vertices);
        to_->radiance.resize(paths);
    }
    bool is_on() const { return to_ != nullptr; }

    /// Records the vertices of the pool's first `active` paths, which are about to be scattered by surfaces.
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
    /// How paths leave a vertex. Densities are with respect to solid angle.
    struct Departure {
        Vec3 n, wi;               ///< shading normal and direction
        Float pdf, bsdf_pdf;      ///< density of wi, and that by the closure alone
        Spectrum throughput;      ///< after scattering
        Float arrived, guidable;  ///< GuidingRecord::throughput, and guided_weight() of the closure
    };
    /// Records the directions in which paths leave vertex number `bounce`. number: number of each path.
    void record_directions(UInt number, UInt bounce, const Departure& d, Mask m)
    {
        const Float factor = abs(dot(d.n, d.wi)) / (d.pdf * mean(d.throughput));
        m &= less(bounce, UInt(max_vertices)) & (factor > Float(0)) & (factor < Float(1e30f));
        const UInt side = guiding_side(d.n);
        float factors[lanes], pdfs[lanes], arrived[lanes], guidable[lanes];
        store(pdfs, d.bsdf_pdf), store(arrived, d.arrived);
        store(guidable, d.guidable * Float(float(GuidingRecord::fully_guidable)));
        std::uint32_t at[lanes], sides[lanes], bins[lanes];
        store(factors, factor), store(at, number * UInt(max_vertices) + bounce);
        store(sides, side), store(bins, guiding_bin(side, d.wi));
        for_each_active(m, [&](int i) {
            Vertex& v = vertices_[at[i]];
            v.side = std::uint8_t(sides[i]), v.bin = std::uint16_t(bins[i]), v.factor = factors[i];
            v.guidable = std::uint8_t(guidable[i]), v.bsdf_pdf = pdfs[i], v.arrived = arrived[i];
        });
    }
    /// Records the contributions of light samples at the last vertices. Must run before emission along the new
    /// directions is added.
    void record_light_samples(const PathPool& paths, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) note_light(paths, i);
    }
    /// Records the radiance of a path that has ended.
    void end_path(const PathPool& paths, std::size_t i)
    {
        // record_light_samples() does not see paths that died while shading, so their last light sample is recorded
        // here.
        if (paths.state[i] & PathPool::dead) note_light(paths, i);
        to_->radiance[paths.number[i]] = mean_of(paths.radiance, i);
    }
    /// Writes all records, path by path.
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
    /// A recorded path vertex.
    struct Vertex {
        float position[3];
        std::uint8_t side = 0, guidable = 0;
        std::uint16_t bin = GuidingRecord::no_bin;
        float bsdf_pdf = 0, arrived = 0;  ///< GuidingRecord::bsdf_pdf and throughput
        float factor = 0;                 ///< cosine / (pdf * mean throughput): scales radiance to the record's value
        float throughput = 0;             ///< throughput of the path on arrival; 0: no such vertex
        float before = 0;                 ///< radiance of the path on arrival
        float lit = 0;                    ///< radiance of the path including the light sample of this vertex
    };

    void note_light(const PathPool& paths, std::size_t i)
    {
        const std::uint32_t bounce = paths.state[i] & PathPool::bounce_mask;
        if (bounce > 0 && bounce <= max_vertices)
            vertices_[first_vertex(paths, i) + bounce - 1].lit = mean_of(paths.radiance, i);
    }
    /// all: final radiance of the path.
    static GuidingRecord record(const Vertex& v, float all)
    {
        GuidingRecord r{{v.position[0], v.position[1], v.position[2]}, v.side, v.guidable, v.bin};
        r.contribution = std::max(all - v.lit, 0.f);
        r.value = v.factor * r.contribution;
        r.throughput = v.arrived, r.bsdf_pdf = v.bsdf_pdf;
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
