// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fathom/error.h"
#include "fathom/scene_file.h"
#include "scene/animation.h"
#include "scene/deform.h"

namespace fathom {

namespace {

void place(NodeRestPose& node, AnimatedProperty value, const std::vector<double>& v)
{
    if (value == AnimatedProperty::translation) node.translation = {v[0], v[1], v[2]};
    if (value == AnimatedProperty::rotation) node.rotation = {v[0], v[1], v[2], v[3]};
    if (value == AnimatedProperty::scale) node.scale = {v[0], v[1], v[2]};
    if (value == AnimatedProperty::weights) node.weights.assign(v.begin(), v.end());
    if (value == AnimatedProperty::visible) node.visible = v[0] != 0;
}

Transform transform_of(const NodeRestPose& node)
{
    const auto& q = node.rotation;
    return Transform::translate(node.translation) * Transform::rotate_quaternion(q[0], q[1], q[2], q[3]) *
           Transform::scale(node.scale);
}

/// Depth limit of check_scene, which the scene has passed; the rig's reader checked that parents form a tree.
constexpr int deepest = 256;

/// Skinning and morphing may collapse normals and tangents to zero; such vertices keep the directions of the rest pose.
template <class Vector>
void restore_collapsed_directions(std::vector<Vector>& directions, const std::vector<Vector>& rest)
{
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const Vector& d = directions[i];
        const float square = d.x * d.x + d.y * d.y + d.z * d.z;
        if (!(square > 0 && std::isfinite(square))) directions[i] = rest[i];
    }
}

/// Whether the keys' transforms differ and are all regular with one handedness: motion can't interpolate through a
/// singular or mirrored transform.
bool can_move(const std::vector<NodeKey>& keys)
{
    const bool mirrors = keys[0].parent_from_node.determinant() < 0;
    bool moves = false;
    for (const NodeKey& key : keys) {
        const double determinant = key.parent_from_node.determinant();
        if (!std::isnormal(determinant) || (determinant < 0) != mirrors) return false;
        moves = moves || key.parent_from_node.m != keys[0].parent_from_node.m;
    }
    return moves;
}

bool moves_at_all(const std::vector<MeshKey>& keys)
{
    const auto same = [](Vec3f a, Vec3f b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
    const auto differs = [&](const MeshKey& key) {
        return !std::equal(key.positions.begin(), key.positions.end(), keys[0].positions.begin(), same);
    };
    return std::any_of(keys.begin(), keys.end(), differs);
}

/// Throws Error with a message about an animation of the scene.
[[noreturn]] void fail(const SceneDescription& scene, const Animation& animation, const std::string& message)
{
    throw Error(scene.file, fmt::format("animation '{}'", animation.name), message);
}

/// Describes what is wrong with a channel; empty if nothing is.
std::string channel_problem(const SceneDescription& scene, const AnimationRig& rig, const AnimationChannel& channel)
{
    const std::size_t targets = is_of_material(channel.value) ? scene.materials.size()
                                : is_of_light(channel.value)  ? scene.lights.size()
                                                              : rig.nodes.size();
    if (channel.target < 0 || std::size_t(channel.target) >= targets)
        return fmt::format("there is no target {}", channel.target);
    return problem_of(channel);
}

/// Describes what is wrong with a deformed mesh; empty if nothing is.
std::string mesh_problem(const SceneDescription& scene, const AnimationRig& rig, const DeformedMesh& d)
{
    const std::size_t vertices = d.rest.positions.size();
    const bool has_skin = d.skin >= 0;
    if (d.mesh < 0 || std::size_t(d.mesh) >= scene.meshes.size() || d.node >= int(rig.nodes.size()) ||
        d.skin >= int(rig.skins.size()) || (has_skin && (vertices == 0 || d.joints.size() % vertices != 0)) ||
        d.joints.size() != d.joint_weights.size())
        return "a deforming mesh has a different number of vertices, or its skin or node does not exist";
    if (!has_skin) return {};
    const Skin& skin = rig.skins[std::size_t(d.skin)];
    const auto is_node = [&](int index) { return index >= 0 && std::size_t(index) < rig.nodes.size(); };
    if (skin.joint_from_mesh.size() != skin.joints.size() ||
        !std::all_of(skin.joints.begin(), skin.joints.end(), is_node))
        return "a skin has joints that don't exist";
    for (std::size_t k = 0; k < d.joints.size(); ++k)
        if (d.joint_weights[k] > 0 && d.joints[k] >= skin.joints.size())
            return fmt::format("a vertex refers to joint {}, there are {}", d.joints[k], skin.joints.size());
    return {};
}

/// Throws Error unless all indices of the rig are in range for the scene. Posing then needs no further checks.
void check_rig(const SceneDescription& scene, const AnimationRig& rig, const Animation& animation)
{
    if (!animation.problem.empty()) fail(scene, animation, fmt::format("can't be played: {}", animation.problem));
    if (rig.nodes.size() > scene.nodes.size() || rig.parents.size() != rig.nodes.size())
        fail(scene, animation, "its nodes don't belong to the scene");
    for (std::size_t i = 0; i < animation.channels.size(); ++i)
        if (const std::string problem = channel_problem(scene, rig, animation.channels[i]); !problem.empty())
            fail(scene, animation, fmt::format("channel {}: {}", i, problem));
    for (const DeformedMesh& d : rig.meshes)
        if (const std::string problem = mesh_problem(scene, rig, d); !problem.empty()) fail(scene, animation, problem);
}

}  // namespace

std::vector<std::pair<int, Node>> visible_contents(const AnimationRig& rig, const std::vector<bool>& visible)
{
    std::vector<std::pair<int, Node>> contents;
    for (const VisibilityNode& hiding : rig.hiding) {
        bool seen = true;
        for (int node = hiding.owner; node >= 0 && seen; node = rig.parents[std::size_t(node)])
            seen = visible[std::size_t(node)];
        contents.emplace_back(hiding.node, seen ? hiding.contents : Node{});
    }
    return contents;
}

AnimationPlayer::AnimationPlayer(SceneDescription& scene, AnimationRig rig, std::size_t animation)
    : rig_(std::move(rig)), animation_(animation)
{
    check_rig(scene, rig_, rig_.animations.at(animation));
    std::vector<bool> morphed(rig_.nodes.size());
    moved_.resize(rig_.nodes.size());
    for (const AnimationChannel& channel : this->animation().channels) {
        if (is_node_transform(channel.value)) moved_[std::size_t(channel.target)] = true;
        if (channel.value == AnimatedProperty::weights) morphed[std::size_t(channel.target)] = true;
    }
    for (std::size_t i = 0; i < rig_.nodes.size(); ++i) {
        parent_from_node_.push_back(scene.nodes[i].parent_from_node);
        if (moved_[i]) scene.nodes[i].movable = true;
    }
    for (std::size_t i = 0; i < rig_.meshes.size(); ++i) {
        const DeformedMesh& d = rig_.meshes[i];
        bool bends = d.node >= 0 && morphed[std::size_t(d.node)];
        if (d.skin >= 0)
            for (const int joint : rig_.skins[std::size_t(d.skin)].joints) bends = bends || is_carried(joint);
        if (!bends) continue;
        bent_.push_back(i);
        Mesh& mesh = scene.meshes[std::size_t(d.mesh)];
        mesh = d.rest;
        mesh.movable = true;
    }
}

/// Whether the node or one of its ancestors is animated.
bool AnimationPlayer::is_carried(int node) const
{
    for (int depth = 0; node >= 0 && depth <= deepest; ++depth, node = rig_.parents[std::size_t(node)])
        if (moved_[std::size_t(node)]) return true;
    return false;
}

/// World transforms of a skin's joints, times their inverse bind matrices.
///
/// transforms  parent_from_node of each node
std::vector<Transform> AnimationPlayer::skin_transforms(const Skin& skin,
                                                        const std::vector<Transform>& transforms) const
{
    std::vector<Transform> result;
    result.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        Transform t = transforms[std::size_t(skin.joints[i])];
        int node = rig_.parents[std::size_t(skin.joints[i])];
        for (int depth = 0; node >= 0 && depth <= deepest; ++depth, node = rig_.parents[std::size_t(node)])
            t = transforms[std::size_t(node)] * t;
        result.push_back(t * skin.joint_from_mesh[i]);
    }
    return result;
}

AnimationPose::Vertices AnimationPlayer::bent(const DeformedMesh& d, const std::vector<float>& weights,
                                              const std::vector<Transform>& transforms) const
{
    Mesh mesh;
    mesh.positions = d.rest.positions;
    mesh.normals = d.rest.normals;
    mesh.tangents = d.rest.tangents;
    const auto has = [&](const auto& offsets_of) {
        return std::any_of(d.targets.begin(), d.targets.end(),
                           [&](const MorphTarget& t) { return !offsets_of(t).empty(); });
    };
    if (has([](const MorphTarget& t) -> const auto& { return t.colors; })) mesh.colors = d.rest.colors;
    for (std::size_t set = 0; set < 2; ++set)
        if (has([set](const MorphTarget& t) -> const auto& { return t.uvs[set]; })) mesh.uvs[set] = d.rest.uvs[set];
    apply_morph_targets(mesh, d.targets, weights);
    if (d.skin >= 0)
        apply_skin(mesh, d.joints, d.joint_weights, skin_transforms(rig_.skins[std::size_t(d.skin)], transforms));
    restore_collapsed_directions(mesh.normals, d.rest.normals);
    restore_collapsed_directions(mesh.tangents, d.rest.tangents);
    return {d.mesh,
            std::move(mesh.positions),
            std::move(mesh.normals),
            std::move(mesh.tangents),
            std::move(mesh.colors),
            {std::move(mesh.uvs[0]), std::move(mesh.uvs[1])},
            {}};
}

AnimationPose AnimationPlayer::still(double time_s) const
{
    AnimationPose pose;
    std::vector<NodeRestPose> nodes = rig_.nodes;
    for (const AnimationChannel& channel : animation().channels) {
        const std::vector<double> value = value_at(channel, time_s);
        if (channel.value <= AnimatedProperty::visible) {
            place(nodes[std::size_t(channel.target)], channel.value, value);
        } else {
            AnimationPose::ParameterValue& number =
                pose.numbers.emplace_back(AnimationPose::ParameterValue{channel.value, channel.target, {}});
            std::copy(value.begin(), value.end(), number.numbers.begin());
        }
    }
    std::vector<Transform> transforms = parent_from_node_;
    std::vector<bool> visible;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        visible.push_back(nodes[i].visible);
        if (!moved_[i]) continue;
        transforms[i] = transform_of(nodes[i]);
        pose.nodes.emplace_back(int(i), transforms[i]);
        pose.motions.emplace_back(int(i), std::vector<NodeKey>());
    }
    for (const std::size_t i : bent_) {
        const DeformedMesh& d = rig_.meshes[i];
        const bool has_own = d.node >= 0 && !nodes[std::size_t(d.node)].weights.empty();
        pose.meshes.push_back(bent(d, has_own ? nodes[std::size_t(d.node)].weights : d.weights, transforms));
    }
    pose.contents = visible_contents(rig_, visible);
    return pose;
}

AnimationPose AnimationPlayer::pose(double time_s, double shutter_s) const
{
    AnimationPose opening = still(time_s);
    if (!(shutter_s > 0)) return opening;
    // Between keys, node rotations are spherically interpolated but vertices move in straight lines: four segments
    // approximate an arc well enough.
    constexpr int pieces = 4;
    for (int i = 0; i <= pieces; ++i) {
        const double after_s = shutter_s * i / pieces;
        AnimationPose now = still(time_s + after_s);
        for (std::size_t k = 0; k < now.nodes.size(); ++k)
            opening.motions[k].second.push_back({after_s, now.nodes[k].second});
        for (std::size_t k = 0; k < now.meshes.size(); ++k)
            opening.meshes[k].motion.push_back(
                {after_s, std::move(now.meshes[k].positions), std::move(now.meshes[k].normals)});
    }
    for (auto& [node, keys] : opening.motions)
        if (!can_move(keys)) keys.clear();
    for (AnimationPose::Vertices& mesh : opening.meshes)
        if (!moves_at_all(mesh.motion)) mesh.motion.clear();
    return opening;
}

Bounds world_bounds(SceneDescription scene, const AnimationPlayer& player)
{
    // Number of times at which bounds are sampled; positions in between are close to a sampled one.
    constexpr int times = 25;
    Bounds all;
    for (int i = 0; i < times; ++i) {
        set_pose(scene, player.pose(player.animation().duration() * i / (times - 1)));
        const Bounds now = world_bounds(scene);
        if (now.empty) continue;
        const auto join = [&](Vec3d least, Vec3d most) {
            all.min = all.empty ? least
                                : Vec3d{std::min(all.min.x, least.x), std::min(all.min.y, least.y),
                                        std::min(all.min.z, least.z)};
            all.max = all.empty ? most
                                : Vec3d{std::max(all.max.x, most.x), std::max(all.max.y, most.y),
                                        std::max(all.max.z, most.z)};
        };
        join(now.min, now.max);
        all.empty = false;
    }
    return all;
}

}  // namespace fathom
