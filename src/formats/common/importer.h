#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/common/load_context.h"
#include "formats/io/input_file.h"

namespace fathom {

/// A file that is to be read as a scene.
struct SourceFile {
    const std::filesystem::path& path;
    std::string extension;  ///< in lower case, with its dot
    InputFile& input;       ///< not empty
    const LoadOptions& options;

    /// For readers that want all of it; the others read it by pieces.
    const std::string& bytes() const { return input.bytes(); }
    std::string_view head() const { return input.head(); }
};

/// A format of scene files. Each folder has one, which load.cpp lists.
struct Importer {
    /// By content where a format has a sign of its own, else by extension.
    bool (*recognizes)(const SourceFile& file);
    SceneDescription (*read)(const SourceFile& file, LoadContext& context);
    bool has_choices = false;  ///< a file may hold several scenes and variants, of which LoadOptions chooses one
    bool z_up = false;         ///< which axis points up is not said, and the programs that make such files have z there
    const char* name = "";     ///< of the format, as people write it; empty: its extension
};

}  // namespace fathom
