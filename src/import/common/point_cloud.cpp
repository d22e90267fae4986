#include "import/common/point_cloud.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

float fitting_radius(const std::vector<Vec3f>& points)
{
    Vec3d least{points[0].x, points[0].y, points[0].z}, most = least;
    for (const Vec3f& p : points) {
        least = {std::min<double>(least.x, p.x), std::min<double>(least.y, p.y), std::min<double>(least.z, p.z)};
        most = {std::max<double>(most.x, p.x), std::max<double>(most.y, p.y), std::max<double>(most.z, p.z)};
    }
    const float radius = float(0.5 * length(most - least) / std::sqrt(double(points.size())));
    return radius > 0 ? radius : 0.01f;
}

}  // namespace

void add_point_cloud(SceneDescription& scene, std::vector<Vec3f> points, const std::string& name,
                     const std::string& file, Warnings& warnings)
{
    const std::size_t bad = std::erase_if(
        points, [](Vec3f p) { return !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)); });
    warnings.add(file + ": points that are not finite are left out", bad);
    if (points.empty()) return;
    Points cloud;
    cloud.name = name;
    cloud.radii.assign(points.size(), fitting_radius(points));
    cloud.centers = std::move(points);
    Node node;
    node.name = name;
    node.shapes.push_back({PointsInstance{int(scene.points.size())}, -1, name});
    scene.points.push_back(std::move(cloud));
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
}

}  // namespace fathom
