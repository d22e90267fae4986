#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "fathom/api.h"
#include "fathom/description.h"

/// What changes in a scene as time goes by, as plain data that a reader fills beside its SceneDescription; and the
/// scene's pose at a time, which SceneEdit takes.
namespace fathom {

enum class Interpolation {
    step,    ///< each key's value until the next
    linear,  ///< straight from key to key; rotations turn steadily, the shorter way round
    cubic,   ///< Hermite's spline through values with tangents, as in glTF
};

/// What a channel drives: a number or several of what its target is an index of.
enum class AnimatedValue {
    // of a node
    translation,
    rotation,  ///< a quaternion x, y, z, w
    scale,
    weights,  ///< of the morph targets of its mesh
    visible,  ///< 0 hides it with what is below it
    // of a material
    base_color,  ///< with alpha
    metallic,
    roughness,
    emission,
    alpha_cutoff,
    normal_scale,
    // of a light
    intensity,  ///< a colour
    inner_angle,
    outer_angle,
    // of the camera of a node
    fov_y,
    height,
};

/// Before the first key and after the last the value stands still.
struct AnimationChannel {
    AnimatedValue value = AnimatedValue::translation;
    int target = -1;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;   ///< seconds, finite, ascending; at least one
    std::vector<float> values;  ///< finite; as many for each key; cubic: tangents in, values, tangents out
};

struct Animation {
    std::string name;
    std::vector<AnimationChannel> channels;
    std::string problem;  ///< in words, if it can't be played for what is wrong with its data

    /// The time of the last key.
    FATHOM_API double duration() const;
};

/// Where a node is at rest, as far as channels move it.
struct NodeRest {
    Vec3d translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};
    Vec3d scale{1, 1, 1};
    std::vector<float> weights;  ///< empty: those of the mesh
    bool visible = true;
};

/// Offsets of vertices; each empty or as many as the mesh has of them.
struct MorphTarget {
    std::vector<Vec3f> positions, normals, tangents;
    std::vector<Vec4f> colors;
    std::vector<Vec2f> uvs[2];
};

struct Skin {
    std::vector<int> joints;                 ///< nodes
    std::vector<Transform> joint_from_mesh;  ///< where each joint has the mesh: inverse bind matrices
};

/// A mesh of the scene that bends: by weights of its targets, then by its skin.
struct DeformedMesh {
    int mesh = -1;
    Mesh rest;
    std::vector<MorphTarget> targets;
    std::vector<float> weights;  ///< of the targets, where no node has others
    int node = -1;               ///< whose weights are taken
    int skin = -1;
    std::vector<std::uint16_t> joints;  ///< of the skin, as many for each vertex; none without a skin
    std::vector<float> joint_weights;
};

/// A node that may vanish, with all that it has while it is seen.
struct VisibilityNode {
    int node = -1;
    int owner = -1;  ///< it is seen while this node and those above are: itself, or whose skin it shows
    Node contents;
};

/// What animations move.
struct AnimationRig {
    std::vector<Animation> animations;
    std::vector<NodeRest> nodes;  ///< the scene's first ones
    std::vector<int> parents;     ///< of these, -1 for none
    std::vector<Skin> skins;
    std::vector<DeformedMesh> meshes;
    std::vector<VisibilityNode> hiding;
};

/// What is elsewhere or otherwise at a time.
struct AnimationPose {
    struct Vertices {
        int mesh = -1;
        std::vector<Vec3f> positions, normals;
        std::vector<Vec4f> tangents;
        std::vector<Vec4f> colors;  ///< empty: as they are
        std::vector<Vec2f> uvs[2];
        std::vector<MeshKey> motion;  ///< while a shutter is open, from time 0 on
    };
    struct Number {
        AnimatedValue value = AnimatedValue::base_color;
        int target = -1;
        std::array<float, 4> numbers{};
    };
    std::vector<std::pair<int, Transform>> nodes;
    std::vector<std::pair<int, std::vector<NodeKey>>> motions;  ///< of the same nodes; as for meshes
    std::vector<Vertices> meshes;
    std::vector<Number> numbers;                 ///< of materials, lights and cameras
    std::vector<std::pair<int, Node>> contents;  ///< of nodes that may vanish: as they are, or empty
};

/// One animation of a scene.
class FATHOM_API AnimationPlayer {
public:
    /// Makes what moves movable (Node::movable, Mesh::movable); the scene is to be posed then. Throws Error if the
    /// animation can't be played.
    AnimationPlayer(SceneDescription& scene, AnimationRig rig, std::size_t animation);

    const Animation& animation() const { return rig_.animations[animation_]; }
    /// shutter_s  how long from then on what moves is blurred: Node::motion and Mesh::motion of the times 0 to
    /// shutter_s,
    ///            which the camera's shutter then is to have
    AnimationPose pose(double time_s, double shutter_s = 0) const;

private:
    AnimationPose still(double time_s) const;
    bool is_carried(int node) const;
    std::vector<Transform> skin_transforms(const Skin& skin, const std::vector<Transform>& transforms) const;
    AnimationPose::Vertices bent(const DeformedMesh& mesh, const std::vector<float>& weights,
                                 const std::vector<Transform>& transforms) const;

    AnimationRig rig_;
    std::size_t animation_;
    std::vector<Transform> parent_from_node_;  ///< at rest
    std::vector<bool> moved_;                  ///< nodes that channels place, by number
    std::vector<std::size_t> bent_;            ///< of rig_.meshes, those that this animation bends
};

/// Brings a scene into a pose. With SceneEdit: SceneEdit::set_pose.
FATHOM_API void set_pose(SceneDescription& scene, AnimationPose pose);

}  // namespace fathom
