// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/polygon.h"

#include <array>
#include <cmath>

namespace fathom {

namespace {

struct Point {
    double x, y;
};

/// Newell's normal: a sum over edges, valid for concave and slightly nonplanar polygons.
Vec3d polygon_normal(std::span<const Vec3f> points)
{
    Vec3d n;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3f a = points[i], b = points[(i + 1) % points.size()];
        n.x += (double(a.y) - b.y) * (double(a.z) + b.z);
        n.y += (double(a.z) - b.z) * (double(a.x) + b.x);
        n.z += (double(a.x) - b.x) * (double(a.y) + b.y);
    }
    return n;
}

/// Projects along the largest component of the normal; the orientation is chosen so that the area is positive.
Point project(Vec3f p, Vec3d n)
{
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    if (x >= y && x >= z) return n.x > 0 ? Point{p.y, p.z} : Point{p.z, p.y};
    if (y >= z) return n.y > 0 ? Point{p.z, p.x} : Point{p.x, p.z};
    return n.z > 0 ? Point{p.x, p.y} : Point{p.y, p.x};
}

double turn(Point a, Point b, Point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_convex(std::span<const Point> points)
{
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i)
        if (turn(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
    return true;
}

bool is_ear(std::span<const Point> points, const std::vector<std::uint32_t>& left, std::size_t i)
{
    const std::size_t n = left.size(), before = (i + n - 1) % n, after = (i + 1) % n;
    const Point a = points[left[before]], b = points[left[i]], c = points[left[after]];
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t k = 0; k < n; ++k) {
        if (k == before || k == i || k == after) continue;
        const Point p = points[left[k]];
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
}

}  // namespace

void triangulate(std::span<const Vec3f> points, std::vector<std::uint32_t>& corners)
{
    const std::uint32_t n = std::uint32_t(points.size());
    if (n < 3) return;
    if (n == 3) {
        corners.insert(corners.end(), {0, 1, 2});
        return;
    }
    const Vec3d normal = polygon_normal(points);
    // Most polygons have four corners, and files contain millions, so small ones avoid allocation.
    std::array<Point, 8> few;
    std::vector<Point> many(n > few.size() ? n : 0);
    const std::span<Point> flat = n > few.size() ? std::span<Point>(many) : std::span<Point>(few).first(n);
    for (std::uint32_t i = 0; i < n; ++i) flat[i] = project(points[i], normal);
    // Ear clipping takes O(n^3) steps; larger polygons are treated as convex.
    if (n > 500 || is_convex(flat)) {
        for (std::uint32_t i = 1; i + 1 < n; ++i) corners.insert(corners.end(), {0, i, i + 1});
        return;
    }
    std::vector<std::uint32_t> left(n);
    for (std::uint32_t i = 0; i < n; ++i) left[i] = i;
    const auto fan = [&] {
        for (std::size_t i = 1; i + 1 < left.size(); ++i)
            corners.insert(corners.end(), {left[0], left[i], left[i + 1]});
    };
    while (left.size() > 3) {
        std::size_t ear = 0;
        while (ear < left.size() && !is_ear(flat, left, ear)) ++ear;
        // Self-intersecting polygons may have no ear.
        if (ear == left.size()) return fan();
        const std::size_t m = left.size();
        corners.insert(corners.end(), {left[(ear + m - 1) % m], left[ear], left[(ear + 1) % m]});
        left.erase(left.begin() + std::ptrdiff_t(ear));
    }
    fan();
}

}  // namespace fathom
