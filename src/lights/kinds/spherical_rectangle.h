// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Samples a rectangle uniformly by the solid angle that it subtends: Urena, Fajardo, King 2013, "An Area-Preserving
/// Parametrization for Spherical Rectangles".
///
/// The paper adds four arc cosines; this code multiplies complex numbers whose arguments are the angles. The product
/// needs one arc tangent: fewer operations, and less cancellation for small solid angles.
#include "math/elementary.h"
#include "math/vec3.h"
#include "sampling/sobol.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The rectangle as seen from a point, in its own axes: it spans [x0, x1] x [y0, y1] at height z0 <= 0.
struct SphericalRectangle {
    Float x0, x1, y0, y1, z0;
    Float solid_angle;
    Float b0, b1;        ///< z components of the unit normals of the planes through the point and the edges y0 and y1
    Float c0;            ///< 1 - b0^2
    Float cos_k, sin_k;  ///< cosine and sine of k = 2 pi - g2 - g3 of the paper

    /// corner: corner of the rectangle, relative to the point. u, v, n: unit axes of the rectangle. length_u, length_v:
    /// its lengths along u and v.
    [[gnu::always_inline]] SphericalRectangle(Vec3 corner, Vec3 u, Vec3 v, Vec3 n, Float length_u, Float length_v)
    {
        x0 = dot(corner, u);
        y0 = dot(corner, v);
        z0 = -abs(dot(corner, n));
        x1 = x0 + length_u;
        y1 = y0 + length_v;
        const Float z2 = z0 * z0, x02 = x0 * x0, x12 = x1 * x1, y02 = y0 * y0, y12 = y1 * y1;
        // Inner angles g of the spherical quadrilateral as complex numbers. In the paper cos g = -n_i n_j, with z
        // components of the edge normals. Multiplied out, the sine is |z0| times the distance of the corner, without
        // cancellation.
        const Complex g0{x1 * y0, -z0 * sqrt(x12 + y02 + z2)}, g1{-(x1 * y1), -z0 * sqrt(x12 + y12 + z2)};
        const Complex g2{x0 * y1, -z0 * sqrt(x02 + y12 + z2)}, g3{-(x0 * y0), -z0 * sqrt(x02 + y02 + z2)};
        Complex g23 = g2 * g3;
        const Float scale = inverse_sqrt(fma(g23.re, g23.re, g23.im * g23.im));
        g23 = {g23.re * scale, g23.im * scale};
        // The solid angle is g0 + g1 + g2 + g3 - 2 pi, in [0, 2 pi).
        const Complex product = (g0 * g1) * g23;
        const Float angle = atan2(product.im, product.re);
        solid_angle = select(angle < Float(0), angle + Float(2 * pi), angle);
        cos_k = g23.re;
        sin_k = -g23.im;
        const Float s0 = inverse_sqrt(y02 + z2);
        b0 = -(y0 * s0);
        b1 = y1 * inverse_sqrt(y12 + z2);
        c0 = z2 * s0 * s0;
    }

    struct Point {
        Float x, y;  ///< coordinates in the rectangle's axes, relative to the projection of the eye
    };
    [[gnu::always_inline]] Point sample(Sample2 random) const
    {
        const SinCos a = sincos_2pi(random.x * solid_angle * Float(0.5f * inv_pi));
        // au = random * S + k. The paper's fu and cu are multiplied out:
        // xu = -z0 sign(fu) / sqrt(fu^2 + b0^2 - 1) with fu = f / sin au.
        const Float cos_au = fma(a.cos, cos_k, -(a.sin * sin_k));
        const Float sin_au = fma(a.sin, cos_k, a.cos * sin_k);
        const Float f = fma(cos_au, b0, -b1);
        const Float rest = max(fma(f, f, -(c0 * sin_au * sin_au)), Float(1e-30f));
        const Float xu = clamp(flip_sign(-z0 * sin_au, f) * inverse_sqrt(rest), x0, x1);
        const Float d2 = fma(xu, xu, z0 * z0);
        const Float h0 = y0 * inverse_sqrt(fma(y0, y0, d2));
        const Float h1 = y1 * inverse_sqrt(fma(y1, y1, d2));
        const Float hv = fma(random.y, h1 - h0, h0);
        const Float yv = hv * d2 * inverse_sqrt(max(d2 * fma(-hv, hv, Float(1)), Float(1e-30f)));
        return {xu, clamp(yv, y0, y1)};
    }

private:
    struct Complex {
        Float re, im;
        Complex operator*(Complex o) const { return {fma(re, o.re, -(im * o.im)), fma(re, o.im, im * o.re)}; }
    };
};

}  // namespace FATHOM_LANES
}  // namespace fathom
