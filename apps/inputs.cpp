#include "inputs.h"

#include <fmt/format.h>

#include "fathom/error.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// Whether both names are of one file that is there.
bool is_same_file(const fs::path& a, const fs::path& b)
{
    std::error_code error;
    return fs::equivalent(a, b, error) && !error;
}

}  // namespace

void check_outputs_are_no_inputs(const std::vector<fs::path>& outputs, const SceneDescription& scene)
{
    const auto check = [&](const fs::path& input, const char* what) {
        for (const fs::path& output : outputs)
            if (is_same_file(output, input))
                throw Error("", "", fmt::format("{} is {}: name another with -o", output.string(), what));
    };
    check(scene.file, "the scene itself");
    for (const fs::path& file : scene.files) check(file, "a file of this scene");
    for (const ImageFile& image : scene.images)
        if (!image.path.empty()) check(image.path, "a texture of this scene");
}

}  // namespace fathom::cli
