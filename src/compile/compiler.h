#pragma once
#include <string>
#include <vector>

#include "compile/render_space.h"
#include "fathom/load.h"
#include "fathom/render.h"
#include "integrate/tables.h"

namespace fathom {

/// A shape where a node puts it.
struct ShapeOccurrence {
    const Shape* shape;
    Transform render_from_node;  ///< when the shutter opens
    std::uint32_t object_id;
    int node;         ///< the one that has it
    int motion = -1;  ///< index into Occurrences::motions; -1: stands still
};
/// A light of a node.
struct LightOccurrence {
    const Light* light;
    Transform render_from_node;
};
struct Occurrences {
    std::vector<ShapeOccurrence> shapes;
    std::vector<LightOccurrence> lights;
    std::vector<std::vector<NodeKey>> motions;  ///< poses of render_from_node, see compile/poses.h
};

/// What all steps of compiling share.
struct Compiler {
    const SceneDescription& scene;
    RenderSpace space;
    SceneTables& tables;
    Warnings& warnings;
};

/// Walks the nodes; what a node reached twice has occurs twice.
Occurrences find_occurrences(const Compiler& c);
void compile_materials(Compiler& c);
/// Fills vertices, triangles, quads, spheres, disks, shapes and instances. Materials must be there.
void compile_geometry(Compiler& c, const Occurrences& occurrences);
/// Fills the lights: emissive primitives, lights of nodes, the environment. Geometry must be there.
void compile_lights(Compiler& c, const std::vector<LightOccurrence>& lights);

}  // namespace fathom
