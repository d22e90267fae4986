// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/motion.h"
#include "geometry/shapes/curve_reader.h"
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A curve segment of each lane as a light. Sampling chooses one of its straight pieces uniformly, a point along the
/// piece, and a point across the width visible from the shading point. The balls at the ends of round pieces and the
/// parts of ribbons beyond a piece's ends are not sampled: BSDF sampling covers them, and pdf() is 0 there.
class CurveLight {
public:
    /// instance: places the curve by a similarity transform; no_index if there is none
    CurveLight(const GeometryTables& tables, UInt primitive, UInt instance, Float time, Mask m)
        : shape_(gather(tables.shape_of_primitive.data(), primitive, m)),
          flags_(gather(tables.shapes, &ShapeRecord::flags, shape_, m)),
          curve_(tables, select(m, primitive - UInt(tables.first_curve()), UInt(0u)), shape_, flags_, time, m),
          ribbon_((flags_ & UInt(ShapeRecord::ribbons)) != UInt(0u)),
          placed_(m & (instance != UInt(no_index)))
    {
        if (any(placed_)) to_object_ = object_from_render(tables, instance, time, placed_);
    }

    struct Sample {
        Vec3 wi;
        Float distance, inverse_pdf;
        Float u;  ///< curve parameter of the segment, as a ray hit reports it
    };
    /// Samples a point of the segment as seen from p.
    Sample sample(const Vec3& p, Sample2 random) const
    {
        const Float along = random.x * curve_.pieces(), number = min(floor(along), curve_.pieces() - Float(1));
        const Float w = along - number;
        const Piece piece = piece_at(number);
        const Vec3 eye = any(placed_) ? select(placed_, to_object_.point(p), p) : p;
        const Axis axis = axis_at(piece, w, eye);
        const Point round = round_point(piece, axis, random.y), flat = ribbon_point(piece, axis, random.y);
        const Vec3 to = select(ribbon_, flat.to, round.to);
        const Float distance2 = dot(to, to), inverse = inverse_sqrt(max(distance2, Float(1e-37f)));
        Sample s;
        s.wi = to * inverse;
        s.distance = distance2 * inverse;
        s.inverse_pdf = curve_.pieces() * select(ribbon_, flat.area, round.area) * inverse * inverse * inverse;
        s.inverse_pdf = select(ribbon_ & !shows(piece, number, eye, s.wi), Float(0), s.inverse_pdf);
        s.u = (number + w) / curve_.pieces();
        if (any(placed_)) {
            const Vec3 way = to_object_.inverse().vector(to);
            const Float length2 = dot(way, way), scale = inverse_sqrt(max(length2, Float(1e-37f)));
            s.wi = select(placed_, way * scale, s.wi);
            s.distance = select(placed_, length2 * scale, s.distance);
        }
        return s;
    }

    /// Density with respect to solid angle with which sample() returns a point of the surface: the one where the ray
    /// from o along d hits it at curve parameter u.
    Float pdf(const Vec3& o, const Vec3& d, Float distance, Float u) const
    {
        const Float number = curve_.piece_of(u);
        const Float w = fma(u, curve_.pieces(), -number);
        const Piece piece = piece_at(number);
        Vec3 eye = o, to = d * distance;
        if (any(placed_)) {
            eye = select(placed_, to_object_.point(eye), eye);
            to = select(placed_, to_object_.vector(to), to);
        }
        const Axis axis = axis_at(piece, w, eye);
        const Vec3 from_axis = to - axis.to;
        const Float area = select(ribbon_, ribbon_area(piece, axis, dot(from_axis, from_axis)),
                                  round_area(piece, axis, cosine_of(axis, piece.e, from_axis)));
        const Mask sampled = (w > Float(0)) & (w < Float(1)) & (area > Float(0));
        const Float distance2 = dot(to, to);
        return select(sampled, distance2 * sqrt(distance2) / max(curve_.pieces() * area, Float(1e-37f)), Float(0));
    }

private:
    /// A straight piece of the segment, in the space of the curve.
    struct Piece {
        Vec3 a, b, e;             ///< end points, and the unit vector from a to b
        Float ra, rb, length, g;  ///< radii at a and b, and their change per length (g) for round pieces
    };
    Piece piece_at(Float number) const
    {
        const CurvePoint<Float> a = curve_.begin(number), b = curve_.end(number);
        Piece p{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {}, a.r, b.r, {}, {}};
        const Vec3 whole = p.b - p.a;
        const Float length2 = dot(whole, whole), inverse = inverse_sqrt(max(length2, Float(1e-37f)));
        p.e = whole * inverse;
        p.length = length2 * inverse;
        p.g = (p.rb - p.ra) * inverse;
        return p;
    }

    /// A point of the piece's axis relative to the eye.
    struct Axis {
        Vec3 to;       ///< vector from the eye to the point
        Vec3 away;     ///< unit vector perpendicular to the axis, pointing away from the eye
        Float z, rho;  ///< position of the eye relative to this point: along the axis, and distance from the axis
        Float r;       ///< radius of the piece
    };
    static Axis axis_at(const Piece& piece, Float w, const Vec3& eye)
    {
        Axis x;
        x.to = fma(piece.b - piece.a, w, piece.a - eye);
        x.z = -dot(piece.e, x.to);
        const Vec3 across = fma(piece.e, x.z, x.to);
        const Float rho2 = dot(across, across), inverse = inverse_sqrt(max(rho2, Float(1e-37f)));
        x.away = across * inverse;
        x.rho = rho2 * inverse;
        x.r = fma(piece.rb - piece.ra, w, piece.ra);
        return x;
    }

    /// A surface point relative to the eye. area: inverse density of the point in the piece's parameters, times the
    /// distance cubed.
    struct Point {
        Vec3 to;
        Float area;
    };

    /// Visible part of the circle in which the ball around an axis point touches the side of a round piece: normals
    /// within an angle of the one towards the eye. With B the cosine of that angle, sin / (1 - B cos) of a normal's
    /// angle is its position in a perspective image, and is sampled uniformly.
    struct Visible {
        Float limit;    ///< B, the cosine of the largest visible angle
        Float height;   ///< height of the eye above the tangent plane of an angle, divided by (cos - B)
        Float plane;    ///< negated height of the eye above the tangent plane at 90 degrees
        Mask any, all;  ///< any: some of the circle is visible; all: the limit is clamped, which bounds the density
                        ///< where the whole circle is visible
        Float k;        ///< cosine of the angle between the normals and the circle's plane
    };
    static Visible visible(const Piece& piece, const Axis& x)
    {
        Visible v;
        const Float k2 = fma(-piece.g, piece.g, Float(1));
        v.k = sqrt(max(k2, Float(0)));
        v.height = v.k * x.rho;
        v.plane = fma(piece.g, x.z, x.r);
        const Float limit = v.plane / max(v.height, Float(1e-37f));
        v.any = (k2 > Float(0)) & (limit < Float(1)) & (x.rho > Float(0));
        v.all = limit < Float(-0.9f);
        v.limit = clamp(limit, Float(-0.9f), Float(1));
        return v;
    }
    static Point round_point(const Piece& piece, const Axis& x, Float random)
    {
        const Visible v = visible(piece, x);
        const Float b = v.limit, s2 = max(fma(-b, b, Float(1)), Float(1e-12f)), t = fma(random, Float(2), Float(-1));
        const Float seen = t * inverse_sqrt(s2), seen2 = seen * seen;
        const Float root = sqrt(max(fma(-t, t, Float(1)), Float(0)));
        const Float cosine = fma(seen2, b, root) / fma(seen2, b * b, Float(1));
        const Float sine = seen * fma(-b, cosine, Float(1));
        const Vec3 circle = fma(cross(piece.e, x.away), sine, x.away * (-cosine));
        const Vec3 n = fma(circle, v.k, piece.e * (-piece.g));
        return {fma(n, x.r, x.to), round_area(piece, x, cosine)};
    }
    /// cosine: cosine of the angle around the axis from the direction of the eye.
    static Float round_area(const Piece& piece, const Axis& x, Float cosine)
    {
        const Visible v = visible(piece, x);
        const Float b = v.limit, s2 = max(fma(-b, b, Float(1)), Float(1e-12f)), beyond = cosine - b;
        const Float height = select(v.all, fma(v.height, cosine, -v.plane) / max(beyond, Float(1e-20f)), v.height);
        const Float picture = fma(-b, cosine, Float(1));
        const Float area = piece.length * v.k * v.k * x.r * height * Float(2) * picture * picture * inverse_sqrt(s2);
        return select(v.any & (beyond > Float(0)), area, Float(0));
    }
    /// Cosine of the angle around the axis between a surface point and the eye; e: unit vector along the axis.
    static Float cosine_of(const Axis& x, const Vec3& e, const Vec3& from_axis)
    {
        const Vec3 across = fma(e, -dot(e, from_axis), from_axis);
        return -dot(across, x.away) * inverse_sqrt(max(dot(across, across), Float(1e-37f)));
    }

    /// A ribbon's point is perpendicular to the ray and to the axis: it lies on the circle whose diameter is the
    /// distance from the eye to the axis.
    static Point ribbon_point(const Piece& piece, const Axis& x, Float random)
    {
        const Float y = fma(random, Float(2), Float(-1)) * min(x.r, x.rho), share = y / max(x.rho, Float(1e-37f));
        const Float s = sqrt(max(fma(-share, share, Float(1)), Float(0)));
        const Vec3 from_axis = fma(cross(piece.e, x.away), y * s, x.away * (-y * share));
        return {x.to + from_axis, ribbon_area(piece, x, y * y)};
    }
    static Float ribbon_area(const Piece& piece, const Axis& x, Float y2)
    {
        return Float(2) * min(x.r, x.rho) * piece.length * sqrt(max(fma(x.rho, x.rho, -y2), Float(0)));
    }
    /// Whether the ribbon exists at the sample: between the end lines of the piece, by the test of
    /// intersect_ribbon_piece.
    Mask shows(const Piece& piece, Float number, const Vec3& eye, const Vec3& wi) const
    {
        const auto beyond = [&](const Vec3& end, Float which) {
            const Vec3 to = end - eye, tangent = curve_.tangent(which);
            return dot(fma(wi, -dot(wi, to), to), tangent);
        };
        return (beyond(piece.a, number) <= Float(0)) & (beyond(piece.b, number + Float(1)) >= Float(0));
    }

    UInt shape_, flags_;
    CurveReader curve_;
    Mask ribbon_, placed_;
    Affine to_object_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
