// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// The result of the module libfathom_assimp.so. Assimp is in a module that is loaded on demand, because linking it
/// would slow down every start of the program. No exception crosses the module's boundary.
struct AssimpAnswer {
    SceneDescription scene;
    std::string error;  ///< empty on success
    std::vector<std::string> warnings;
};

/// A request to the module: the file to read, and options.
struct AssimpRequest {
    std::filesystem::path file;
    bool turn_up = true;           ///< whether to apply the axes that the file specifies
    std::filesystem::path folder;  ///< only files in this folder may be opened; empty: no restriction
};

/// The module's entry point. Other files that it read are listed in answer.scene.files.
using AssimpRead = void (*)(const AssimpRequest& request, AssimpAnswer& answer);

constexpr const char* assimp_module_file = "libfathom_assimp.so";
constexpr const char* assimp_read_symbol = "fathom_assimp_read";
/// Version string that must match between library and module, because C++ types cross the boundary.
constexpr const char* assimp_version_symbol = "fathom_assimp_version";

}  // namespace fathom
