#include <algorithm>
#include <cmath>
#include <limits>
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

/// How a camera that looks from a direction is turned.
struct Axes {
    Vec3d right, up, back;

    Axes(double azimuth, double elevation)
        : up{-std::sin(azimuth) * std::sin(elevation), std::cos(elevation), -std::cos(azimuth) * std::sin(elevation)},
          back{std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)}
    {
        // Up is the derivative of back by elevation: it is never parallel to the view, also straight from above.
        right = cross(up, back);
    }
    /// Of the planes at the right, left, top, bottom, front and back of a frustum of these tangents.
    std::vector<Vec3d> normals(double tan_x, double tan_y) const
    {
        return {tan_x * back + right, tan_x * back - right, tan_y * back + up, tan_y * back - up, back, back * -1};
    }
};

std::vector<double> reach_along(const SceneDescription& scene, const CompleteOptions& options,
                                std::span<const Vec3d> directions)
{
    return options.bounds ? reach_of(*options.bounds, directions) : world_reach(scene, directions);
}

/// As far as the scene reaches from `middle` along the normals of any camera that is turned about it: what turns is
/// seen at one size, and stays in the picture.
std::vector<double> reach_all_around(const SceneDescription& scene, const CompleteOptions& options, double elevation,
                                     double tan_x, double tan_y, const Vec3d& middle)
{
    constexpr int steps = 32;  // A point between two is nearer by half a percent: the margin has it.
    std::vector<Vec3d> directions;
    for (int i = 0; i < steps; ++i)
        for (const Vec3d& n : Axes(i * 2 * std::numbers::pi / steps, elevation).normals(tan_x, tan_y))
            directions.push_back(n);
    const std::vector<double> all = reach_along(scene, options, directions);
    if (all.empty()) return {};
    std::vector<double> reach(6, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < all.size(); ++i)
        reach[i % 6] = std::max(reach[i % 6], all[i] - dot(directions[i], middle));
    // The axis stands in the middle of the picture.
    reach[0] = reach[1] = std::max(reach[0], reach[1]);
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
    const Axes axes(azimuth, elevation);
    const Vec3d &right = axes.right, &up = axes.up, &back = axes.back;

    Camera camera;
    camera.name = "framing";
    constexpr double margin = 1.08;
    const double tan_y = std::tan(camera.fov_y / 2) / margin, tan_x = tan_y * options.aspect;
    const Vec3d middle = options.turned_about.value_or(Vec3d{});
    std::vector<double> reach = options.turned_about ? reach_all_around(scene, options, elevation, tan_x, tan_y, middle)
                                                     : reach_along(scene, options, axes.normals(tan_x, tan_y));
    // A scene without geometry still gets a camera.
    if (reach.empty()) reach.assign(6, 0);
    const double front = reach[4], depth = front + reach[5];
    double distance = std::max((reach[0] + reach[1]) / (2 * tan_x), (reach[2] + reach[3]) / (2 * tan_y));
    // Nor does it stand in what is thin: one point, or a line that it looks along.
    distance = std::max(distance, front + 0.1 * depth);
    if (!(distance > front)) distance = front + 1;
    const Vec3d aside = middle + (reach[0] - reach[1]) / 2 * right + (reach[2] - reach[3]) / 2 * up;
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
