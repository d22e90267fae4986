// SPDX-License-Identifier: Apache-2.0
#include "render/overwrite_guard.h"

#include <fmt/format.h>

#include "fathom/error.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// Whether both names refer to one existing file.
bool is_same_file(const fs::path& a, const fs::path& b)
{
    std::error_code error;
    return fs::equivalent(a, b, error) && !error;
}

}  // namespace

void check_outputs_are_not(const std::vector<fs::path>& outputs, const fs::path& input, const char* what)
{
    for (const fs::path& output : outputs)
        if (is_same_file(output, input))
            throw Error("", "", fmt::format("{} is {}: choose another file with -o", output.string(), what));
}

void check_outputs_are_no_inputs(const std::vector<fs::path>& outputs, const SceneDescription& scene)
{
    check_outputs_are_not(outputs, scene.file, "the scene itself");
    for (const fs::path& file : scene.files) check_outputs_are_not(outputs, file, "a file of this scene");
    for (const ImageFile& image : scene.images)
        if (!image.path.empty()) check_outputs_are_not(outputs, image.path, "a texture of this scene");
}

}  // namespace fathom::cli
