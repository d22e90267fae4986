// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/point_cloud.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

float or_a_centimetre(double radius)
{
    return float(radius) > 0 ? float(radius) : 0.01f;
}

/// Diagonal of the bounding box.
double diagonal(const std::vector<Vec3f>& points)
{
    Vec3d least{points[0].x, points[0].y, points[0].z}, most = least;
    for (const Vec3f& p : points) {
        least = {std::min<double>(least.x, p.x), std::min<double>(least.y, p.y), std::min<double>(least.z, p.z)};
        most = {std::max<double>(most.x, p.x), std::max<double>(most.y, p.y), std::max<double>(most.z, p.z)};
    }
    return length(most - least);
}

bool is_finite(Vec3f p)
{
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

constexpr const char* left_out = ": points that are not finite are ignored";

}  // namespace

Points fitting_points(std::vector<Vec3f> points, const std::string& file, Warnings& warnings)
{
    warnings.add(file + left_out, std::erase_if(points, [](Vec3f p) { return !is_finite(p); }));
    Points cloud;
    if (points.empty()) return cloud;
    cloud.radii.assign(points.size(), or_a_centimetre(0.5 * diagonal(points) / std::sqrt(double(points.size()))));
    cloud.centers = std::move(points);
    return cloud;
}

Curves fitting_lines(const std::vector<Vec3f>& points, const std::vector<std::uint32_t>& counts,
                     const std::string& file, Warnings& warnings)
{
    Curves lines;
    lines.basis = CurveBasis::linear;
    std::size_t bad = 0;
    const Vec3f* p = points.data();
    for (const std::uint32_t count : counts) {
        const std::size_t before = lines.points.size();
        for (const Vec3f* end = p + count; p != end; ++p) is_finite(*p) ? lines.points.push_back(*p) : void(++bad);
        const std::size_t left = lines.points.size() - before;
        if (left > 1)
            lines.counts.push_back(std::uint32_t(left));
        else
            lines.points.resize(before);
    }
    warnings.add(file + left_out, bad);
    if (!lines.points.empty()) lines.radii.assign(lines.points.size(), or_a_centimetre(1e-3 * diagonal(lines.points)));
    return lines;
}

void add_point_cloud(SceneDescription& scene, Points cloud)
{
    if (cloud.centers.empty()) return;
    Node node;
    node.name = cloud.name;
    node.shapes.push_back({PointsInstance{int(scene.points.size())}, -1, cloud.name});
    scene.points.push_back(std::move(cloud));
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
}

}  // namespace fathom
