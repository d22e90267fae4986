// SPDX-License-Identifier: Apache-2.0
#include "scene.h"

#include <utility>

namespace fathom::python {

void PreparedScene::compile_again(Warnings& warnings)
{
    for (const auto& job : jobs)
        if (const SharedJob alive = job.lock()) alive->reset();
    jobs.clear();
    lit.scene = {};
    lit.scene = edit->compile_bit_exact(warnings);
    is_edited = false;
}

SharedJob PreparedScene::make_job(const RenderSettings& settings)
{
    std::erase_if(jobs, [](const auto& job) { return job.expired(); });
    auto job = std::make_shared<std::optional<RenderJob>>();
    if (camera)
        job->emplace(lit.scene, *camera, settings);
    else
        job->emplace(lit.scene, settings);
    jobs.push_back(job);
    return job;
}

Scene::Scene(SceneFileContents contents) : builder(std::move(contents.scene)), rest_(std::move(contents))
{
    rest_.scene = {};
}

SceneDescription& Scene::restructure()
{
    prepared_.reset();
    return builder.edit_scene();
}

std::shared_ptr<PreparedScene> Scene::prepared(const std::vector<std::string>& words) const
{
    return prepared_ && prepared_->words == words ? prepared_ : nullptr;
}

SceneFileContents Scene::contents(bool take)
{
    SceneFileContents all = rest_;
    if (take)
        all.scene = std::move(builder.edit_scene());
    else
        all.scene = builder.scene();
    return all;
}

/// Marks a node or mesh as movable when it is changed for the first time, so that later changes are cheap.
template <class Thing>
void Scene::make_movable(std::vector<Thing> SceneDescription::* things, int index)
{
    Thing& thing = (builder.edit_scene().*things).at(std::size_t(index));
    if (thing.movable) return;
    thing.movable = true;
    if (prepared_) (prepared_->edit->edit_description().*things)[std::size_t(index)].movable = true;
}

void Scene::set_transform(int node, const Transform& transform)
{
    make_movable(&SceneDescription::nodes, node);
    builder.edit_scene().nodes[std::size_t(node)].parent_from_node = transform;
    change_prepared([&](EditableScene& edit) { edit.set_transform(node, transform); });
}

void Scene::set_motion(int node, std::vector<NodeKey> keys)
{
    make_movable(&SceneDescription::nodes, node);
    builder.edit_scene().nodes[std::size_t(node)].motion = keys;
    change_prepared([&](EditableScene& edit) { edit.set_motion(node, std::move(keys)); });
}

void Scene::set_vertices(int mesh, std::vector<Vec3f> positions, std::vector<Vec3f> normals)
{
    make_movable(&SceneDescription::meshes, mesh);
    Mesh& target = builder.edit_scene().meshes[std::size_t(mesh)];
    target.positions = positions, target.normals = normals;
    change_prepared([&](EditableScene& edit) { edit.set_vertices(mesh, std::move(positions), std::move(normals)); });
}

void Scene::set_vertex_motion(int mesh, std::vector<MeshKey> keys)
{
    make_movable(&SceneDescription::meshes, mesh);
    builder.edit_scene().meshes[std::size_t(mesh)].motion = keys;
    change_prepared([&](EditableScene& edit) { edit.set_vertex_motion(mesh, std::move(keys)); });
}

void Scene::set_material(int material, const std::string& json)
{
    const std::size_t textures = description().textures.size(), materials = description().materials.size();
    builder.set_material(material, json);
    const SceneDescription& scene = description();
    if (scene.textures.size() != textures || scene.materials.size() != materials) return prepared_.reset();
    change_prepared([&](EditableScene& edit) { edit.set_material(material, scene.materials[std::size_t(material)]); });
}

void Scene::set_light(int node, const std::string& json)
{
    builder.set_light(node, json);
    make_movable(&SceneDescription::nodes, node);
    const Node& holder = description().nodes[std::size_t(node)];
    change_prepared([&](EditableScene& edit) {
        edit.set_light(holder.light, description().lights[std::size_t(holder.light)]);
        edit.set_transform(node, holder.parent_from_node);
    });
}

void Scene::set_environment(const std::string& json)
{
    builder.set_environment(json);
    prepared_.reset();
}

void Scene::set_camera(const std::string& json)
{
    Camera camera = builder.read_camera(json, "camera");
    SceneDescription& scene = builder.edit_scene();
    if (has_own_camera_) {
        const Camera before = std::exchange(scene.cameras.front(), camera);
        const bool keeps_shutter =
            before.shutter_open == camera.shutter_open && before.shutter_close == camera.shutter_close;
        const bool is_first = prepared_ && !prepared_->loaded.moved_from && prepared_->loaded.camera.empty();
        if (!is_first || !keeps_shutter) return prepared_.reset();
        // The size of the image is set here in the same way as set_up_scene() does for its option.
        if (prepared_->edit->description().cameras.front().aspect == 0) camera.aspect = 0;
        camera.shutter_open = prepared_->lit.scene.camera().shutter_open;
        camera.shutter_close = prepared_->lit.scene.camera().shutter_close;
        prepared_->camera = camera;
        return;
    }
    for (Node& node : scene.nodes)
        if (node.camera >= 0) ++node.camera;
    scene.cameras.insert(scene.cameras.begin(), camera);
    Node node;
    node.name = camera.name;
    node.camera = 0;
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
    has_own_camera_ = true;
    prepared_.reset();
}

void Scene::set_shape_material(int node, int shape, int material)
{
    restructure().nodes.at(std::size_t(node)).shapes.at(std::size_t(shape)).material = material;
}

}  // namespace fathom::python
