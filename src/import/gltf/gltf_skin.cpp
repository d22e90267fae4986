#include <fmt/format.h>

#include "import/common/mesh_cleanup.h"
#include "import/gltf/gltf_reader.h"

namespace fathom {

namespace {

Transform scaled(const Transform& t, double s)
{
    Transform r = t;
    for (auto& row : r.m)
        for (double& x : row) x *= s;
    return r;
}

void add(Transform& sum, const Transform& t, double weight)
{
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j) sum.m[i][j] += weight * t.m[i][j];
}

/// Normals go with the cofactors of the map, which need no inverse: they stay right where it flattens or mirrors.
Vec3d map_normal(const Transform& t, Vec3d n)
{
    const auto column = [&](std::size_t j) { return Vec3d{t.m[0][j], t.m[1][j], t.m[2][j]}; };
    const Vec3d x = column(0), y = column(1), z = column(2);
    return cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
}

Vec3f to_float(Vec3d v)
{
    return {float(v.x), float(v.y), float(v.z)};
}

}  // namespace

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

std::vector<Transform> GltfReader::joint_transforms(const JsonValue& skin)
{
    const auto joints = skin.get("joints");
    if (!joints) skin.fail("key 'joints' is missing");
    joints->array(1);
    std::vector<float> inverse_bind;
    if (const auto index = skin.get("inverseBindMatrices")) {
        const Accessor accessor(file_, *index);
        if (accessor.components() != 16 || accessor.count() < joints->size())
            accessor.fail(fmt::format("must be a MAT4 for each of {} joints", joints->size()));
        inverse_bind.resize(16 * joints->size());
        accessor.read(0, joints->size(), 16, 0, inverse_bind.data());
    }
    std::vector<Transform> transforms;
    transforms.reserve(joints->size());
    for (std::size_t i = 0; i < joints->size(); ++i) {
        const JsonValue joint = (*joints)[i];
        file_.follow("nodes", joint);
        Transform bind;
        if (!inverse_bind.empty())
            for (std::size_t column = 0; column < 4; ++column)
                for (std::size_t row = 0; row < 3; ++row) bind.m[row][column] = inverse_bind[16 * i + 4 * column + row];
        transforms.push_back(world_from_node(joint, joint.count()) * bind);
    }
    return transforms;
}

void GltfReader::add_skinned(const JsonValue& skin_index, std::size_t node_index, const std::vector<Part>& parts)
{
    const JsonValue skin = file_.follow("skins", skin_index);
    const std::vector<Transform> joints = joint_transforms(skin);
    // The joints say where the skin is; the transform of its own node does not count.
    Node root;
    root.name = scene_.nodes[node_index].name;
    for (const Part& part : parts) {
        Shape shape = part.shape;
        if (part.joints.empty()) {
            scene_.nodes[node_index].shapes.push_back(shape);
            continue;
        }
        const Mesh& at_rest = scene_.meshes[std::size_t(std::get<MeshInstance>(shape.geometry).mesh)];
        file_.check_memory(skin, 4.0 * double(at_rest.indices.size()) + 80.0 * double(at_rest.positions.size()));
        Mesh mesh = at_rest;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            Transform blended = scaled({}, 0);
            double total = 0;
            for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
                const float weight = part.weights[k];
                if (!(weight > 0)) continue;
                if (part.joints[k] >= joints.size())
                    skin.fail(fmt::format("a vertex refers to joint {}, there are {}", part.joints[k], joints.size()));
                add(blended, joints[part.joints[k]], weight);
                total += weight;
            }
            if (!(total > 0)) {
                blended = {};
                total = 1;
            }
            blended = scaled(blended, 1 / total);
            const Vec3f p = mesh.positions[i];
            mesh.positions[i] = to_float(blended.point({p.x, p.y, p.z}));
            if (!mesh.normals.empty()) {
                const Vec3f n = mesh.normals[i];
                mesh.normals[i] = to_float(normalize(map_normal(blended, {n.x, n.y, n.z})));
            }
            if (!mesh.tangents.empty()) {
                Vec4f& t = mesh.tangents[i];
                const Vec3d mapped = normalize(blended.vector({t.x, t.y, t.z}));
                t = {float(mapped.x), float(mapped.y), float(mapped.z), t.w};
            }
        }
        clean_mesh(mesh, file_.name(), file_.warnings());
        shape.geometry = MeshInstance{int(scene_.meshes.size())};
        scene_.meshes.push_back(std::move(mesh));
        root.shapes.push_back(std::move(shape));
    }
    if (root.shapes.empty()) return;
    scene_.roots.push_back(int(scene_.nodes.size()));
    scene_.nodes.push_back(std::move(root));
}

}  // namespace fathom
