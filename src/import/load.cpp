#include "fathom/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <numbers>
#include <stdexcept>

#include "fathom/error.h"
#include "import/assimp/open_module.h"
#include "import/common/load_context.h"
#include "import/common/read_file.h"
#include "import/fathom/fathom_json.h"
#include "import/gltf/gltf.h"
#include "import/obj/obj.h"
#include "import/ply/ply.h"
#include "import/stl/stl.h"
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

enum class Format { fathom, gltf, obj, ply, stl, other };

/// A JSON file that is glTF has an "asset" with a version near its beginning or end; Fathom's scenes have none.
bool looks_like_gltf(std::string_view text)
{
    return text.find("\"asset\"") != std::string_view::npos && text.find("\"version\"") != std::string_view::npos &&
           text.find("\"fathom\"") == std::string_view::npos;
}

/// As JSON does whose file has no name, as /dev/stdin.
bool begins_as_object(std::string_view text)
{
    const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != std::string_view::npos && text[first] == '{';
}

/// By content where a format has a sign of its own, else by extension.
Format format_of(const std::string& extension, std::string_view bytes)
{
    if (bytes.starts_with("glTF") || extension == ".gltf" || extension == ".glb") return Format::gltf;
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || extension == ".ply") return Format::ply;
    if (extension == ".json" || (extension.empty() && begins_as_object(bytes)))
        return looks_like_gltf(bytes) ? Format::gltf : Format::fathom;
    if (extension == ".obj") return Format::obj;
    if (extension == ".stl") return Format::stl;
    return Format::other;
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
    const std::string bytes = context.read(file);
    if (bytes.empty()) throw Error(file.string(), "", "the file is empty");
    const Format format = format_of(extension, bytes);
    if (!options.scene.empty() && format != Format::gltf)
        throw Error(file.string(), "",
                    fmt::format("there is no scene '{}': only glTF files have scenes to choose from", options.scene));
    SceneDescription scene;
    switch (format) {
        case Format::gltf:
            scene = read_gltf(file, bytes, options, context);
            break;
        case Format::fathom:
            scene = read_fathom_json(file, bytes, context);
            break;
        case Format::obj:
            scene = read_obj(file, bytes, context);
            break;
        case Format::ply:
            scene = read_ply(file, bytes, context);
            break;
        case Format::stl:
            scene = read_stl(file, bytes, context);
            break;
        case Format::other:
            scene = read_with_assimp(file, options, context);
            break;
    }
    // STL does not say which axis points up; the programs that make it have z there.
    const bool is_z_up = options.up_axis ? options.up_axis == 'z' : extension == ".stl";
    if (is_z_up) turn_z_up(scene);
    return scene;
}

SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings)
{
    try {
        LoadContext context(file, options.confine, warnings);
        SceneDescription scene = load_file(file, options, context);
        for (ImageFile& image : scene.images)
            if (!image.path.empty()) image.path = context.locate(image.path);
        scene.files = context.files();
        check_scene(scene);
        return scene;
    } catch (const std::bad_alloc&) {
        throw Error(file.string(), "", "the scene does not fit into memory");
    } catch (const std::length_error&) {
        throw Error(file.string(), "", "the scene does not fit into memory");
    }
}

}  // namespace fathom
