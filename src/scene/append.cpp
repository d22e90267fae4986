// SPDX-License-Identifier: Apache-2.0
#include "scene/append.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

void shift(int& index, int by)
{
    if (index >= 0) index += by;
}

template <class T>
void move_behind(std::vector<T>& to, std::vector<T>& from)
{
    if (to.empty()) {
        to = std::move(from);
        return;
    }
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

Appended append_scene(SceneDescription& to, SceneDescription from)
{
    const int images = int(to.images.size()), textures = int(to.textures.size());
    const int materials = int(to.materials.size()), meshes = int(to.meshes.size());
    const int curves = int(to.curves.size()), points = int(to.points.size());
    const int measured = int(to.measured.size());
    const int lights = int(to.lights.size()), cameras = int(to.cameras.size()), nodes = int(to.nodes.size());

    const auto shift_texture = [&](int& texture, const char*) { shift(texture, textures); };
    for (Texture& texture : from.textures) {
        shift(texture.image, images);
        for_each_texture(texture, texture_parameters(), shift_texture);
    }
    for (Material& material : from.materials) {
        for_each_texture(material, material_parameters(), shift_texture);
        shift(material.mixture.material_a, materials);
        shift(material.mixture.material_b, materials);
        shift(material.measured, measured);
    }
    for (Node& node : from.nodes) {
        for (int& child : node.children) shift(child, nodes);
        for (Shape& shape : node.shapes) {
            shift(shape.material, materials);
            if (auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) shift(mesh->mesh, meshes);
            if (auto* c = std::get_if<CurvesInstance>(&shape.geometry)) shift(c->curves, curves);
            if (auto* p = std::get_if<PointsInstance>(&shape.geometry)) shift(p->points, points);
        }
        shift(node.light, lights);
        shift(node.camera, cameras);
    }
    for (Light& light : from.lights) shift(light.picture.image, images);
    for (int& root : from.roots) shift(root, nodes);

    move_behind(to.images, from.images);
    move_behind(to.textures, from.textures);
    move_behind(to.materials, from.materials);
    move_behind(to.measured, from.measured);
    move_behind(to.meshes, from.meshes);
    move_behind(to.curves, from.curves);
    move_behind(to.points, from.points);
    move_behind(to.lights, from.lights);
    move_behind(to.cameras, from.cameras);
    move_behind(to.nodes, from.nodes);
    return {nodes, int(to.nodes.size()), materials, int(to.materials.size()), std::move(from.roots)};
}

Appended copy_nodes(SceneDescription& scene, const Appended& appended)
{
    Appended copy = appended;
    copy.first_node = int(scene.nodes.size());
    const int by = copy.first_node - appended.first_node;
    // The capacity at least doubles: reserving the exact size would move all nodes for each copy.
    const std::size_t all = scene.nodes.size() + std::size_t(appended.node_end - appended.first_node);
    if (all > scene.nodes.capacity()) scene.nodes.reserve(std::max(all, 2 * scene.nodes.capacity()));
    for (int i = appended.first_node; i < appended.node_end; ++i) {
        Node node = scene.nodes[std::size_t(i)];
        for (int& child : node.children) child += by;
        scene.nodes.push_back(std::move(node));
    }
    copy.node_end = int(scene.nodes.size());
    for (int& root : copy.roots) root += by;
    return copy;
}

}  // namespace fathom
