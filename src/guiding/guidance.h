// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "guiding/records.h"
#include "math/elementary.h"
#include "math/spectrum.h"
#include "math/vec3.h"
#include "sampling/inversion.h"
#include "sampling/sobol.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Index of the axis direction that a normal is closest to: 0 to 5 for +x, -x, +y, -y, +z, -z.
inline UInt guiding_side(const Vec3& n)
{
    const Float x = abs(n.x), y = abs(n.y), z = abs(n.z);
    const Mask by_x = (x >= y) & (x >= z), by_y = y >= z;
    const Float along = select(by_x, n.x, select(by_y, n.y, n.z));
    return select(by_x, UInt(0u), select(by_y, UInt(2u), UInt(4u))) + select(along < Float(0), UInt(1u), UInt(0u));
}

/// Rotates d so that the direction of `side` becomes +z.
inline Vec3 to_histogram_frame(UInt side, const Vec3& d)
{
    const UInt axis = side >> 1;
    const Mask x = axis == UInt(0u), y = axis == UInt(1u);
    const Float z = select(x, d.x, select(y, d.y, d.z));
    return {select(x, d.y, select(y, d.z, d.x)), select(x, d.z, select(y, d.x, d.y)),
            select((side & UInt(1u)) != UInt(0u), -z, z)};
}
/// Inverse of to_histogram_frame().
inline Vec3 from_histogram_frame(UInt side, const Vec3& p)
{
    const UInt axis = side >> 1;
    const Mask x = axis == UInt(0u), y = axis == UInt(1u);
    const Float z = select((side & UInt(1u)) != UInt(0u), -p.z, p.z);
    return {select(x, z, select(y, p.y, p.x)), select(x, p.x, select(y, z, p.y)), select(x, p.y, select(y, p.x, z))};
}

/// Index of the histogram bin that contains the unit direction d.
inline UInt guiding_bin(UInt side, const Vec3& d)
{
    const auto whole = [](Float x, std::uint32_t n) {
        return to_uint(clamp(x * Float(float(n)), Float(0), Float(float(n - 1))));
    };
    const Vec3 p = to_histogram_frame(side, d);
    const Float turn = atan2(p.y, p.x) * Float(inv_pi * 0.5f);
    const UInt sector = whole(select(turn < Float(0), turn + Float(1), turn), guiding_sectors);
    return whole(fma(p.z, Float(0.5f), Float(0.5f)), guiding_bands) * UInt(guiding_sectors) + sector;
}

/// Derives three numbers in [0, 1) from one. They jitter positions, which hides the borders of guiding cubes.
inline Vec3 guiding_noise(Float x)
{
    const Float y = x * Float(0x1p8f), z = x * Float(0x1p16f);
    return {x, y - floor(y), z - floor(z)};
}

/// Index of the cube that contains p, after jittering p by up to half a cube. noise: from guiding_noise().
inline UInt guiding_cube(const GuidingTables& tables, const Vec3& p, const Vec3& noise)
{
    const auto cell = [&](Float x, Float shift, int axis) {
        const Float at = fma(x - Float(tables.lowest[axis]), Float(tables.inverse_cell), shift - Float(0.5f));
        return to_uint(clamp(at, Float(0), Float(float(tables.cells[axis] - 1))));
    };
    const UInt x = cell(p.x, noise.x, 0), y = cell(p.y, noise.y, 1), z = cell(p.z, noise.z, 2);
    return (z * UInt(tables.cells[1]) + y) * UInt(tables.cells[0]) + x;
}

/// Probability with which paths of the given throughput sample a light in their cubes.
inline Float nee_probability(const GuidingTables& tables, UInt cube, Float throughput, Mask m)
{
    constexpr float least = 1.f / 8;
    return clamp(gather(tables.nee_factors.data(), select(m, cube, UInt(0u)), m) * throughput, Float(least), Float(1));
}

/// Throughput that efficiency-aware roulette expects after scattering; mean of the channels. It is a little more than
/// the throughput on arrival times the color, because black surfaces may have coats that reflect.
inline Float expected_throughput(const Spectrum& arriving, const Spectrum& base_color)
{
    return mean(arriving * (base_color + Spectrum(Float(0.05f))));
}

/// Learned distribution of incident light at a gang of surface points; samples directions from it (path guiding).
class Guidance {
public:
    /// Creates a guidance that is off.
    Guidance() = default;
    /// Looks up the regions of the points p with shading normals n. noise: from guiding_noise(). weight: suitability of
    /// the closure for guiding, from 0 to 1; it scales the share of guided directions.
    Guidance(const GuidingTables& tables, const Vec3& p, const Vec3& n, const Vec3& noise, Float weight, Mask m)
        : tables_(&tables)
    {
        cube_ = select(m, guiding_cube(tables, p, noise), UInt(0u));
        side_ = guiding_side(n);
        const UInt region = gather(tables.regions.data(), cube_ * UInt(guiding_sides) + side_, m);
        known_ = m & (region != UInt(no_index));
        region_ = select(known_, region, UInt(0u));
        share_ = select(known_, weight * gather(tables.shares.data(), region_, known_), Float(0));
    }

    bool is_on() const { return tables_ != nullptr; }
    /// Lanes whose region has a learned distribution.
    Mask known() const { return known_; }
    /// Fraction of directions to take from sample(); 0 if the region has no learned distribution.
    Float share() const { return share_; }
    /// Survival probability divided by expected_throughput(), for Russian roulette.
    Float survival_factor() const { return gather(tables_->survival_factors.data(), region_, known_); }

    /// Probability with which the shadow ray of a light sample is traced. brings: contribution of the sample if
    /// unoccluded.
    Float shadow_ray_probability(Float brings, Mask m) const
    {
        constexpr float least = 0.1f;
        if (tables_->shadow_ray_factors.empty()) return Float(1);
        return clamp(gather(tables_->shadow_ray_factors.data(), cube_, m) * brings, Float(least), Float(1));
    }

    /// Samples a unit direction from the histogram.
    Vec3 sample(Sample2 u) const
    {
        const float* values = tables_->histograms.data();
        const UInt first = region_ * UInt(guiding_stride);
        const UInt bin = find_interval(values, first, guiding_bins, u.x);
        const Float begin = gather(values, first + bin), end = gather(values + 1, first + bin);
        const Float within = clamp((u.x - begin) / max(end - begin, Float(1e-20f)), Float(0), Float(1 - 0x1p-24f));
        const Float band = to_float(bin >> band_shift), sector = to_float(bin & UInt(guiding_sectors - 1));
        const Float z = fma(band + u.y, Float(2.f / guiding_bands), Float(-1));
        const SinCos turn = sincos_2pi((sector + within) * Float(1.f / guiding_sectors));
        const Float r = sqrt(max(fma(-z, z, Float(1)), Float(0)));
        return from_histogram_frame(side_, {turn.cos * r, turn.sin * r, z});
    }
    /// Density of sample() for the direction d, with respect to solid angle.
    Float histogram_pdf(const Vec3& d) const
    {
        const float* values = tables_->histograms.data();
        const UInt at = region_ * UInt(guiding_stride) + guiding_bin(side_, d);
        const Float share = gather(values + 1, at) - gather(values, at);
        return share * Float(guiding_bins * inv_pi * 0.25f);
    }
    /// Density of the mixture of guided and BSDF sampling (one-sample MIS). bsdf_pdf: density of the closure for d.
    Float pdf(const Vec3& d, Float bsdf_pdf) const { return fma(share_, histogram_pdf(d) - bsdf_pdf, bsdf_pdf); }

private:
    static constexpr int band_shift = 4;
    static_assert(guiding_sectors == 1u << band_shift);

    const GuidingTables* tables_ = nullptr;
    UInt cube_, side_, region_;
    Mask known_;
    Float share_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
