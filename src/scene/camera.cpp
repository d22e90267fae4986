// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include "fathom/error.h"
#include "fathom/load.h"
#include "scene/motion.h"

namespace fathom {

namespace {

/// World transform, at shutter opening, of the first node in depth-first order that carries the camera.
std::optional<Transform> find_camera(const SceneDescription& scene, int camera_index)
{
    const double open = scene.cameras[std::size_t(camera_index)].shutter_open;
    struct Visit {
        int node;
        Transform world_from_parent;
    };
    std::vector<Visit> stack;
    for (auto root = scene.roots.rbegin(); root != scene.roots.rend(); ++root) stack.push_back({*root, {}});
    // A subtree without the camera lacks it on every path, so shared nodes are visited only once.
    std::vector<bool> seen(scene.nodes.size());
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        if (visit.node < 0 || visit.node >= int(scene.nodes.size()) || seen[visit.node]) continue;
        seen[visit.node] = true;
        const Node& node = scene.nodes[visit.node];
        const Transform world_from_node = visit.world_from_parent * transform_at(node, open);
        if (node.camera == camera_index) return world_from_node;
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
            stack.push_back({*child, world_from_node});
    }
    return {};
}

std::string names_of_cameras(const SceneDescription& scene)
{
    std::string names;
    for (const Camera& camera : scene.cameras) names += (names.empty() ? "" : ", ") + ("'" + camera.name + "'");
    return names;
}

}  // namespace

Camera world_camera(const SceneDescription& scene, const std::string& name)
{
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        if (!name.empty() && scene.cameras[i].name != name) continue;
        const std::optional<Transform> world_from_camera = find_camera(scene, int(i));
        if (!world_from_camera) continue;
        Camera camera = scene.cameras[i];
        camera.position = world_from_camera->point(camera.position);
        camera.look_at = world_from_camera->point(camera.look_at);
        camera.up = world_from_camera->vector(camera.up);
        const double scale = std::cbrt(std::abs(world_from_camera->determinant()));
        camera.height *= scale;
        camera.aperture *= scale;
        camera.focus_distance *= scale;
        return camera;
    }
    if (scene.cameras.empty()) throw Error(scene.file, "", "there is no camera in the scene");
    if (name.empty()) throw Error(scene.file, "", "no camera of the file is part of its scene");
    throw Error(scene.file, "", "there is no camera '" + name + "' in the scene; there are " + names_of_cameras(scene));
}

}  // namespace fathom
