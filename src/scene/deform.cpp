// SPDX-License-Identifier: Apache-2.0
#include "scene/deform.h"

#include <algorithm>

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

/// Transforms a normal by the cofactor matrix, which needs no inverse and stays valid for singular or mirroring
/// transforms.
Vec3d map_normal(const Transform& t, Vec3d n)
{
    const auto column = [&](std::size_t j) { return Vec3d{t.m[0][j], t.m[1][j], t.m[2][j]}; };
    const Vec3d x = column(0), y = column(1), z = column(2);
    return cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
}

/// Adds weighted offsets to the first `components` components of each vector.
template <class To, class Offset>
void add_offsets(std::vector<To>& to, const std::vector<Offset>& offsets, float weight, std::size_t components)
{
    for (std::size_t i = 0; i < std::min(to.size(), offsets.size()); ++i) {
        float* p = &to[i].x;
        const float* offset = &offsets[i].x;
        for (std::size_t k = 0; k < components; ++k) p[k] += weight * offset[k];
    }
}

}  // namespace

void apply_morph_targets(Mesh& mesh, const std::vector<MorphTarget>& targets, std::span<const float> weights)
{
    for (std::size_t i = 0; i < std::min(targets.size(), weights.size()); ++i) {
        const float weight = weights[i];
        if (weight == 0) continue;
        const MorphTarget& target = targets[i];
        add_offsets(mesh.positions, target.positions, weight, 3);
        add_offsets(mesh.normals, target.normals, weight, 3);
        add_offsets(mesh.tangents, target.tangents, weight, 3);
        add_offsets(mesh.colors, target.colors, weight, 4);
        for (std::size_t set = 0; set < 2; ++set) add_offsets(mesh.uvs[set], target.uvs[set], weight, 2);
    }
}

void apply_skin(Mesh& mesh, std::span<const std::uint16_t> joints, std::span<const float> weights,
                const std::vector<Transform>& world_from_mesh)
{
    if (mesh.positions.empty()) return;
    const std::size_t each = joints.size() / mesh.positions.size();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        Transform blended = scaled({}, 0);
        double total = 0;
        for (std::size_t k = each * i; k < each * i + each; ++k) {
            if (!(weights[k] > 0)) continue;
            add(blended, world_from_mesh[joints[k]], weights[k]);
            total += weights[k];
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
}

}  // namespace fathom
