#include "fathom/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "fathom/error.h"
#include "import/fathom_json.h"
#include "import/gltf/gltf.h"
#include "import/load_context.h"
#include "import/read_file.h"
#include "scene/check.h"

namespace fathom {

namespace {

std::string lower_extension(const std::filesystem::path& file)
{
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return extension;
}

/// Puts the scene under a node that turns z upwards.
void turn_z_up(SceneDescription& scene)
{
    Node turn;
    turn.name = "z up";
    turn.parent_from_node = Transform::rotate({1, 0, 0}, -std::numbers::pi / 2);
    // Exact zeros and ones keep axis-aligned boxes axis-aligned.
    for (auto& row : turn.parent_from_node.m)
        for (double& value : row) value = std::round(value);
    turn.children = std::move(scene.roots);
    scene.environment.world_from_environment = turn.parent_from_node * scene.environment.world_from_environment;
    scene.roots = {int(scene.nodes.size())};
    scene.nodes.push_back(std::move(turn));
}

/// A GLB, whatever its name.
bool is_gltf(const std::string& bytes)
{
    return bytes.starts_with("glTF");
}

/// Keeps the list of open files right, whatever happens.
class OpenFile {
public:
    OpenFile(LoadContext& context, const std::filesystem::path& file) : context_(context)
    {
        std::error_code error;
        std::filesystem::path canonical = std::filesystem::weakly_canonical(file, error);
        if (error) canonical = file;
        const auto& open = context.open_files;
        if (std::find(open.begin(), open.end(), canonical) != open.end())
            throw Error(file.string(), "", "a scene can't contain itself: this file is being read already");
        if (open.size() > 32) throw Error(file.string(), "", "files refer to files more than 32 deep");
        context.open_files.push_back(std::move(canonical));
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    ~OpenFile() { context_.open_files.pop_back(); }

private:
    LoadContext& context_;
};

}  // namespace

SceneDescription load_file(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context)
{
    const OpenFile open(context, file);
    const std::string extension = lower_extension(file);
    const std::string bytes = read_nonempty_file(file);
    SceneDescription scene;
    if (extension == ".gltf" || extension == ".glb" || is_gltf(bytes))
        scene = read_gltf(file, bytes, options, context);
    else if (extension == ".json")
        scene = read_fathom_json(file, bytes, context);
    else
        throw Error(file.string(), "", "no reader for this format yet");
    if (options.up_axis == 'z') turn_z_up(scene);
    return scene;
}

SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings)
{
    LoadContext context{warnings, {}};
    SceneDescription scene = load_file(file, options, context);
    check_scene(scene);
    return scene;
}

}  // namespace fathom
