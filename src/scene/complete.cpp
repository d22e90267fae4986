#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/load.h"
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

/// The camera that sees the whole box from a direction, its distance no larger than that needs (with a margin of 5 %).
Camera framing_camera(const Bounds& bounds, const CompleteOptions& options)
{
    const double azimuth = options.azimuth_deg * std::numbers::pi / 180;
    const double elevation = options.elevation_deg * std::numbers::pi / 180;
    const Vec3d to_camera{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                          std::cos(azimuth) * std::cos(elevation)};
    // The derivative of to_camera by elevation: it is never parallel to the view, also straight from above.
    const Vec3d up{-std::sin(azimuth) * std::sin(elevation), std::cos(elevation),
                   -std::cos(azimuth) * std::sin(elevation)};
    const Vec3d right = cross(up, to_camera);

    Camera camera;
    camera.name = "framing";
    const Vec3d center = bounds.min * 0.5 + bounds.max * 0.5;
    const Vec3d half = bounds.max * 0.5 - bounds.min * 0.5;
    const double tan_y = std::tan(camera.fov_y / 2), tan_x = tan_y * options.aspect;
    double distance = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3d p{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
        const double aside = std::max(std::abs(dot(p, right)) / tan_x, std::abs(dot(p, up)) / tan_y);
        distance = std::max(distance, dot(p, to_camera) + 1.05 * aside);
    }
    // A scene without geometry, or one point, still gets a camera.
    if (!(distance > 0)) distance = 1;
    camera.position = center + distance * to_camera;
    camera.look_at = center;
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
    add_first_camera(scene, framing_camera(options.bounds ? *options.bounds : world_bounds(scene), options));
    // One that was asked for is nothing that the file lacked.
    if (!options.force_camera) completed.added.push_back("a camera that frames the scene");
    return completed;
}

}  // namespace fathom
