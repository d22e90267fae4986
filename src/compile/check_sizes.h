// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "compile/compiler.h"

/// Checks that numbers, and products of a few of them, fit into float. Errors name the object: overflow would produce
/// NaN rays, which hit nothing.
namespace fathom {

/// Checks a camera in world space. Throws Error, which names the camera.
void check_camera(const SceneDescription& scene, const Camera& camera);
/// Checks a camera against the size of the scene. Throws Error, which names the camera.
void check_camera(const SceneDescription& scene, const Camera& camera, const RenderSpace& space);

/// Checks positions of shapes in render space. Throws Error, which names the node.
///
/// shapes  those to check
/// all     holds their motions
void check_flattened(const Compiler& c, const std::vector<FlattenedShape>& shapes, const FlattenedScene& all);

/// Whether a transform scales down so far that its inverse overflows.
bool is_degenerate(const Transform& render_from_node);

}  // namespace fathom
