// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/animation.h"
#include "fathom/load.h"

namespace fathom {

/// Everything that load_scene_file() reads from a file.
struct SceneFileContents {
    SceneDescription scene;             ///< The selected scene, at rest.
    std::string format;                 ///< Name of the file format, such as "glTF".
    std::vector<std::string> scenes;    ///< Names of the scenes in the file (glTF), or numbers if they have no names.
    std::vector<std::string> variants;  ///< Names of the material variants in the file (glTF).
    AnimationRig rig;                   ///< Animations of the scene, and the nodes and meshes that they move.
};
/// Reads a scene as load_scene() does, with its animations and the choices that the file offers. Throws Error as
/// load_scene().
FATHOM_API SceneFileContents load_scene_file(const std::filesystem::path& file, const LoadOptions& options,
                                             Warnings& warnings);

/// Returns the index of an animation in SceneFileContents::rig.
///
/// wanted  Name or number of the animation; empty selects the first one.
///
/// Throws Error, listing the animations, if there is none of that name, or none at all.
FATHOM_API std::size_t find_animation(const SceneFileContents& file, const std::string& wanted);

/// Returns a world-space box around all geometry at 25 equally spaced times of an animation. The box of the motion in
/// between can be slightly larger.
FATHOM_API Bounds world_bounds(SceneDescription scene, const AnimationPlayer& player);

}  // namespace fathom
