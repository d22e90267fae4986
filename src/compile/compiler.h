// SPDX-License-Identifier: Apache-2.0
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
#include "lights/compile/textured_emission.h"

namespace fathom {

/// A shape with its world transform: one occurrence in the flattened node hierarchy.
struct FlattenedShape {
    const Shape* shape;
    Transform render_from_node;  ///< transform when the shutter opens
    std::uint32_t object_id;
    int node;                ///< index of the node that has the shape
    int motion = -1;         ///< index into FlattenedScene::motions; -1: static
    bool movable = false;    ///< its transform or vertices may be edited after compilation
    bool instanced = false;  ///< placed by an instance; set by compile_geometry
};
/// A light with its world transform: one occurrence in the flattened node hierarchy.
struct FlattenedLight {
    const Light* light;
    Transform render_from_node;
    int motion = -1;  ///< like FlattenedShape::motion
};
/// All shapes and lights of a scene with their world transforms: the flattened node hierarchy.
struct FlattenedScene {
    std::vector<FlattenedShape> shapes;
    std::vector<FlattenedLight> lights;
    std::vector<std::vector<NodeKey>> motions;  ///< poses of render_from_node, see geometry/compile/poses.h
};

/// State shared by all compilation steps.
struct Compiler {
    const SceneDescription& scene;
    RenderSpace space;
    SceneTables& tables;
    Warnings& warnings;
    DisplacedShapes& displaced;
    LightImages& light_images;
    TexturedEmissions& textured_emissions;

    /// The mesh of a shape, displaced if its material says so; nullptr for other kinds of shapes.
    const Mesh* mesh_of(const Shape& shape) const
    {
        if (const DisplacedShapes::Entry* entry = displaced.find(scene, shape)) return &entry->mesh;
        const auto* mesh = std::get_if<MeshInstance>(&shape.geometry);
        return mesh ? &scene.meshes[std::size_t(mesh->mesh)] : nullptr;
    }
};

/// Format of a warning that names the file.
inline constexpr const char alpha_unsupported[] =
    "{}: alpha of curves, of points, and of moving spheres and disks is not supported; they are opaque";

/// Flattens the node hierarchy; a node that is reached twice occurs twice.
FlattenedScene flatten_scene(const Compiler& c);
/// Reads and decodes images; fills textures, materials and media.
void compile_materials(Compiler& c);
/// Recompiles materials and media only.
void compile_material_records(Compiler& c);

/// Geometry in object space, which instances place.
struct InstancedGeometry {
    std::map<const void*, std::uint32_t> shapes;  ///< by shared_geometry() of the shape
    std::size_t shapes_end = 0;                   ///< number of shapes that are not part of instances, which come first
    bool moving = false;                          ///< something moves in a way other than by poses of instances
    bool fixed_motion = false;                    ///< something that is not movable moves during the shutter interval
};
/// Fills vertices, triangles, quads, spheres, disks and shapes, and decides what is instanced. Requires materials.
InstancedGeometry compile_geometry(Compiler& c, FlattenedScene& occurrences);
/// Replaces instances, their shapes and poses.
void compile_instances(Compiler& c, const FlattenedScene& occurrences, const InstancedGeometry& contents);
/// Replaces the vertices and normals of a mesh in object space. Returns false without changes if the number of vertices
/// doesn't fit.
bool replace_vertices(Compiler& c, const InstancedGeometry& contents, const Mesh& mesh);
/// Fills the environment's record and its sampling distribution. Requires materials.
void compile_environment(Compiler& c);
/// Replaces the lights: emissive primitives, lights of nodes, and the environment. Requires geometry, instances with
/// their poses, and the environment.
void compile_lights(Compiler& c, const FlattenedScene& occurrences);

}  // namespace fathom
