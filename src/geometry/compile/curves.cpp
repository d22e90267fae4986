// SPDX-License-Identifier: Apache-2.0
#include "geometry/compile/curves.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/motion.h"

namespace fathom {

namespace {

/// Position and radius of a control point, in double precision.
struct Point {
    Vec3d p;
    double r;

    friend Point operator+(Point a, Point b) { return {a.p + b.p, a.r + b.r}; }
    friend Point operator*(Point a, double s) { return {a.p * s, a.r * s}; }
};

using Segment = std::array<Point, 4>;

/// Bezier control points of segment i of a curve; p points to the first control point of the segment.
Segment bezier_segment(CurveBasis basis, const Point* p)
{
    switch (basis) {
        case CurveBasis::bspline:
            // The conversion is that of Boehm 1981, "Generating the Bezier Points of B-Spline Curves and Surfaces".
            return {(p[0] + p[1] * 4 + p[2]) * (1.0 / 6), (p[1] * 2 + p[2]) * (1.0 / 3), (p[1] + p[2] * 2) * (1.0 / 3),
                    (p[1] + p[2] * 4 + p[3]) * (1.0 / 6)};
        case CurveBasis::catmull_rom:
            // Catmull, Rom 1974, "A Class of Local Interpolating Splines": a tangent is half of the difference of the
            // neighbors.
            return {p[1], p[1] + (p[2] + p[0] * -1) * (1.0 / 6), p[2] + (p[3] + p[1] * -1) * (-1.0 / 6), p[2]};
        default:
            return {p[0], p[1], p[2], p[3]};
    }
}

/// Number of straight pieces for a segment. A curve deviates from its chord by at most an eighth of its second
/// derivative.
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

/// Adds curves pose by pose. The first pose creates the segments; the others add points in the same order.
class CurveAdder {
public:
    CurveAdder(SceneTables& tables, const Curves& curves)
        : tables_(tables), curves_(curves), first_segment_(tables.curves.size())
    {
    }

    /// points: the control points of all curves in a row.
    void add_pose(const std::vector<Point>& points)
    {
        const bool is_first = tables_.curves.size() == first_segment_;
        std::size_t first = 0, segment = first_segment_;
        const bool linear = curves_.basis == CurveBasis::linear;
        const std::size_t step = curves_.basis == CurveBasis::bezier ? 3 : 1, order = linear ? 2 : 4;
        for (std::uint32_t count : curves_.counts) {
            const Point* const p = &points[first];
            first += count;
            if (count < order) continue;
            const std::size_t segments = (count - order) / step + 1;
            for (std::size_t i = 0; i < segments; ++i, ++segment) {
                if (is_first) add_segment(i, segments);
                if (linear)
                    put_line(p + i, i == 0);
                else
                    put_cubic(bezier_segment(curves_.basis, p + i * step), i == 0, tables_.curves[segment]);
            }
        }
    }

private:
    /// Adds the record of segment i; adjacent segments share a control point.
    void add_segment(std::size_t i, std::size_t segments)
    {
        CurveRecord record;
        record.u0 = float(double(i) / double(segments));
        record.u1 = float(double(i + 1) / double(segments));
        record.first_point = std::uint32_t(tables_.curve_points.size() - (i == 0 ? 0 : 1));
        tables_.curves.push_back(record);
    }
    void put_line(const Point* p, bool begins)
    {
        if (begins) put(p[0]);
        put(p[1]);
    }
    void put_cubic(const Segment& s, bool begins, CurveRecord& record)
    {
        if (begins) put(s[0]);
        for (std::size_t k = 1; k < 4; ++k) put(s[k]);
        record.pieces = std::max(record.pieces, pieces_of(s));
    }
    void put(const Point& p)
    {
        // A spline of radii may fall below zero; the curve is invisible there.
        tables_.curve_points.push_back({float(p.p.x), float(p.p.y), float(p.p.z), float(std::max(p.r, 0.0))});
    }

    SceneTables& tables_;
    const Curves& curves_;
    const std::size_t first_segment_;
};

}  // namespace

std::size_t add_curves(SceneTables& tables, const Curves& curves, const Transform& transform, double factor, bool moves)
{
    const std::size_t before = tables.curves.size();
    CurveAdder adder(tables, curves);
    const auto add = [&](const std::vector<Vec3f>& places, const std::vector<float>& radii) {
        std::vector<Point> points(places.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i] = {transform.point({places[i].x, places[i].y, places[i].z}), radii[i] * factor};
        adder.add_pose(points);
    };
    const auto add_at = [&](float time) {
        const CurvesKey key = points_at(curves, time);
        add(key.points, key.radii);
    };
    if (curves.motion.empty())
        add(curves.points, curves.radii);
    else if (!moves)
        add_at(tables.shutter_open);
    else
        for (float time : tables.vertex_times) add_at(time);
    return tables.curves.size() - before;
}

}  // namespace fathom
