// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "formats/gltf/gltf_reader.h"
#include "formats/mesh/mesh_cleanup.h"
#include "scene/deform.h"

namespace fathom {

Transform GltfReader::world_from_node(const JsonValue& v, std::size_t node) const
{
    Transform t = scene_.nodes[node].parent_from_node;
    int depth = 0;
    for (int parent = parents_[node]; parent >= 0; parent = parents_[std::size_t(parent)]) {
        if (++depth > 256) v.fail("nodes are nested too deep, or contain themselves");
        t = scene_.nodes[std::size_t(parent)].parent_from_node * t;
    }
    return t;
}

Skin GltfReader::read_skin(const JsonValue& v) const
{
    const auto joints = v.get("joints");
    if (!joints) v.fail("key 'joints' is missing");
    joints->array(1);
    std::vector<float> inverse_bind;
    if (const auto index = v.get("inverseBindMatrices")) {
        const Accessor accessor(file_, *index);
        if (accessor.components() != 16 || accessor.count() < joints->size())
            accessor.fail(fmt::format("must be a MAT4 for each of {} joints", joints->size()));
        inverse_bind.resize(16 * joints->size());
        accessor.read(0, joints->size(), 16, 0, inverse_bind.data());
    }
    Skin skin;
    for (std::size_t i = 0; i < joints->size(); ++i) {
        const JsonValue joint = (*joints)[i];
        file_.follow("nodes", joint);
        Transform bind;
        if (!inverse_bind.empty())
            for (std::size_t column = 0; column < 4; ++column)
                for (std::size_t row = 0; row < 3; ++row) bind.m[row][column] = inverse_bind[16 * i + 4 * column + row];
        skin.joints.push_back(int(joint.count()));
        skin.joint_from_mesh.push_back(bind);
    }
    return skin;
}

void GltfReader::add_skinned(const JsonValue& skin_index, std::size_t node_index, const std::vector<Part>& parts)
{
    const JsonValue v = file_.follow("skins", skin_index);
    Skin skin = read_skin(v);
    std::vector<Transform> world_from_mesh;
    world_from_mesh.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i)
        world_from_mesh.push_back(world_from_node(v, std::size_t(skin.joints[i])) * skin.joint_from_mesh[i]);
    // Joints define the position of a skinned mesh; the transform of its own node is ignored, as glTF specifies.
    Node root;
    root.name = scene_.nodes[node_index].name;
    for (const Part& part : parts) {
        Shape shape = part.shape;
        if (part.joints.empty()) {
            scene_.nodes[node_index].shapes.push_back(shape);
            continue;
        }
        const Mesh& at_rest = scene_.meshes[std::size_t(std::get<MeshInstance>(shape.geometry).mesh)];
        file_.check_memory(v, 4.0 * double(at_rest.indices.size()) + 80.0 * double(at_rest.positions.size()));
        for (std::size_t k = 0; k < part.joints.size(); ++k)
            if (part.weights[k] > 0 && part.joints[k] >= world_from_mesh.size())
                v.fail(
                    fmt::format("a vertex refers to joint {}, there are {}", part.joints[k], world_from_mesh.size()));
        Mesh mesh = at_rest;
        apply_skin(mesh, part.joints, part.weights, world_from_mesh);
        clean_mesh(mesh, file_.name(), file_.mesh_faults());
        shape.geometry = MeshInstance{int(scene_.meshes.size())};
        add_deformed(part, int(scene_.meshes.size()), node_index, int(rig_.skins.size()));
        scene_.meshes.push_back(std::move(mesh));
        root.shapes.push_back(std::move(shape));
    }
    rig_.skins.push_back(std::move(skin));
    if (root.shapes.empty()) return;
    skinned_nodes_.emplace_back(int(scene_.nodes.size()), int(node_index));
    scene_.roots.push_back(int(scene_.nodes.size()));
    scene_.nodes.push_back(std::move(root));
}

}  // namespace fathom
