#pragma once
#include "compile/compiler.h"

/// Numbers so large that floats, or products of a few of them, can't hold them: refused here, by name, since rays that
/// are no numbers find their way through nothing.
namespace fathom {

/// Throws Error that names the camera, before anything is made of it.
void check_camera(const SceneDescription& scene, const Camera& camera);
/// The same for what is large beside the scene alone.
void check_camera(const SceneDescription& scene, const Camera& camera, const RenderSpace& space);

/// Throws Error that names the node.
///
/// shapes  those to be checked; all: where their motions are
void check_flattened(const Compiler& c, const std::vector<FlattenedShape>& shapes, const FlattenedScene& all);

/// Whether a transform makes so little of what it places that the way back to it is lost.
bool vanishes(const Transform& render_from_node);

}  // namespace fathom
