#pragma once
#include <map>
#include <string>
#include <vector>

#include "compile/render_space.h"
#include "fathom/load.h"
#include "fathom/render.h"
#include "geometry/displacement/displaced_shapes.h"
#include "kernel/tables.h"
#include "lights/compile/light_pictures.h"

namespace fathom {

/// A shape where a node puts it.
struct FlattenedShape {
    const Shape* shape;
    Transform render_from_node;  ///< when the shutter opens
    std::uint32_t object_id;
    int node;                ///< the one that has it
    int motion = -1;         ///< index into Occurrences::motions; -1: stands still
    bool movable = false;    ///< it, or its vertices, may change after the scene was compiled
    bool instanced = false;  ///< placed by an instance, once compile_geometry has decided
};
/// A light of a node.
struct FlattenedLight {
    const Light* light;
    Transform render_from_node;
    int motion = -1;  ///< as of a shape
};
struct FlattenedScene {
    std::vector<FlattenedShape> shapes;
    std::vector<FlattenedLight> lights;
    std::vector<std::vector<NodeKey>> motions;  ///< poses of render_from_node, see geometry/compile/poses.h
};

/// What all steps of compiling share.
struct Compiler {
    const SceneDescription& scene;
    RenderSpace space;
    SceneTables& tables;
    Warnings& warnings;
    DisplacedShapes& displaced;
    LightImages& light_images;

    /// The mesh that a shape is shown as, displaced if its material says so; null if it is of another kind.
    const Mesh* mesh_of(const Shape& shape) const
    {
        if (const DisplacedShapes::Entry* entry = displaced.find(scene, shape)) return &entry->mesh;
        const auto* mesh = std::get_if<MeshInstance>(&shape.geometry);
        return mesh ? &scene.meshes[std::size_t(mesh->mesh)] : nullptr;
    }
};

/// A warning about a file.
inline constexpr const char alpha_is_lost[] =
    "{}: alpha of curves, of points, and of spheres and disks that move is not supported; they are opaque";

/// Walks the nodes; what a node reached twice has occurs twice.
FlattenedScene flatten_scene(const Compiler& c);
/// Reads and decodes pictures, and fills textures, materials and media.
void compile_materials(Compiler& c);
/// The part of it that looks at materials only: fills them, and media, instead of those that were there.
void compile_material_records(Compiler& c);

/// What instances place: shapes in spaces of their own.
struct InstancedGeometry {
    std::map<const void*, std::uint32_t> shapes;  ///< by content_of
    std::size_t shapes_end = 0;                   ///< behind it come the shapes of instances
    bool moving = false;                          ///< something moves otherwise than by an instance's poses
    bool fixed_motion = false;                    ///< something that is not movable is elsewhere at other times
};
/// Fills vertices, triangles, quads, spheres, disks and shapes, and decides what is instanced. Materials must be there.
InstancedGeometry compile_geometry(Compiler& c, FlattenedScene& occurrences);
/// Fills instances, their shapes and poses, instead of those that were there.
void compile_instances(Compiler& c, const FlattenedScene& occurrences, const InstancedGeometry& contents);
/// Puts a mesh's vertices and normals over those of the shape that holds it in a space of its own. False, and nothing
/// is done, if there isn't room for as many.
bool replace_vertices(Compiler& c, const InstancedGeometry& contents, const Mesh& mesh);
/// Fills the environment's record, and makes the distribution of its picture. Materials must be there.
void compile_environment(Compiler& c);
/// Fills the lights: emissive primitives, lights of nodes, the environment, instead of those that were there. Geometry,
/// instances with their poses, and the environment must be there.
void compile_lights(Compiler& c, const FlattenedScene& occurrences);

}  // namespace fathom
