// SPDX-License-Identifier: Apache-2.0
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

/// Whether the node or one of its descendants has a camera.
bool has_camera(const SceneDescription& scene, int index)
{
    const Node& node = scene.nodes[std::size_t(index)];
    return node.camera >= 0 ||
           std::any_of(node.children.begin(), node.children.end(), [&](int child) { return has_camera(scene, child); });
}

/// world_support() for a box.
std::vector<double> reach_of(const Bounds& box, std::span<const Vec3d> directions)
{
    if (box.empty) return {};
    std::vector<double> reach;
    for (const Vec3d& d : directions)
        reach.push_back(std::max(d.x * box.min.x, d.x * box.max.x) + std::max(d.y * box.min.y, d.y * box.max.y) +
                        std::max(d.z * box.min.z, d.z * box.max.z));
    return reach;
}

/// Orientation of a camera that looks from a direction.
struct Axes {
    Vec3d right, up, back;

    Axes(double azimuth, double elevation)
        : up{-std::sin(azimuth) * std::sin(elevation), std::cos(elevation), -std::cos(azimuth) * std::sin(elevation)},
          back{std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)}
    {
        // `up` is the derivative of `back` with respect to elevation, so it is never parallel to the view direction.
        right = cross(up, back);
    }
    /// Outward normals of the right, left, top, bottom, front and back planes of a frustum with these tangents.
    std::vector<Vec3d> normals(double tan_x, double tan_y) const
    {
        return {tan_x * back + right, tan_x * back - right, tan_y * back + up, tan_y * back - up, back, back * -1};
    }
};

std::vector<double> reach_along(const SceneDescription& scene, const FramingOptions& options,
                                std::span<const Vec3d> directions)
{
    return options.bounds ? reach_of(*options.bounds, directions) : world_support(scene, directions);
}

/// Extent of the scene from `middle` along the frustum normals of all cameras on a turntable around it, so that a
/// turning model keeps its size and stays inside the image.
std::vector<double> reach_all_around(const SceneDescription& scene, const FramingOptions& options, double elevation,
                                     double tan_x, double tan_y, const Vec3d& middle)
{
    constexpr int steps = 32;  // Between two steps a point is at most 0.5 % outside, which the margin covers.
    std::vector<Vec3d> directions;
    for (int i = 0; i < steps; ++i)
        for (const Vec3d& n : Axes(i * 2 * std::numbers::pi / steps, elevation).normals(tan_x, tan_y))
            directions.push_back(n);
    const std::vector<double> all = reach_along(scene, options, directions);
    if (all.empty()) return {};
    std::vector<double> reach(6, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < all.size(); ++i)
        reach[i % 6] = std::max(reach[i % 6], all[i] - dot(directions[i], middle));
    // The axis of rotation is at the center of the image.
    reach[0] = reach[1] = std::max(reach[0], reach[1]);
    return reach;
}

/// The nearest camera that sees all of the geometry from a direction: the silhouette touches two opposite edges of the
/// image, except for a margin. In the camera's axes (right, up, back) a point p is inside the frustum's left plane
/// where -p.x + t p.z <= -c.x + t c.z, with t the tangent of half the angle and c the camera. So the extents along the
/// planes' normals determine the camera.
Camera framing_camera(const SceneDescription& scene, const FramingOptions& options)
{
    const double azimuth = options.azimuth_deg * std::numbers::pi / 180;
    const double elevation = options.elevation_deg * std::numbers::pi / 180;
    const Axes axes(azimuth, elevation);
    const Vec3d &right = axes.right, &up = axes.up, &back = axes.back;

    Camera camera;
    camera.name = "framing";
    constexpr double margin = 1.08;
    const double tan_y = std::tan(camera.fov_y / 2) / margin, tan_x = tan_y * options.aspect;
    const Vec3d middle = options.orbit_center.value_or(Vec3d{});
    std::vector<double> reach = options.orbit_center ? reach_all_around(scene, options, elevation, tan_x, tan_y, middle)
                                                     : reach_along(scene, options, axes.normals(tan_x, tan_y));
    // The camera needs a position even if the scene has no geometry.
    if (reach.empty()) reach.assign(6, 0);
    const double front = reach[4], depth = front + reach[5];
    double distance = std::max((reach[0] + reach[1]) / (2 * tan_x), (reach[2] + reach[3]) / (2 * tan_y));
    // The camera must not be inside flat geometry, such as a point or a line along the view direction.
    distance = std::max(distance, front + 0.1 * depth);
    if (!(distance > front)) distance = front + 1;
    const Vec3d aside = middle + (reach[0] - reach[1]) / 2 * right + (reach[2] - reach[3]) / 2 * up;
    camera.position = aside + distance * back;
    camera.look_at = aside + (front - depth / 2) * back;
    camera.up = up;
    return camera;
}

/// Inserts a camera before the others: the first one is rendered.
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

bool add_default_camera(SceneDescription& scene, const FramingOptions& options)
{
    check_scene(scene);
    const bool found =
        std::any_of(scene.roots.begin(), scene.roots.end(), [&](int root) { return has_camera(scene, root); });
    if (found && !options.force_camera) return false;
    add_first_camera(scene, framing_camera(scene, options));
    return true;
}

}  // namespace fathom
