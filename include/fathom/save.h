#pragma once
#include <filesystem>

#include "fathom/api.h"
#include "fathom/description.h"
#include "fathom/load.h"

namespace fathom {

/// Writes a scene as Fathom's own JSON (docs/scene-format.md). load_scene makes of it a scene that renders to the same
/// bits.
///
/// Meshes, curves, points and embedded pictures become files of a folder beside it, which has the file's name with
/// `-files` behind; pictures that are files already are referred to. The same scene makes the same bytes. What the
/// format can't say is added to `warnings`.
///
/// Throws Error if the scene is none (an index out of range, a number that isn't finite), if something can't be
/// written, or rather than overwrite what the scene was read from: then the JSON file isn't there, or as it was.
FATHOM_API void save_scene(const SceneDescription& scene, const std::filesystem::path& file, Warnings& warnings);

/// Writes a scene as GLB: glTF 2.0 in one file, pictures included. What glTF and its ratified extensions can't say
/// (environments, curves, computed textures, some of materials) is added to `warnings`, and left out or taken by its
/// mean.
///
/// Throws Error as save_scene does, and if it would be more than GLB can hold: 4 GB, or ten million nodes.
FATHOM_API void save_glb(const SceneDescription& scene, const std::filesystem::path& file, Warnings& warnings);

}  // namespace fathom
