// SPDX-License-Identifier: Apache-2.0
#include <variant>

#include "fathom/description.h"
#include "fathom/ground_truth.h"
#include "scene/motion.h"

namespace fathom {

namespace {

std::string name_of_object(const SceneDescription& scene, const Node& node, std::size_t number)
{
    if (!node.name.empty()) return node.name;
    for (const Shape& shape : node.shapes) {
        const auto* mesh = std::get_if<MeshInstance>(&shape.geometry);
        if (mesh && !scene.meshes.at(std::size_t(mesh->mesh)).name.empty())
            return scene.meshes[std::size_t(mesh->mesh)].name;
    }
    return "object " + std::to_string(number);
}

/// Splits a transform into a stretch and what follows it. A singular one is left as stretch.
void set_pose(SceneObject& object, const Transform& world_from_node)
{
    object.stretch = world_from_node;
    if (world_from_node.determinant() == 0) return;
    Pose pose = pose_of(world_from_node);
    Pose stretch;
    stretch.stretch = pose.stretch;
    pose.stretch = Pose{}.stretch;
    object.pose = pose.transform();
    object.stretch = stretch.transform();
}

void add_objects(const SceneDescription& scene, int index, const Transform& world_from_parent, double time_s,
                 int& shapes, std::vector<SceneObject>& objects)
{
    const Node& node = scene.nodes.at(std::size_t(index));
    const Transform world_from_node = world_from_parent * transform_at(node, time_s);
    if (!node.shapes.empty()) {
        SceneObject object;
        object.name = name_of_object(scene, node, objects.size() + 1);
        object.node = index;
        object.first_shape = shapes;
        set_pose(object, world_from_node);
        objects.push_back(std::move(object));
        shapes += int(node.shapes.size());
    }
    for (const int child : node.children) add_objects(scene, child, world_from_node, time_s, shapes, objects);
}

}  // namespace

std::vector<SceneObject> scene_objects(const SceneDescription& scene, double time_s)
{
    std::vector<SceneObject> objects;
    int shapes = 0;
    for (const int root : scene.roots) add_objects(scene, root, {}, time_s, shapes, objects);
    return objects;
}

}  // namespace fathom
