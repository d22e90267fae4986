#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// What the module libfathom_assimp.so answers. It is a library of its own, opened when a file asks for it, because
/// merely linking Assimp makes every start of the program slower. No exception crosses its border.
struct AssimpAnswer {
    SceneDescription scene;
    std::string error;  ///< empty if the scene could be read
    std::vector<std::string> warnings;
};

struct AssimpRequest {
    std::filesystem::path file;
    bool turn_up = true;           ///< whether to follow what the file says of its axes
    std::filesystem::path folder;  ///< only files in here are opened; empty: all
};

/// Files beside the one that was asked for are listed in answer.scene.files.
using AssimpRead = void (*)(const AssimpRequest& request, AssimpAnswer& answer);

constexpr const char* assimp_module_file = "libfathom_assimp.so";
constexpr const char* assimp_read_symbol = "fathom_assimp_read";
/// A string that must be the same in library and module: types cross between them.
constexpr const char* assimp_version_symbol = "fathom_assimp_version";

}  // namespace fathom
