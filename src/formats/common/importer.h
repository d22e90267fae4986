// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/common/load_context.h"
#include "formats/io/input_file.h"

namespace fathom {

/// A scene file to import.
struct SourceFile {
    const std::filesystem::path& path;
    std::string extension;  ///< lower case, with its dot
    InputFile& input;       ///< in lower case, with its dot
    const LoadOptions& options;

    /// The whole file, for readers that need it at once; other readers read `input` in pieces.
    const std::string& bytes() const { return input.bytes(); }
    std::string_view head() const { return input.head(); }
};

/// A reader of one scene format. Each format folder defines one, and load.cpp lists them.
struct Importer {
    /// Recognizes the format by its signature if it has one, else by the file's extension.
    bool (*recognizes)(const SourceFile& file);
    SceneDescription (*read)(const SourceFile& file, LoadContext& context);
    bool has_choices = false;  ///< a file may hold several scenes and variants, from which LoadOptions selects
    bool z_up = false;         ///< the format doesn't specify the up axis, but the programs that write it use z
    const char* name = "";     ///< name of the format for users; empty: use the extension
};

}  // namespace fathom
