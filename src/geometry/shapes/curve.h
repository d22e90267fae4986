// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Curves: cubic Bezier segments or lines with varying radius, divided in straight pieces that are intersected by
/// lanes. The pieces define the surface: shading recomputes them to bitwise equal values.
#include <type_traits>

#include "geometry/ray.h"

namespace fathom {

/// A point of a curve and the radius there. F: float or Float.
template <class F>
struct CurvePoint {
    F x, y, z, r;
};

/// Linear interpolation by separate products and sums, never fused, so that floats and lanes agree bitwise.
template <class F>
CurvePoint<F> between(const CurvePoint<F>& a, const CurvePoint<F>& b, F t)
{
    const auto mean = [&](F p, F q) { return p + (q - p) * t; };
    return {mean(a.x, b.x), mean(a.y, b.y), mean(a.z, b.z), mean(a.r, b.r)};
}

/// Point of a cubic segment at t in [0, 1], by de Casteljau's algorithm.
template <class F>
CurvePoint<F> bezier(const CurvePoint<F> p[4], F t)
{
    CurvePoint<F> q[4] = {p[0], p[1], p[2], p[3]};
    for (int n = 3; n > 0; --n)
        for (int i = 0; i < n; ++i) q[i] = between(q[i], q[i + 1], t);
    return q[0];
}
/// Derivative of a cubic segment at t, up to a factor.
template <class F>
CurvePoint<F> bezier_tangent(const CurvePoint<F> p[4], F t)
{
    const auto minus = [](const CurvePoint<F>& a, const CurvePoint<F>& b) {
        return CurvePoint<F>{a.x - b.x, a.y - b.y, a.z - b.z, a.r - b.r};
    };
    CurvePoint<F> q[3] = {minus(p[1], p[0]), minus(p[2], p[1]), minus(p[3], p[2])};
    for (int n = 2; n > 0; --n)
        for (int i = 0; i < n; ++i) q[i] = between(q[i], q[i + 1], t);
    return q[0];
}

inline namespace FATHOM_LANES {

/// Curve pieces, one per lane.
struct CurvePiece {
    Vec3 a, b;     ///< ends of the axis
    Float ra, rb;  ///< radii at the ends
};

/// Lanes whose piece a ray's line (of unit direction) may meet: a quick test that never leaves out a piece that is met.
///
/// The distance of the line from the axis is compared with the larger radius. Where the ray runs along the axis, the
/// nearest point is uncertain by the square root of the rounding error, hence the margin that grows with the length.
inline Mask may_meet_round_piece(const CurvePiece& piece, const Vec3& o, const Vec3& d)
{
    const Vec3 whole = piece.b - piece.a, far = o - piece.a;
    const Float t = dot(d, far), length2 = dot(whole, whole), m = dot(whole, d);
    const Vec3 q = fma(d, -t, far);  // The line's point nearest to a, relative to it.
    const Float w = dot(whole, q) / max(fma(-m, m, length2), length2 * Float(1e-7f) + Float(1e-37f));
    const Float place = select(w > Float(0), min(w, Float(1)), Float(0));
    const Vec3 from_axis = fma(whole, -place, q);
    const Vec3 across = fma(d, -dot(d, from_axis), from_axis);
    const Float reach = max(piece.ra, piece.rb) + Float(0x1p-20f) * (abs(t) + abs(o.x) + abs(o.y) + abs(o.z));
    return dot(across, across) <= fma(reach, reach, length2 * Float(0x1p-20f)) * Float(1.01f);
}

/// Intersection of a ray's line (of unit direction) with the lateral surface of a round piece.
///
/// The piece is the volume swept by a ball whose center moves from a to b while its radius changes from ra to rb. A
/// point p is on the lateral surface if the minimum over w of |p - c(w)|^2 - r(w)^2 is 0; for a point of the ray,
/// inserting the minimizing w gives a quadratic in t. All values are computed relative to the point of the axis that is
/// nearest to the ray, which keeps the precision of long, thin pieces. Han, Wald, Usher et al. 2019, "Ray Tracing
/// Generalized Tube Primitives: Method and Applications", describes the geometry; the solution here differs.
struct RoundSide {
    Mask met;
    Float t0;                        ///< distance at which the ray passes the reference point of the axis
    Float alpha, beta, gamma, root;  ///< coefficients of the quadratic in t - t0, and the root of its discriminant
    Float w0, m, n, A, inverse;

    RoundSide(const CurvePiece& piece, const Vec3& o, const Vec3& d)
    {
        const Vec3 whole = piece.b - piece.a, q = o - piece.a;
        const Float length2 = dot(whole, whole);
        // A piece of length 0 is a sphere.
        inverse = select(length2 > Float(0), Float(1) / sqrt(length2), Float(0));
        const Vec3 e = whole * inverse;
        const Float g = (piece.rb - piece.ra) * inverse;
        m = dot(e, d);
        const Float nearest = (dot(e, q) - m * dot(d, q)) / max(Float(1) - m * m, Float(1e-7f)) * inverse;
        // Any reference point on the axis is valid; the comparison replaces NaN by 0.
        w0 = select(nearest > Float(0), min(nearest, Float(1)), Float(0));
        const Vec3 c = fma(whole, w0, piece.a);
        const Float r = fma(piece.rb - piece.ra, w0, piece.ra);
        t0 = dot(d, c - o);
        const Vec3 f = fma(d, t0, o - c);

        n = fma(g, r, dot(e, f));
        A = fma(-g, g, Float(1));
        const Float fd = dot(f, d);
        alpha = fma(-m, m, A), beta = fma(A, fd, -(m * n)), gamma = fma(A, fma(-r, r, dot(f, f)), -(n * n));
        const Float discriminant = fma(beta, beta, -(alpha * gamma));
        root = sqrt(max(discriminant, Float(0)));
        met = (A > Float(0)) & (discriminant >= Float(0));
    }
    /// The roots at which the ray enters and leaves, relative to t0.
    Float entry() const { return select(beta < Float(0), gamma / (root - beta), -(beta + root) / alpha); }
    Float exit() const { return select(beta > Float(0), -gamma / (root + beta), (root - beta) / alpha); }
    /// Position along the piece at distance t0 + t.
    Float place(Float t) const { return w0 + fma(m, t, n) / A * inverse; }
};

/// Lanes whose ray (of unit direction) enters the piece from outside at 0 < t <= t_max. w: position along the piece, in
/// [0, 1].
inline Mask intersect_round_piece(const CurvePiece& piece, const Vec3& o, const Vec3& d, Float t_max, Float& t,
                                  Float& w)
{
    const RoundSide side(piece, o, d);
    const Float side_t = side.entry(), side_w = side.place(side_t);
    t = side.t0 + side_t;
    w = side_w;
    Mask found = side.met & (side_w >= Float(0)) & (side_w <= Float(1)) & (t > Float(0));
    const auto cap = [&](const Vec3& center, Float radius, Float place) {
        const Float tc = dot(d, center - o);
        const Vec3 foot = fma(d, tc, o - center);
        const Float h = fma(radius, radius, -dot(foot, foot));
        const Float tt = tc - sqrt(max(h, Float(0)));
        const Mask nearer = (h > Float(0)) & (tt > Float(0)) & ((!found) | (tt < t));
        t = select(nearer, tt, t);
        w = select(nearer, place, w);
        found |= nearer;
    };
    cap(piece.a, piece.ra, Float(0));
    cap(piece.b, piece.rb, Float(1));
    return found & (t <= t_max);
}

/// Interval of a ray's line inside a round piece, which is convex: distances and positions along the piece at both
/// ends.
struct RoundSpan {
    Mask met;
    Float t_in, w_in, t_out, w_out;
};

/// Both intersections of a ray's line with a round piece, independent of the ray's origin.
inline RoundSpan span_of_round_piece(const CurvePiece& piece, const Vec3& o, const Vec3& d)
{
    const RoundSide round(piece, o, d);
    RoundSpan s{Mask(false), Float(infinity), Float(0), Float(-infinity), Float(0)};
    const auto offer = [&](Mask enters, Mask leaves, Float t, Float w) {
        const Mask first = enters & (t < s.t_in), last = leaves & (t > s.t_out);
        s.t_in = select(first, t, s.t_in), s.w_in = select(first, w, s.w_in);
        s.t_out = select(last, t, s.t_out), s.w_out = select(last, w, s.w_out);
        s.met |= enters | leaves;
    };
    const auto side = [&](Float t, bool enters) {
        const Float w = round.place(t);
        const Mask on_it = round.met & (w >= Float(0)) & (w <= Float(1));
        offer(enters ? on_it : Mask(false), enters ? Mask(false) : on_it, round.t0 + t, w);
    };
    side(round.entry(), true);
    side(round.exit(), false);
    const auto ball = [&](const Vec3& center, Float radius, Float place) {
        const Float tc = dot(d, center - o);
        const Vec3 foot = fma(d, tc, o - center);
        const Float h = fma(radius, radius, -dot(foot, foot)), half = sqrt(max(h, Float(0)));
        offer(h > Float(0), Mask(false), tc - half, place);
        offer(Mask(false), h > Float(0), tc + half, place);
    };
    ball(piece.a, piece.ra, Float(0));
    ball(piece.b, piece.rb, Float(1));
    s.met &= s.t_in <= s.t_out;
    return s;
}

/// Lanes whose point is inside a round piece by more than rounding.
inline Mask is_within_round_piece(const CurvePiece& piece, const Vec3& p)
{
    const Vec3 whole = piece.b - piece.a, q = p - piece.a;
    const Float g = piece.rb - piece.ra, A = fma(-g, g, dot(whole, whole));
    const Float best = fma(g, piece.ra, dot(q, whole)) / max(A, Float(1e-37f));
    const Float w = select(A > Float(0), clamp(best, Float(0), Float(1)), select(g > Float(0), Float(1), Float(0)));
    const Vec3 from_axis = fma(whole, -w, q);
    const Float r = fma(g, w, piece.ra);
    return dot(from_axis, from_axis) < r * r * Float(1 - 0x1p-18f);
}

/// A piece of a ribbon, with the tangents of the curve at its ends.
struct RibbonPiece {
    CurvePiece piece;
    Vec3 start, end;
};

/// Lanes whose ray hits the piece as a ribbon that faces the ray, at 0 < t <= t_max. w: position along the piece, in
/// [0, 1].
///
/// In the plane perpendicular to the ray, the test is whether the ray passes between the lines through the ends that
/// are perpendicular to the tangents there (start, end), and its distance from the axis. Adjacent pieces share
/// tangents, so there are no gaps. Nakamaru, Ohno 2002, "Ray Tracing for Curves Primitive"; Pharr, Jakob, Humphreys
/// 2023, "Physically Based Rendering", 6.7.
inline Mask intersect_ribbon_piece(const RibbonPiece& ribbon, const Vec3& o, const Vec3& d, Float t_max, Float& t,
                                   Float& w)
{
    const auto& [piece, start, end] = ribbon;
    const Frame frame(d);
    const auto x = [&](const Vec3& v) { return dot(v, frame.s); };
    const auto y = [&](const Vec3& v) { return dot(v, frame.t); };
    const Vec3 qa = piece.a - o, qb = piece.b - o;
    const Float ax = x(qa), ay = y(qa), bx = x(qb), by = y(qb), ex = bx - ax, ey = by - ay;
    const Mask between = (fma(ax, x(start), ay * y(start)) <= Float(0)) & (fma(bx, x(end), by * y(end)) >= Float(0));
    const Float nearest = -fma(ax, ex, ay * ey) / fma(ex, ex, ey * ey);
    w = select(nearest > Float(0), min(nearest, Float(1)), Float(0));
    const Float cx = fma(ex, w, ax), cy = fma(ey, w, ay), r = fma(piece.rb - piece.ra, w, piece.ra);
    t = dot(d, fma(piece.b - piece.a, w, qa));
    return between & (fma(cx, cx, cy * cy) < r * r) & (t > Float(0)) & (t <= t_max);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
