// SPDX-License-Identifier: Apache-2.0
#include "fathom/editable_scene.h"

#include <algorithm>
#include <utility>

#include "compile/scene_compiler.h"
#include "scene/animation.h"

namespace fathom {

struct EditableScene::Data {
    SceneDescription scene;
    SceneCompiler compiler;
    std::shared_ptr<Scene::Data> compiled;  ///< null if full compilation is needed
    SceneChanges changes;
    bool anew = true;

    Data(SceneDescription description, std::string camera, BvhQuality build)
        : scene(std::move(description)), compiler(scene, std::move(camera), build)
    {
    }
};

EditableScene::EditableScene(SceneDescription scene, std::string camera, BvhQuality build)
    : data_(std::make_unique<Data>(std::move(scene), std::move(camera), build))
{
}
EditableScene::EditableScene(EditableScene&&) noexcept = default;
EditableScene& EditableScene::operator=(EditableScene&&) noexcept = default;
EditableScene::~EditableScene() = default;

const SceneDescription& EditableScene::description() const
{
    return data_->scene;
}

const std::string& EditableScene::camera() const
{
    return data_->compiler.camera();
}

namespace {

/// Returns the element with this index; throws std::out_of_range, also for negative indices.
template <class T>
T& at(std::vector<T>& all, int index)
{
    return all.at(std::size_t(index));
}

}  // namespace

void EditableScene::set_transform(int node, const Transform& parent_from_node)
{
    at(data_->scene.nodes, node).parent_from_node = parent_from_node;
    data_->changes.parts.nodes.push_back(node);
}

void EditableScene::set_motion(int node, std::vector<NodeKey> keys)
{
    at(data_->scene.nodes, node).motion = std::move(keys);
    data_->changes.parts.nodes.push_back(node);
}

void EditableScene::set_vertices(int mesh, std::vector<Vec3f> positions, std::vector<Vec3f> normals,
                                 std::vector<Vec4f> tangents)
{
    Mesh& m = at(data_->scene.meshes, mesh);
    if (!m.movable || positions.size() != m.positions.size()) data_->compiled.reset();
    m.positions = std::move(positions);
    m.normals = std::move(normals);
    if (!tangents.empty()) m.tangents = std::move(tangents);
    data_->changes.parts.meshes.push_back(mesh);
}

void EditableScene::set_vertex_motion(int mesh, std::vector<MeshKey> keys)
{
    Mesh& m = at(data_->scene.meshes, mesh);
    if (!m.movable) data_->compiled.reset();
    m.motion = std::move(keys);
    data_->changes.parts.meshes.push_back(mesh);
}

void EditableScene::set_material(int material, const Material& material_now)
{
    at(data_->scene.materials, material) = material_now;
    data_->changes.parts.materials.push_back(material);
}

void EditableScene::set_light(int light, const Light& light_now)
{
    const Light before = std::exchange(at(data_->scene.lights, light), light_now);
    // Images of lights are decoded together with those of textures, and unused ones must not affect the fingerprint.
    // Therefore another image requires full compilation.
    const LightImage &was = before.picture, &is = light_now.picture;
    const bool other_picture = was.image != is.image || was.color_space != is.color_space;
    if (is_pictured(before) != is_pictured(light_now) || (is_pictured(light_now) && other_picture))
        data_->compiled.reset();
    data_->changes.parts.lights.push_back(light);
}

void EditableScene::set_environment(const Environment& environment)
{
    const Environment& before = data_->scene.environment;
    // Environment images are decoded together with those of textures, so another image requires full compilation.
    const auto pictured = [](const Environment& e) {
        return e.kind == EnvironmentKind::image || e.kind == EnvironmentKind::cube ||
               e.kind == EnvironmentKind::equal_area;
    };
    const bool same =
        environment.kind == before.kind && environment.image == before.image && environment.faces == before.faces;
    if ((pictured(environment) || pictured(before)) && !same) data_->compiled.reset();
    data_->scene.environment = environment;
    data_->changes.environment = true;
}

void EditableScene::set_camera(int camera, const Camera& camera_now)
{
    at(data_->scene.cameras, camera) = camera_now;
}

void EditableScene::set_shutter(double open, double close)
{
    for (Camera& camera : data_->scene.cameras) {
        camera.shutter_open = open;
        camera.shutter_close = close;
    }
}

void EditableScene::set_pose(AnimationPose pose)
{
    SceneDescription& scene = data_->scene;
    const bool reshaped =
        std::any_of(pose.contents.begin(), pose.contents.end(),
                    [&](const auto& c) { return !same_contents(at(scene.nodes, c.first), c.second); }) ||
        std::any_of(pose.meshes.begin(), pose.meshes.end(), [&](const AnimationPose::Vertices& v) {
            return !at(scene.meshes, v.mesh).movable ||
                   v.positions.size() != at(scene.meshes, v.mesh).positions.size() || !v.colors.empty() ||
                   !v.uvs[0].empty() || !v.uvs[1].empty();
        });
    if (reshaped) data_->compiled.reset();
    SceneParts& parts = data_->changes.parts;
    for (const auto& [node, transform] : pose.nodes) parts.nodes.push_back(node);
    for (const AnimationPose::Vertices& v : pose.meshes) parts.meshes.push_back(v.mesh);
    for (const AnimationPose::ParameterValue& n : pose.numbers) {
        if (is_of_material(n.value)) parts.materials.push_back(n.target);
        if (is_of_light(n.value)) parts.lights.push_back(n.target);
    }
    fathom::set_pose(scene, std::move(pose));
}

SceneDescription& EditableScene::edit_description()
{
    data_->compiled.reset();
    return data_->scene;
}

Scene EditableScene::compile_bit_exact(Warnings& warnings)
{
    if (data_->compiled && !data_->compiler.refresh_space()) data_->compiled.reset();
    return compile(warnings);
}

Scene EditableScene::compile(Warnings& warnings)
{
    // The data is moved out first: after an Error it must not be reused.
    std::shared_ptr<Scene::Data> scene = std::exchange(data_->compiled, nullptr);
    const SceneChanges changes = std::exchange(data_->changes, {});
    data_->anew = true;
    if (scene && scene.use_count() == 1) data_->anew = !data_->compiler.update(*scene, changes, warnings);
    if (data_->anew) scene = data_->compiler.compile(warnings);
    data_->compiled = scene;
    Scene result;
    result.data_ = std::move(scene);
    return result;
}

bool EditableScene::recompiled() const
{
    return data_->anew;
}

}  // namespace fathom
