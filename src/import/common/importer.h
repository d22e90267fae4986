#pragma once
#include <filesystem>
#include <string>

#include "import/common/load_context.h"

namespace fathom {

/// A file that is to be read as a scene.
struct SourceFile {
    const std::filesystem::path& path;
    std::string extension;     ///< in lower case, with its dot
    const std::string& bytes;  ///< not empty
    const LoadOptions& options;
};

/// A format of scene files. Each folder has one, which load.cpp lists.
struct Importer {
    /// By content where a format has a sign of its own, else by extension.
    bool (*recognizes)(const SourceFile& file);
    SceneDescription (*read)(const SourceFile& file, LoadContext& context);
    bool has_choices = false;  ///< a file may hold several scenes and variants, of which LoadOptions chooses one
    bool z_up = false;         ///< which axis points up is not said, and the programs that make such files have z there
};

}  // namespace fathom
