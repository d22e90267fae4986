#pragma once
#include <memory>
#include <string>
#include <vector>

#include "fathom/animation.h"
#include "fathom/render.h"

namespace fathom {

/// A scene of which pictures are made in a row, with changes in between. compile() does again only what changes make
/// necessary: what a node that is `movable` moves to, and what the vertices of a mesh that is `movable` become, costs
/// its share, not that of the scene. Such things are traced through instances, which takes a little longer than what
/// stands still.
///
///     SceneEdit edit(description);
///     for (int frame = 0; frame < 100; ++frame) {
///         edit.set_transform(wheel, Transform::rotate({0, 0, 1}, 0.1 * frame));
///         RenderJob job(edit.compile(warnings), settings);
///         ...
///     }
///
/// The scenes are those that Scene::compile makes of description(), bit for bit, as long as the camera that it began
/// with stays where it is: numbers are relative to its place.
class FATHOM_API SceneEdit {
public:
    /// camera: as in Scene::compile.
    explicit SceneEdit(SceneDescription scene, std::string camera = {}, TreeBuild build = TreeBuild::standard);
    SceneEdit(SceneEdit&&) noexcept;
    SceneEdit& operator=(SceneEdit&&) noexcept;
    ~SceneEdit();

    const SceneDescription& description() const;
    /// The name of the camera that scenes are compiled for, as the constructor got it.
    const std::string& camera() const;

    // Indices are those of the description. What an edit brings is checked by compile(); an index out of range is a
    // std::out_of_range at once.

    /// Also of a node that is not movable: then all is compiled anew.
    void set_transform(int node, const Transform& parent_from_node);
    /// Node::motion.
    void set_motion(int node, std::vector<NodeKey> keys);
    /// As many vertices as the mesh has, or all is compiled anew; tangents empty: as they are.
    void set_vertices(int mesh, std::vector<Vec3f> positions, std::vector<Vec3f> normals,
                      std::vector<Vec4f> tangents = {});
    /// Mesh::motion.
    void set_vertex_motion(int mesh, std::vector<MeshKey> keys);
    void set_material(int material, const Material& material_now);
    void set_light(int light, const Light& light_now);
    void set_environment(const Environment& environment);
    void set_camera(int camera, const Camera& camera_now);
    /// Of all cameras, in seconds.
    void set_shutter(double open, double close);
    /// All of a pose at once.
    void set_pose(AnimationPose pose);
    /// For any other change: the next compile() makes the whole scene anew.
    SceneDescription& change();

    /// The scene as it is now. Throws Error as Scene::compile; the description keeps what was wrong, to be set again.
    /// While somebody else still has the scene of the last call, or a job of it, all is compiled anew: that one never
    /// changes.
    Scene compile(Warnings& warnings);
    /// The same, with the bits of Scene::compile also if the camera has moved, or the scene grown or shrunk so much
    /// that its numbers would be rounded otherwise: then all is compiled anew.
    Scene compile_exactly(Warnings& warnings);
    /// Whether the last compile() made the whole scene.
    bool recompiled() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace fathom
