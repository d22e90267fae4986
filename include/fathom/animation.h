// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "fathom/api.h"
#include "fathom/description.h"

/// Animations of a scene as plain data, which importers fill beside its SceneDescription, and the pose of a scene at a
/// time, which EditableScene applies. Node, mesh and other indices are those of the SceneDescription.
namespace fathom {

/// How a value changes between two keys.
enum class Interpolation {
    step,    ///< The value of a key holds until the next key.
    linear,  ///< Linear; rotations turn at constant speed the shorter way (Shoemake 1985).
    cubic,   ///< Cubic Hermite spline with a tangent on each side of a key, as in glTF.
};

/// Quantity that a channel animates, with the number of floats in a value.
enum class AnimatedProperty {
    // Properties of a node.
    translation,  ///< Translation of the node in meters (3 floats).
    rotation,     ///< Rotation as a quaternion x, y, z, w, which is normalized (4 floats).
    scale,        ///< Scale factors along the axes of the node (3 floats).
    weights,      ///< Weights of the morph targets of the node's mesh (one float each).
    visible,      ///< 0 hides the node and everything below it (1 float).
    // Properties of a material. Values are clamped to their valid range.
    base_color,    ///< Linear base color and alpha (4 floats).
    metallic,      ///< Material::metallic, 0 to 1 (1 float).
    roughness,     ///< Material::roughness, 0 to 1 (1 float).
    emission,      ///< Emitted radiance in nits (3 floats).
    alpha_cutoff,  ///< Material::Opacity::cutoff (1 float).
    normal_scale,  ///< Material::NormalMap::scale (1 float).
    // Properties of a light. Values are clamped to their valid range.
    intensity,    ///< Light::intensity (3 floats).
    inner_angle,  ///< Half angle of a spot's inner cone in radians (1 float).
    outer_angle,  ///< Half angle of a spot's outer cone in radians (1 float).
    // Properties of the camera of a node.
    fov_y,   ///< Full vertical angle of view in radians, clamped to 0.001 to 3.14 (1 float).
    height,  ///< Half of Camera::height in meters, as glTF's ymag (1 float).
};

/// Keys of one animated quantity. Before the first key and after the last one, the value is constant.
struct AnimationChannel {
    AnimatedProperty value = AnimatedProperty::translation;  ///< Quantity that is animated.
    int target = -1;                                         ///< Index of the node, material or light.
    Interpolation interpolation = Interpolation::linear;     ///< How values change between keys.
    std::vector<float> times;   ///< Times of the keys in seconds: finite, ascending, not empty.
    std::vector<float> values;  ///< Finite values, key after key. A key of `cubic` has an incoming tangent, a value and
                                ///< an outgoing tangent.
};

/// A named set of channels that are played together.
struct Animation {
    std::string name;                        ///< Name of the animation; may be empty.
    std::vector<AnimationChannel> channels;  ///< Animated quantities with their keys.
    std::string problem;                     ///< Why the animation can't be played; empty if it can.

    /// Returns the time of the last key in seconds.
    FATHOM_API double duration() const;
};

/// The animatable state of a node at rest. Its transform is translation * rotation * scale.
struct NodeRestPose {
    Vec3d translation{0, 0, 0};                  ///< Translation in meters.
    std::array<double, 4> rotation{0, 0, 0, 1};  ///< Unit quaternion x, y, z, w.
    Vec3d scale{1, 1, 1};                        ///< Scale factors along the axes of the node.
    std::vector<float> weights;                  ///< Weights of the morph targets; empty: those of the mesh.
    bool visible = true;                         ///< False hides the node and everything below it.
};

/// Offsets that are added to the vertices of a mesh, times a weight. Each vector is empty or has an element for each
/// vertex.
struct MorphTarget {
    std::vector<Vec3f> positions, normals, tangents;  ///< Offsets in the space of the mesh.
    std::vector<Vec4f> colors;                        ///< Offsets of vertex colors, with alpha.
    std::vector<Vec2f> uvs[2];                        ///< Offsets of both sets of texture coordinates.
};

/// Joints that deform meshes by linear blend skinning.
struct Skin {
    std::vector<int> joints;                 ///< Node of each joint, by index.
    std::vector<Transform> joint_from_mesh;  ///< Inverse bind matrix of each joint.
};

/// A mesh that is deformed: first by its morph targets, then by its skin.
struct DeformedMesh {
    int mesh = -1;                      ///< Index of the mesh in the scene.
    Mesh rest;                          ///< The mesh at rest.
    std::vector<MorphTarget> targets;   ///< Morph targets, blended by weights.
    std::vector<float> weights;         ///< Weights of the targets, unless the node has its own.
    int node = -1;                      ///< Node whose NodeRestPose::weights apply; -1: none.
    int skin = -1;                      ///< Index into AnimationRig::skins; -1: none.
    std::vector<std::uint16_t> joints;  ///< Indices into Skin::joints, the same number for each vertex.
    std::vector<float> joint_weights;   ///< Weight of each entry of `joints`; they are normalized for each vertex.
};

/// A node whose contents are shown or hidden by animations.
struct VisibilityNode {
    int node = -1;   ///< Index of the node.
    int owner = -1;  ///< The contents are shown while this node and its ancestors are visible. It differs from `node`
                     ///< for skinned meshes, which are shown with the node that refers to them.
    Node contents;   ///< Children, shapes, light and camera that the node has while it is shown.
};

/// All animations of a scene and what they act on.
struct AnimationRig {
    std::vector<Animation> animations;   ///< Animations of the scene.
    std::vector<NodeRestPose> nodes;     ///< State at rest of the scene's first nodes, by index.
    std::vector<int> parents;            ///< Parent of each entry of `nodes`; -1: none.
    std::vector<Skin> skins;             ///< Skins that DeformedMesh::skin refers to.
    std::vector<DeformedMesh> meshes;    ///< Meshes that can be deformed.
    std::vector<VisibilityNode> hiding;  ///< Nodes that can be hidden.
};

/// The state of everything that an animation moves, at one time.
struct AnimationPose {
    /// Vertices of a deformed mesh. Vectors have an element for each vertex, or are empty as stated.
    struct Vertices {
        int mesh = -1;                          ///< Index of the mesh.
        std::vector<Vec3f> positions, normals;  ///< Positions, and normals unless the mesh has none.
        std::vector<Vec4f> tangents;            ///< Tangents; empty if the mesh has none.
        std::vector<Vec4f> colors;              ///< Vertex colors; empty: unchanged.
        std::vector<Vec2f> uvs[2];              ///< Texture coordinates; empty: unchanged.
        std::vector<MeshKey> motion;            ///< Mesh::motion from time 0 to the end of the shutter interval.
    };
    /// A value of a material, light or camera.
    struct ParameterValue {
        AnimatedProperty value = AnimatedProperty::base_color;  ///< Quantity that the value is of.
        int target = -1;                                        ///< Index of the material, light or node of the camera.
        std::array<float, 4> numbers{};                         ///< New value; unused elements are 0.
    };
    std::vector<std::pair<int, Transform>> nodes;  ///< parent_from_node by node index.
    /// Node::motion by node index, for each entry of `nodes`.
    std::vector<std::pair<int, std::vector<NodeKey>>> motions;
    std::vector<Vertices> meshes;                ///< Deformed meshes.
    std::vector<ParameterValue> numbers;         ///< Values of materials, lights and cameras.
    std::vector<std::pair<int, Node>> contents;  ///< Contents by node index; empty for hidden nodes.
};

/// Evaluates one animation of a scene.
class FATHOM_API AnimationPlayer {
public:
    /// Prepares an animation. It sets Node::movable and Mesh::movable in `scene` for everything that the animation
    /// moves.
    ///
    /// scene      The scene at rest that the rig belongs to.
    /// rig        The rig, as returned by load_scene_file().
    /// animation  Index into AnimationRig::animations.
    ///
    /// Throws Error if the animation has a `problem` or the rig doesn't fit the scene, and std::out_of_range if there
    /// is no such animation.
    AnimationPlayer(SceneDescription& scene, AnimationRig rig, std::size_t animation);

    /// Returns the animation.
    const Animation& animation() const { return rig_.animations[animation_]; }
    /// Returns the pose at a time.
    ///
    /// time_s     Time of the animation in seconds.
    /// shutter_s  Length of the shutter interval in seconds, which begins at time_s. If it is above 0, nodes
    ///            and vertices get motion of four segments over times 0 to shutter_s, for cameras whose shutter is open
    ///            from 0 to shutter_s.
    AnimationPose pose(double time_s, double shutter_s = 0) const;

private:
    AnimationPose still(double time_s) const;
    bool is_carried(int node) const;
    std::vector<Transform> skin_transforms(const Skin& skin, const std::vector<Transform>& transforms) const;
    AnimationPose::Vertices bent(const DeformedMesh& mesh, const std::vector<float>& weights,
                                 const std::vector<Transform>& transforms) const;

    AnimationRig rig_;
    std::size_t animation_;
    std::vector<Transform> parent_from_node_;  ///< Transforms at rest, by node index.
    std::vector<bool> moved_;                  ///< Whether a channel animates the transform, by node index.
    std::vector<std::size_t> bent_;            ///< Indices into rig_.meshes of those that the animation deforms.
};

/// Applies a pose to a scene description. EditableScene::set_pose() does the same for a scene that is compiled
/// repeatedly. Throws std::out_of_range if the pose belongs to another scene.
FATHOM_API void set_pose(SceneDescription& scene, AnimationPose pose);

}  // namespace fathom
