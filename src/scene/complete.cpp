#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "fathom/load.h"
#include "scene/bounds.h"
#include "scene/check.h"

namespace fathom {

namespace {

/// Whether the node or one below it has a camera.
bool has_camera(const SceneDescription& scene, int index)
{
    const Node& node = scene.nodes[std::size_t(index)];
    return node.camera >= 0 ||
           std::any_of(node.children.begin(), node.children.end(), [&](int child) { return has_camera(scene, child); });
}

/// As world_reach, of a box.
std::vector<double> reach_of(const Bounds& box, std::span<const Vec3d> directions)
{
    if (box.empty) return {};
    std::vector<double> reach;
    for (const Vec3d& d : directions)
        reach.push_back(std::max(d.x * box.min.x, d.x * box.max.x) + std::max(d.y * box.min.y, d.y * box.max.y) +
                        std::max(d.z * box.min.z, d.z * box.max.z));
    return reach;
}

/// The nearest camera that sees all of the scene's geometry from a direction: the silhouette touches two opposite edges
/// of the picture, but for a margin. In the camera's axes (right, up, back) a point p is right of the frustum's left
/// plane where -p.x + t p.z <= -c.x + t c.z, t the tangent of half the angle and c the camera: how far the scene
/// reaches along the planes' normals decides all.
Camera framing_camera(const SceneDescription& scene, const CompleteOptions& options)
{
    const double azimuth = options.azimuth_deg * std::numbers::pi / 180;
    const double elevation = options.elevation_deg * std::numbers::pi / 180;
    const Vec3d back{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                     std::cos(azimuth) * std::cos(elevation)};
    // The derivative of back by elevation: it is never parallel to the view, also straight from above.
    const Vec3d up{-std::sin(azimuth) * std::sin(elevation), std::cos(elevation),
                   -std::cos(azimuth) * std::sin(elevation)};
    const Vec3d right = cross(up, back);

    Camera camera;
    camera.name = "framing";
    constexpr double margin = 1.08;
    const double tan_y = std::tan(camera.fov_y / 2) / margin, tan_x = tan_y * options.aspect;
    const Vec3d normals[] = {
        tan_x * back + right, tan_x * back - right, tan_y * back + up, tan_y * back - up, back, back * -1};
    std::vector<double> reach = options.bounds ? reach_of(*options.bounds, normals) : world_reach(scene, normals);
    // A scene without geometry still gets a camera.
    if (reach.empty()) reach.assign(std::size(normals), 0);
    const double front = reach[4], depth = front + reach[5];
    double distance = std::max((reach[0] + reach[1]) / (2 * tan_x), (reach[2] + reach[3]) / (2 * tan_y));
    // Nor does it stand in what is thin: one point, or a line that it looks along.
    distance = std::max(distance, front + 0.1 * depth);
    if (!(distance > front)) distance = front + 1;
    const Vec3d aside = (reach[0] - reach[1]) / 2 * right + (reach[2] - reach[3]) / 2 * up;
    camera.position = aside + distance * back;
    camera.look_at = aside + (front - depth / 2) * back;
    camera.up = up;
    return camera;
}

/// Puts a camera before the others: the first is the one that is rendered.
void add_first_camera(SceneDescription& scene, Camera camera)
{
    for (Node& node : scene.nodes)
        if (node.camera >= 0) ++node.camera;
    scene.cameras.insert(scene.cameras.begin(), std::move(camera));
    Node node;
    node.name = "framing camera";
    node.camera = 0;
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
}

}  // namespace

Completed complete_scene(SceneDescription& scene, const CompleteOptions& options)
{
    check_scene(scene);
    Completed completed;
    const bool found =
        std::any_of(scene.roots.begin(), scene.roots.end(), [&](int root) { return has_camera(scene, root); });
    if (found && !options.force_camera) return completed;
    add_first_camera(scene, framing_camera(scene, options));
    // One that was asked for is nothing that the file lacked.
    if (!options.force_camera) completed.added.push_back("a camera that frames the scene");
    return completed;
}

}  // namespace fathom
