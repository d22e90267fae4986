#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fathom/scene_file.h"
#include "formats/io/input_file.h"
#include "formats/mesh/mesh_faults.h"

namespace fathom {

/// What is the same for a scene file and the files that it refers to: what was read, and what may be.
class LoadContext {
public:
    /// file  the scene itself
    LoadContext(const std::filesystem::path& file, bool confine, Warnings& warnings);

    Warnings& warnings;
    /// Faults of all meshes read so far; load_scene_file turns them into warnings.
    MeshFaults mesh_faults;
    /// What the scene's own file has beside the scene; the reader of a file with choices fills it.
    SceneFile offered;
    std::string format;                             ///< of the scene's own file
    std::vector<std::filesystem::path> open_files;  ///< being read now, the first asked for them all: finds cycles

    /// Where a file is that the scene refers to: the path itself if there is something, else what differs from it only
    /// in upper and lower case or has folders where the path has backslashes, as on Windows; else the path. Throws
    /// Error if that is outside the folder that the scene is confined to.
    std::filesystem::path locate(const std::filesystem::path& file);
    /// The bytes of such a file. Throws Error.
    std::string read(const std::filesystem::path& file);
    /// The same, for readers that read it by pieces.
    InputFile open(const std::filesystem::path& file);
    /// Notes a file that something else has read.
    void add_file(const std::filesystem::path& file) { files_.push_back(file); }

    const std::vector<std::filesystem::path>& files() const { return files_; }
    /// Empty where the scene is not confined.
    const std::filesystem::path& folder() const { return folder_; }

private:
    using Names = std::map<std::string, std::string>;  ///< what a folder holds, by its name in lower case

    void check_inside(const std::filesystem::path& file) const;
    const Names& names_in(const std::filesystem::path& folder);

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> files_;
    std::map<std::filesystem::path, Names> names_;
};

/// load_scene for the scene itself and for the models in it.
SceneDescription load_file(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context);

}  // namespace fathom
