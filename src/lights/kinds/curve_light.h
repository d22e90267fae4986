#pragma once
#include "geometry/motion.h"
#include "geometry/shapes/curve_reader.h"
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A segment of a curve of each lane as a light: one of its straight pieces, each as likely as another, a place along
/// it, and one across what a point sees of it. The balls that round pieces end in are not sampled, nor what a ribbon
/// shows beyond the ends of a piece: paths find these by chance, and pdf() is 0 there.
class CurveLight {
public:
    /// instance: that places it, where it is similar to itself, or no_index.
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
        Float u;  ///< along the segment, as traversal finds it
    };
    /// As seen from p.
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

    /// Density per solid angle with which sample() gives a point of the surface: where the ray from o along d has met
    /// it at u.
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
    /// All in the space of the curve.
    struct Piece {
        Vec3 a, b, e;             ///< ends; unit from a to b
        Float ra, rb, length, g;  ///< radii; how fast the radius grows, for the round ones
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

    /// A point of the axis as it is seen.
    struct Axis {
        Vec3 to;       ///< from the eye
        Vec3 away;     ///< unit, perpendicular to the axis, away from the eye
        Float z, rho;  ///< how far the eye is from there along the axis, and from the axis
        Float r;       ///< radius
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

    /// A point from the eye; area: its inverse density by the piece's parameters, times its distance cubed.
    struct Point {
        Vec3 to;
        Float area;
    };

    /// What is seen of the circle in which a ball touches the side of the piece: normals up to an angle from the one
    /// that points to the eye. With B its cosine, sin / (1 - B cos) of a normal's angle is what a perspective picture
    /// shows, and is sampled uniformly.
    struct Visible {
        Float limit;    ///< B
        Float height;   ///< that of the eye over the tangent plane of an angle, over (cos - B)
        Float plane;    ///< the same for an angle of 90 degrees, times -1
        Mask any, all;  ///< all: more than is sampled, so that the density has an end
        Float k;        ///< cosine of the angle between normals and the circle's plane
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
    /// cosine: of the angle around the axis from where the eye is.
    static Float round_area(const Piece& piece, const Axis& x, Float cosine)
    {
        const Visible v = visible(piece, x);
        const Float b = v.limit, s2 = max(fma(-b, b, Float(1)), Float(1e-12f)), beyond = cosine - b;
        const Float height = select(v.all, fma(v.height, cosine, -v.plane) / max(beyond, Float(1e-20f)), v.height);
        const Float picture = fma(-b, cosine, Float(1));
        const Float area = piece.length * v.k * v.k * x.r * height * Float(2) * picture * picture * inverse_sqrt(s2);
        return select(v.any & (beyond > Float(0)), area, Float(0));
    }
    /// Of a point of the surface; e: along the axis.
    static Float cosine_of(const Axis& x, const Vec3& e, const Vec3& from_axis)
    {
        const Vec3 across = fma(e, -dot(e, from_axis), from_axis);
        return -dot(across, x.away) * inverse_sqrt(max(dot(across, across), Float(1e-37f)));
    }

    /// A ribbon's point is perpendicular to the ray and to the axis: it lies on the circle over the eye's distance.
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
    /// Whether a ribbon is there at all: as intersect_ribbon_piece decides, between the lines across both ends.
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
