// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "fathom/api.h"
#include "fathom/description.h"
#include "fathom/load.h"

namespace fathom {

/// Writes a scene in Fathom's JSON format (docs/scene-format.md). Reading the file with load_scene() gives a scene that
/// renders to the same bits.
///
/// Meshes, curves, points and embedded images are written to files in a folder next to it, named after the file with
/// `-files` appended. Images that are files already are referred to. Equal scenes give equal bytes.
///
/// warnings  Receives what the format can't represent.
///
/// Throws Error if the scene is invalid (an index out of range, a number that isn't finite), if writing fails, or if
/// the output would overwrite a file that the scene was read from. The JSON file is then missing or unchanged.
FATHOM_API void save_scene(const SceneDescription& scene, const std::filesystem::path& file, Warnings& warnings);

/// Writes a scene as GLB: glTF 2.0 in a single file that contains the images.
///
/// warnings  Receives what glTF and its ratified extensions can't represent, such as environments, curves, procedural
///           textures and some material parameters. It is left out or replaced by its mean.
///
/// Throws Error as save_scene(), and if the scene exceeds the limits of GLB: 4 GB or ten million nodes.
FATHOM_API void save_glb(const SceneDescription& scene, const std::filesystem::path& file, Warnings& warnings);

}  // namespace fathom
