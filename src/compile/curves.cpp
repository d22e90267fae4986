#include "compile/curves.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom {

namespace {

/// Place and radius, in double.
struct Point {
    Vec3d p;
    double r;

    friend Point operator+(Point a, Point b) { return {a.p + b.p, a.r + b.r}; }
    friend Point operator*(Point a, double s) { return {a.p * s, a.r * s}; }
};

using Segment = std::array<Point, 4>;

/// Control points of the Bezier segment that is segment i of a curve.
Segment bezier_segment(CurveBasis basis, const Point* p)
{
    switch (basis) {
        case CurveBasis::bspline:
            // Boehm 1981, "Generating the Bezier Points of B-Spline Curves and Surfaces".
            return {(p[0] + p[1] * 4 + p[2]) * (1.0 / 6), (p[1] * 2 + p[2]) * (1.0 / 3), (p[1] + p[2] * 2) * (1.0 / 3),
                    (p[1] + p[2] * 4 + p[3]) * (1.0 / 6)};
        case CurveBasis::catmull_rom:
            // Catmull, Rom 1974, "A Class of Local Interpolating Splines": tangents are half of the neighbours'
            // distance.
            return {p[1], p[1] + (p[2] + p[0] * -1) * (1.0 / 6), p[2] + (p[3] + p[1] * -1) * (-1.0 / 6), p[2]};
        default:
            return {p[0], p[1], p[2], p[3]};
    }
}

/// A curve strays from its chord by at most an eighth of its second derivative.
std::uint32_t pieces_of(const Segment& s)
{
    double bend = 0, radius = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const Point second = s[i] + s[i + 1] * -2 + s[i + 2];
        bend = std::max(bend, 6 * (length(second.p) + std::abs(second.r)));
    }
    for (const Point& p : s) radius = std::max(radius, p.r);
    const double allowed = radius / 50;
    std::uint32_t pieces = 1;
    while (pieces < CurveRecord::max_pieces && bend / 8 > allowed * pieces * pieces) pieces *= 2;
    return pieces;
}

}  // namespace

std::size_t add_curves(SceneTables& tables, const Curves& curves, const Transform& transform, double factor)
{
    const std::size_t before = tables.curves.size();
    const auto put = [&](const Point& p) {
        // Where a spline of radii goes below zero there is nothing.
        tables.curve_points.push_back({float(p.p.x), float(p.p.y), float(p.p.z), float(std::max(p.r, 0.0))});
    };
    std::size_t first = 0;
    for (std::uint32_t count : curves.counts) {
        std::vector<Point> points(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f p = curves.points[first + i];
            points[i] = {transform.point({p.x, p.y, p.z}), curves.radii[first + i] * factor};
        }
        first += count;
        const bool linear = curves.basis == CurveBasis::linear;
        const std::size_t step = curves.basis == CurveBasis::bezier ? 3 : 1, order = linear ? 2 : 4;
        if (count < order) continue;
        const std::size_t segments = (count - order) / step + 1;
        for (std::size_t i = 0; i < segments; ++i) {
            CurveRecord table;
            table.u0 = float(double(i) / double(segments));
            table.u1 = float(double(i + 1) / double(segments));
            if (linear) {
                if (i == 0) put(points[0]);
                table.first_point = std::uint32_t(tables.curve_points.size() - 1);
                put(points[i + 1]);
            } else {
                const Segment s = bezier_segment(curves.basis, &points[i * step]);
                // Neighbours share the point where they join.
                if (i == 0) put(s[0]);
                table.first_point = std::uint32_t(tables.curve_points.size() - 1);
                for (std::size_t k = 1; k < 4; ++k) put(s[k]);
                table.pieces = pieces_of(s);
            }
            tables.curves.push_back(table);
        }
    }
    return tables.curves.size() - before;
}

}  // namespace fathom
