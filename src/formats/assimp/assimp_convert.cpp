// SPDX-License-Identifier: Apache-2.0
#include "formats/assimp/assimp_convert.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "formats/mesh/polygon.h"

namespace fathom {

namespace {

Vec3f to_vec3f(const aiVector3D& v)
{
    return {v.x, v.y, v.z};
}
Vec3d to_vec3d(const aiVector3D& v)
{
    return {v.x, v.y, v.z};
}

Transform to_transform(const aiMatrix4x4& m)
{
    Transform t;
    t.m = {{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}};
    return t;
}

}  // namespace

void AssimpConverter::add_mesh(const aiMesh& from)
{
    Mesh mesh;
    mesh.name = from.mName.C_Str();
    const std::size_t vertices = from.mNumVertices;
    mesh.positions.reserve(vertices);
    for (std::size_t i = 0; i < vertices; ++i) mesh.positions.push_back(to_vec3f(from.mVertices[i]));
    if (from.HasNormals())
        for (std::size_t i = 0; i < vertices; ++i) mesh.normals.push_back(to_vec3f(from.mNormals[i]));
    for (unsigned set = 0; set < 2; ++set)
        if (from.HasTextureCoords(set))
            for (std::size_t i = 0; i < vertices; ++i)
                mesh.uvs[set].push_back({from.mTextureCoords[set][i].x, 1 - from.mTextureCoords[set][i].y});
    if (from.HasVertexColors(0))
        for (std::size_t i = 0; i < vertices; ++i) {
            const aiColor4D& c = from.mColors[0][i];
            mesh.colors.push_back({c.r, c.g, c.b, c.a});
        }
    mesh.indices.reserve(3 * std::size_t(from.mNumFaces));
    std::vector<Vec3f> points;
    std::vector<std::uint32_t> corners;
    for (unsigned i = 0; i < from.mNumFaces; ++i) {
        const aiFace& face = from.mFaces[i];
        const bool in_range = std::all_of(face.mIndices, face.mIndices + face.mNumIndices,
                                          [&](unsigned index) { return index < vertices; });
        if (face.mNumIndices < 3 || !in_range) {
            warn(in_range ? "points and lines are ignored" : "faces with vertex indices out of range are ignored");
            continue;
        }
        points.clear();
        for (unsigned k = 0; k < face.mNumIndices; ++k) points.push_back(mesh.positions[face.mIndices[k]]);
        corners.clear();
        triangulate(points, corners);
        for (std::uint32_t k : corners) mesh.indices.push_back(face.mIndices[k]);
    }
    to_.meshes.push_back(std::move(mesh));
}

void AssimpConverter::add_camera(const aiCamera& from)
{
    Camera camera;
    camera.name = from.mName.C_Str();
    camera.position = to_vec3d(from.mPosition);
    camera.look_at = camera.position + to_vec3d(from.mLookAt);
    camera.up = to_vec3d(from.mUp);
    const Vec3d view = camera.look_at - camera.position;
    if (!(length(cross(normalize(view), normalize(camera.up))) > 1e-6)) {
        warn("cameras without a view direction are ignored");
        return;
    }
    // Assimp's angle is horizontal. In some formats it spans only half of the image, which can't be detected.
    const double aspect = from.mAspect > 0 ? from.mAspect : 4.0 / 3;
    if (from.mHorizontalFOV > 0.01f && from.mHorizontalFOV < 3.1f)
        camera.fov_y = 2 * std::atan(std::tan(double(from.mHorizontalFOV) / 2) / aspect);
    cameras_[camera.name] = int(to_.cameras.size());
    to_.cameras.push_back(std::move(camera));
}

void AssimpConverter::add_light(const aiLight& from)
{
    Light light;
    light.name = from.mName.C_Str();
    switch (from.mType) {
        case aiLightSource_POINT:
            light.kind = LightKind::point;
            break;
        case aiLightSource_SPOT:
            light.kind = LightKind::spot;
            break;
        case aiLightSource_DIRECTIONAL:
            light.kind = LightKind::directional;
            break;
        case aiLightSource_AMBIENT:
            return;
        default:
            warn("lights that are neither point, spot nor directional are ignored");
            return;
    }
    const aiColor3D& c = from.mColorDiffuse;
    const auto channel = [](float x) { return std::isfinite(x) && x > 0 ? x : 0.0f; };
    light.intensity = {channel(c.r), channel(c.g), channel(c.b)};
    if (light.kind == LightKind::spot) {
        const auto half = [](float angle) { return std::clamp(double(angle) / 2, 0.0, std::numbers::pi / 2); };
        light.outer_angle = from.mAngleOuterCone > 0 ? half(from.mAngleOuterCone) : std::numbers::pi / 4;
        light.inner_angle = std::min(half(from.mAngleInnerCone), light.outer_angle);
    }
    lights_[light.name] = int(to_.lights.size());
    to_.lights.push_back(std::move(light));
}

int AssimpConverter::add_node(const aiNode& from, int depth)
{
    if (depth > 200) {
        answer_.error = "nodes are nested more than 200 deep";
        return -1;
    }
    Node node;
    node.name = from.mName.C_Str();
    node.parent_from_node = to_transform(from.mTransformation);
    for (unsigned i = 0; i < from.mNumMeshes; ++i) {
        const unsigned mesh = from.mMeshes[i];
        if (mesh >= to_.meshes.size() || to_.meshes[mesh].indices.empty()) continue;
        Shape shape{MeshInstance{int(mesh)}, int(from_.mMeshes[mesh]->mMaterialIndex), node.name};
        if (shape.material >= int(from_.mNumMaterials)) shape.material = -1;
        if (!to_.meshes[mesh].colors.empty()) {
            const auto [found, is_new] = colored_.try_emplace(shape.material, int(to_.materials.size()));
            if (is_new) {
                Material m;
                if (shape.material >= 0) m = to_.materials[std::size_t(shape.material)];
                m.use_vertex_color = true;
                to_.materials.push_back(std::move(m));
            }
            shape.material = found->second;
        }
        node.shapes.push_back(std::move(shape));
    }
    if (const auto found = cameras_.find(node.name); found != cameras_.end()) node.camera = found->second;
    if (const auto found = lights_.find(node.name); found != lights_.end()) {
        // Fathom's lights shine from their node's origin along its -z.
        for (unsigned i = 0; i < from_.mNumLights; ++i) {
            const aiLight& light = *from_.mLights[i];
            if (node.name != light.mName.C_Str()) continue;
            Vec3d z = normalize(to_vec3d(light.mDirection)) * -1;
            if (length(z) == 0) z = {0, 0, 1};
            const Vec3d other = std::abs(z.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
            const Vec3d x = normalize(cross(other, z)), y = cross(z, x), p = to_vec3d(light.mPosition);
            Node place;
            place.name = node.name;
            place.parent_from_node.m = {{{x.x, y.x, z.x, p.x}, {x.y, y.y, z.y, p.y}, {x.z, y.z, z.z, p.z}}};
            place.light = found->second;
            node.children.push_back(int(to_.nodes.size()));
            to_.nodes.push_back(std::move(place));
            break;
        }
    }
    for (unsigned i = 0; i < from.mNumChildren; ++i) {
        const int child = add_node(*from.mChildren[i], depth + 1);
        if (child < 0) return -1;
        node.children.push_back(child);
    }
    to_.nodes.push_back(std::move(node));
    return int(to_.nodes.size()) - 1;
}

void AssimpConverter::convert(const Transform& world_from_file)
{
    for (unsigned i = 0; i < from_.mNumMaterials; ++i) add_material(*from_.mMaterials[i]);
    for (unsigned i = 0; i < from_.mNumMeshes; ++i) add_mesh(*from_.mMeshes[i]);
    for (unsigned i = 0; i < from_.mNumCameras; ++i) add_camera(*from_.mCameras[i]);
    for (unsigned i = 0; i < from_.mNumLights; ++i) add_light(*from_.mLights[i]);
    Node root;
    root.name = "file";
    root.parent_from_node = world_from_file;
    const int below = add_node(*from_.mRootNode, 0);
    if (below < 0) return;
    root.children = {below};
    to_.roots = {int(to_.nodes.size())};
    to_.nodes.push_back(std::move(root));
}

}  // namespace fathom
