// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/closures/measured_warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Measured BRDF: Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and
/// Rendering". The density of visible normals (vndf) maps directions to the unit square. Tables over that square hold
/// the reflectance, relative to perfectly reflecting microfacets, and the density by which directions are sampled
/// (luminance). Tables are interpolated linearly, over the square and between measured directions.
///
/// The direction that selects tables is wo, as in pbrt and Mitsuba.
class MeasuredBsdf : public ClosureOf<ClosureKind::measured, MeasuredMaterialPoint> {
public:
    explicit MeasuredBsdf(const MeasuredMaterialPoint& m) : d_(m.measured)
    {
        const Float length2 = fma(d_.tangent.x, d_.tangent.x, d_.tangent.y * d_.tangent.y);
        const Mask known = length2 > Float(1e-12f);
        const Float inverse = inverse_sqrt(max(length2, Float(1e-12f)));
        cos_ = select(known, d_.tangent.x * inverse, Float(1));
        sin_ = select(known, d_.tangent.y * inverse, Float(0));
    }

    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Path path = path_of(wo);
        const Vec3 m = normalize(path.wo + to_measured(path, wi));
        const Float sine = sqrt(fma(m.x, m.x, m.y * m.y));
        const Float v = fma(atan2(m.y, m.x) - path.normals_from, Float(0.5f * inv_pi), Float(0.5f));
        const Normal normal{u_of(atan2(sine, m.z)), v - floor(v), sine, dot(path.wo, m)};
        const MeasuredWarp::Place even = MeasuredWarp(d_.values, d_.vndf, path.slices).invert(normal.u, normal.v);
        const Float luminance = MeasuredWarp(d_.values, d_.luminance, path.slices).density(even.u, even.v);
        return evaluate(path, normal, even.u, even.v, even.density * luminance, wi.z > Float(0));
    }

    BsdfSample sample(Vec3 wo, Sample2 random, Float) const
    {
        const Path path = path_of(wo);
        const MeasuredWarp::Place even = MeasuredWarp(d_.values, d_.luminance, path.slices).sample(random.x, random.y);
        const MeasuredWarp::Place place = MeasuredWarp(d_.values, d_.vndf, path.slices).sample(even.u, even.v);
        const SinCos theta = sincos_2pi(place.u * place.u * Float(0.25f));
        const SinCos phi = sincos_2pi(fma(path.normals_from, Float(0.5f * inv_pi), place.v - Float(0.5f)));
        const Vec3 m(theta.sin * phi.cos, theta.sin * phi.sin, theta.cos);
        const Float cosine = dot(path.wo, m);
        const Vec3 wi = from_measured(path, normalize(fma(m, cosine * Float(2), -path.wo)));
        const BsdfEval e = evaluate(path, {place.u, place.v, theta.sin, cosine}, even.u, even.v,
                                    place.density * even.density, wi.z > Float(0));
        return reflection(wi, e);
    }

private:
    /// A microfacet normal as a point of the unit square, with related sines and cosines.
    struct Normal {
        Float u, v, sine;  ///< position in the unit square; sine of the normal's theta
        Float cosine;      ///< cosine between the normal and wo
    };

    /// wo in the frame of the measurement, and the tables to interpolate for it.
    struct Path {
        Vec3 wo;
        Float signs_x, signs_y;  ///< signs of the mirrorings that take wo to a measured direction
        Float u, v;              ///< wo as a point of the unit square
        Float normals_from;      ///< azimuth relative to which the azimuths of normals are counted
        MeasuredSlices slices;
    };

    Path path_of(Vec3 w) const
    {
        const Vec3 t = to_tangent(w);
        // Tables of surfaces with symmetry 2 or 4 cover only wo of negative x and y.
        const Mask mirrored = less(UInt(1u), d_.symmetry);
        const Float signs_x = select(mirrored, -select(d_.symmetry == UInt(4u), t.x, t.y), Float(1)),
                    signs_y = select(mirrored, -t.y, Float(1));
        const Vec3 wo(flip_sign(t.x, signs_x), flip_sign(t.y, signs_y), t.z);
        const Float phi = atan2(wo.y, wo.x), theta = atan2(sqrt(fma(wo.x, wo.x, wo.y * wo.y)), wo.z);
        return {wo,
                signs_x,
                signs_y,
                u_of(theta),
                fma(phi, Float(0.5f * inv_pi), Float(0.5f)),
                select(less(UInt(2u), d_.phi_count), Float(0), phi),
                MeasuredSlices(d_, theta, phi)};
    }
    Vec3 to_measured(const Path& path, Vec3 w) const
    {
        const Vec3 t = to_tangent(w);
        return {flip_sign(t.x, path.signs_x), flip_sign(t.y, path.signs_y), t.z};
    }
    Vec3 from_measured(const Path& path, Vec3 w) const
    {
        return from_tangent({flip_sign(w.x, path.signs_x), flip_sign(w.y, path.signs_y), w.z});
    }

    /// Inverse of theta = u^2 pi / 2.
    static Float u_of(Float theta) { return sqrt(theta * Float(2 * inv_pi)); }

    /// Rotates from the shading frame to the frame of the measurement: x along the tangent, y as seen from the front of
    /// the surface, also for paths behind it.
    Vec3 to_tangent(Vec3 w) const
    {
        return {fma(w.x, cos_, w.y * sin_), flip_sign(fma(w.y, cos_, -(w.x * sin_)), d_.facing), w.z};
    }
    Vec3 from_tangent(Vec3 w) const
    {
        const Float y = flip_sign(w.y, d_.facing);
        return {fma(w.x, cos_, -(y * sin_)), fma(w.x, sin_, y * cos_), w.z};
    }

    /// Evaluates the BRDF for a normal. even_u, even_v: uniform numbers that the vndf warp maps to the normal. density:
    /// density of the normal over the unit square.
    BsdfEval evaluate(const Path& path, const Normal& normal, Float even_u, Float even_v, Float density,
                      Mask above) const
    {
        const float* const values = d_.values;
        const MeasuredCell cell(d_.color, even_u, even_v);
        const UInt size = d_.color.width * d_.color.height;
        Spectrum f;
        for (int c = 0; c < channels; ++c)
            f.c[c] = path.slices.mixed([&](UInt slice) {
                const UInt first =
                    d_.color.first + (slice * UInt(std::uint32_t(channels)) + UInt(std::uint32_t(c))) * size;
                return measured_value(values, first, d_.color.width, cell);
            });
        const Float ndf = measured_value(values, d_.ndf, normal.u, normal.v),
                    sigma = measured_value(values, d_.sigma, path.u, path.v);
        const Float facets = select(d_.color_is_per_facet, ndf / max(sigma * Float(4), Float(1e-10f)), Float(1));
        // Jacobian from the square to directions: theta = u^2 pi / 2 and phi = (2 v - 1) pi, and reflection about the
        // normal.
        const Float steps = normal.u * normal.sine * normal.cosine * Float(8 * pi * pi);
        const Mask valid = above & (steps > Float(1e-20f));
        const Float pdf = select(valid, density / max(steps, Float(1e-20f)), Float(0));
        for (Float& x : f.c) x = select(valid, max(x, Float(0)) * facets, Float(0));
        return {f, pdf};
    }

    MeasuredPoint d_;
    Float cos_, sin_;  ///< cosine and sine of the tangent's angle in the shading frame
};

}  // namespace FATHOM_LANES
}  // namespace fathom
