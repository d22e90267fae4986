#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/animation.h"
#include "fathom/load.h"

namespace fathom {

/// A scene, and what else its file has to choose from.
struct SceneFile {
    SceneDescription scene;           ///< at rest
    std::string format;               ///< its name, as people write it
    std::vector<std::string> scenes;  ///< names, or numbers where they have none
    std::vector<std::string> variants;
    AnimationRig rig;
};
/// As load_scene, which gives the scene alone.
FATHOM_API SceneFile load_scene_file(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings);

/// The animation of that name or number; empty: the first. Throws Error, naming those there are, if there is none.
FATHOM_API std::size_t find_animation(const SceneFile& file, const std::string& wanted);

/// Around all that an animation shows from its beginning to its end.
FATHOM_API Bounds world_bounds(SceneDescription scene, const AnimationPlayer& player);

}  // namespace fathom
