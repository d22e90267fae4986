// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "fathom/animation.h"
#include "fathom/render.h"

namespace fathom {

/// A scene that changes between images. compile() compiles only what has changed: the cost of moving a node with
/// Node::movable, or the vertices of a mesh with Mesh::movable, depends on that node or mesh, not on the whole scene.
/// Movable geometry is traced through instances, which takes slightly longer.
///
///     EditableScene edit(description);
///     for (int frame = 0; frame < 100; ++frame) {
///         edit.set_transform(wheel, Transform::rotate({0, 0, 1}, 0.1 * frame));
///         RenderJob job(edit.compile(warnings), settings);
///         ...
///     }
///
/// The compiled scenes have the bits that Scene::compile() makes of description(), as long as the camera doesn't move
/// and the extent of the scene stays about the same. Coordinates are relative to the first position of the camera, so
/// other scenes may differ by rounding; compile_bit_exact() avoids that. An EditableScene belongs to one thread at a
/// time.
class FATHOM_API EditableScene {
public:
    /// Takes over a description. Nothing is compiled yet.
    ///
    /// scene   The description.
    /// camera  Name of the camera that scenes are compiled for; empty selects the first one.
    /// build   How BVHs are built.
    explicit EditableScene(SceneDescription scene, std::string camera = {}, BvhQuality build = BvhQuality::standard);
    /// Moves the scene; the source may only be assigned to or destroyed afterwards.
    EditableScene(EditableScene&&) noexcept;
    /// Moves the scene; the source may only be assigned to or destroyed afterwards.
    EditableScene& operator=(EditableScene&&) noexcept;
    ~EditableScene();

    /// Returns the description with all changes so far.
    const SceneDescription& description() const;
    /// Returns the name of the camera that scenes are compiled for, as passed to the constructor.
    const std::string& camera() const;

    // Setters take indices of the description. All of them throw std::out_of_range if an index is out of range, and
    // leave other checks to compile().

    /// Sets Node::parent_from_node. Unless the node is movable, the next compile() compiles the whole scene.
    void set_transform(int node, const Transform& parent_from_node);
    /// Sets Node::motion. Unless the node is movable, the next compile() compiles the whole scene.
    void set_motion(int node, std::vector<NodeKey> keys);
    /// Sets vertices of a mesh. Unless the mesh is movable and keeps its number of vertices, the next compile()
    /// compiles the whole scene.
    ///
    /// positions  One for each vertex, in the space of the mesh.
    /// normals    As many, or empty if the mesh has none.
    /// tangents   As many; empty keeps the current ones.
    void set_vertices(int mesh, std::vector<Vec3f> positions, std::vector<Vec3f> normals,
                      std::vector<Vec4f> tangents = {});
    /// Sets Mesh::motion. Unless the mesh is movable, the next compile() compiles the whole scene.
    void set_vertex_motion(int mesh, std::vector<MeshKey> keys);
    /// Replaces a material.
    void set_material(int material, const Material& material_now);
    /// Replaces a light. If that changes its image, the next compile() compiles the whole scene.
    void set_light(int light, const Light& light_now);
    /// Replaces the environment. If that changes its images, the next compile() compiles the whole scene.
    void set_environment(const Environment& environment);
    /// Replaces a camera.
    void set_camera(int camera, const Camera& camera_now);
    /// Sets the times in seconds at which the shutters of all cameras open and close.
    void set_shutter(double open, double close);
    /// Applies a pose of an animation.
    void set_pose(AnimationPose pose);
    /// Returns the description for any other change. The next compile() compiles the whole scene.
    SceneDescription& edit_description();

    /// Compiles the current state of the scene.
    ///
    /// warnings  Receives problems that leave a usable scene.
    ///
    /// Scenes never change: while the result of the previous call, or a job of it, still exists, the whole scene is
    /// compiled. Throws Error as Scene::compile(); the description then keeps the invalid values and can be corrected.
    Scene compile(Warnings& warnings);
    /// Compiles the current state to the exact bits of Scene::compile(). It compiles the whole scene if the camera has
    /// moved, or if the extent of the scene has changed so much that coordinates would be rounded differently.
    Scene compile_bit_exact(Warnings& warnings);
    /// Returns whether the last compilation compiled the whole scene.
    bool recompiled() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace fathom
