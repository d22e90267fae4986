// SPDX-License-Identifier: Apache-2.0
#include "formats/common/medium.h"

#include "fathom/load.h"

namespace fathom {

std::string add_surrounding_medium(SceneDescription& scene, Material medium)
{
    Bounds box = world_bounds(scene);
    for (const Camera& camera : scene.cameras) {
        const Vec3d p = camera.position;
        if (box.empty) box = {p, p, false};
        box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
        box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
    }
    const double radius = length(box.max - box.min);
    // With the lowest priority, every other medium takes precedence.
    medium.interior.priority = -1000;
    scene.materials.push_back(std::move(medium));
    Shape ball;
    ball.geometry = Sphere{(box.min + box.max) * 0.5, radius > 0 ? radius : 1, {}};
    ball.material = int(scene.materials.size()) - 1;
    Node node;
    node.shapes.push_back(std::move(ball));
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
    if (scene.environment.kind == EnvironmentKind::none) return {};
    return "it ends at a sphere of twice the scene's radius; the environment is outside";
}

}  // namespace fathom
