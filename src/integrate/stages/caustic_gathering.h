// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/direct.h"
#include "integrate/stages/shading_point.h"
#include "kernel/caustic_map.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Gathers photons of caustics around the vertices of camera paths (Jensen 1996, "Global Illumination Using Photon
/// Maps"; radii by Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach").
class CausticGathering {
public:
    /// map: nullptr if nothing is gathered
    CausticGathering(const CausticMap* map, const KernelSettings& settings) : map_(map), settings_(settings) {}
    bool is_on() const { return map_ != nullptr; }

    /// Radiance toward the previous vertices that the photons around the vertices bring, for the lanes of m. sample:
    /// index of each path's sample; bounce: number of bounces before the vertex.
    template <class Closure>
    [[gnu::noinline]] Spectrum gather(const Closure& closure, const ShadingPoint<Closure>& at, UInt sample, UInt bounce,
                                      Mask m) const
    {
        Spectrum sum(Float(0));
        m &= closure.has_non_delta();
        if (none(m) || map_->photons.empty()) return sum;
        const Float radius = fathom::gather(map_->radii.data(), sample - UInt(map_->first_sample), m);
        const Float inverse_cell = Float(0.5f) / max(radius, Float(1e-37f));
        const auto first_cell = [&](Float x) { return floor(fma(x, inverse_cell, Float(-0.5f))); };
        const Vec3 first{first_cell(at.p.x), first_cell(at.p.y), first_cell(at.p.z)};
        for (int corner = 0; corner < 8; ++corner) {
            const auto coordinate = [&](Float x, int axis) { return x + Float(float(corner >> axis & 1)); };
            const Vec3 cell{coordinate(first.x, 0), coordinate(first.y, 1), coordinate(first.z, 2)};
            add_cell(closure, at, {sample, bounce, radius, inverse_cell, cell}, m, sum);
        }
        return sum * (Float(float(inv_pi)) / max(radius * radius, Float(1e-37f)));
    }

private:
    struct Query {
        UInt sample, bounce;
        Float radius, inverse_cell;
        Vec3 cell;
    };

    /// Adds the photons of one cell of the grid.
    template <class Closure>
    void add_cell(const Closure& closure, const ShadingPoint<Closure>& at, const Query& q, Mask m, Spectrum& sum) const
    {
        // Adding 0 turns -0 into 0.
        const auto bits = [](Float x) { return float_bits(x + Float(0)); };
        const UInt bucket =
            caustic_cell_hash(bits(q.cell.x), bits(q.cell.y), bits(q.cell.z), q.sample) & UInt(map_->bucket_mask);
        UInt next = fathom::gather(map_->buckets.data(), bucket, m);
        const UInt end = fathom::gather(map_->buckets.data() + 1, bucket, m);
        for (Mask left = m & less(next, end); any(left); left &= less(next, end)) {
            add_photon(closure, at, q, next, left, sum);
            next = next + UInt(1u);
        }
    }

    template <class Closure>
    void add_photon(const Closure& closure, const ShadingPoint<Closure>& at, const Query& q, UInt index, Mask m,
                    Spectrum& sum) const
    {
        Float row[16];
        gather_row(reinterpret_cast<const float*>(map_->photons.data()), index * UInt(16u), m, row);
        const Vec3 p{row[0], row[1], row[2]}, to_light{row[3], row[4], row[5]}, normal{row[6], row[7], row[8]};
        const auto is_in = [&](Float x, Float cell) { return floor(x * q.inverse_cell) == cell; };
        m &= float_bits(row[12]) == q.sample;
        m &= is_in(p.x, q.cell.x) & is_in(p.y, q.cell.y) & is_in(p.z, q.cell.z);
        const Vec3 away = p - at.p;
        m &= dot(away, away) < q.radius * q.radius;
        // Photons of other surfaces nearby do not count.
        m &= abs(dot(normal, at.ng)) > Float(least_cosine);
        if (settings_.max_depth >= 0)
            m &= less(q.bounce + float_bits(row[14]), UInt(std::uint32_t(settings_.max_depth)));
        const Vec3 wi = at.frame.to_local(to_light);
        m &= equal(wi.z > Float(0), dot(to_light, at.ng) > Float(0));
        if (Closure::transmits)
            m &= !at.skips_interface;
        else
            m &= wi.z > Float(0);
        if (none(m)) return;
        const BsdfEval e = eval_for_light(closure, at.wo, wi, Mask(false));
        // The flux is per area of the surface, and f_cos contains the cosine to the shading normal.
        const Float inverse_cosine = Float(1) / max(abs(dot(to_light, at.ng)), Float(least_incidence));
        Spectrum power;
        for (int c = 0; c < channels; ++c) power.c[c] = row[9 + c];
        sum = sum + select(m, e.f_cos * power * inverse_cosine, Spectrum(Float(0)));
    }

    static constexpr float least_cosine = 0.7f;
    static constexpr float least_incidence = 0.02f;

    const CausticMap* map_;
    const KernelSettings& settings_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
