// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fathom/scene_file.h"
#include "formats/io/input_file.h"
#include "formats/mesh/mesh_faults.h"

namespace fathom {

/// State shared by a scene file and the files that it refers to: files read so far, access limits and diagnostics.
class LoadContext {
public:
    /// file     the scene file
    /// confine  whether all other files must lie in the scene's folder
    LoadContext(const std::filesystem::path& file, bool confine, Warnings& warnings);

    Warnings& warnings;
    /// Defects of all meshes read so far; load_scene_file turns them into warnings.
    MeshFaults mesh_faults;
    /// The scenes, variants and animations that the main file offers; filled by readers of formats with choices.
    SceneFileContents offered;
    std::string format;                             ///< format of the main file
    std::vector<std::filesystem::path> open_files;  ///< files being read, the main file first; detects include cycles

    /// Resolves a path that the scene refers to. If it doesn't exist, a path that differs only in case, or by
    /// backslashes as separators (Windows), is used if there is one; otherwise the path is returned as it is. Throws
    /// Error if the result lies outside the folder that the scene is confined to.
    std::filesystem::path locate(const std::filesystem::path& file);
    /// The contents of a file resolved by locate(). Throws Error.
    std::string read(const std::filesystem::path& file);
    /// Opens a file resolved by locate(), for readers that read in pieces. Throws Error.
    InputFile open(const std::filesystem::path& file);
    /// Records a file that another component has read.
    void add_file(const std::filesystem::path& file) { files_.push_back(file); }

    const std::vector<std::filesystem::path>& files() const { return files_; }
    /// The folder that the scene is confined to; empty if it is not confined.
    const std::filesystem::path& folder() const { return folder_; }

private:
    using Names = std::map<std::string, std::string>;  ///< directory entries by their names in lower case

    void check_inside(const std::filesystem::path& file) const;
    const Names& names_in(const std::filesystem::path& folder);

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> files_;
    std::map<std::filesystem::path, Names> names_;
};

/// Loads a scene or a model in a scene; common part of load_scene for both.
SceneDescription load_file(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context);

}  // namespace fathom
