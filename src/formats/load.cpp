// SPDX-License-Identifier: Apache-2.0
#include "fathom/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <numbers>
#include <stdexcept>

#include "fathom/error.h"
#include "formats/assimp/open_module.h"
#include "formats/common/suggest.h"
#include "formats/fathom/fathom_json.h"
#include "formats/gltf/gltf.h"
#include "formats/io/read_file.h"
#include "formats/mitsuba/mitsuba.h"
#include "formats/obj/obj.h"
#include "formats/pbrt/pbrt.h"
#include "formats/ply/ply.h"
#include "formats/stl/stl.h"
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

/// Moves the roots under a node that rotates +z to +y, the up axis of scenes.
void rotate_z_up(SceneDescription& scene)
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

/// All importers in order of precedence; the first one that recognizes a file reads it.
constexpr const Importer* importers[] = {&gltf_importer, &ply_importer, &fathom_json_importer, &mitsuba_importer,
                                         &pbrt_importer, &obj_importer, &stl_importer,         &assimp_importer};

std::string format_name(const Importer& importer, const SourceFile& file)
{
    if (*importer.name) return importer.name;
    std::string name = file.extension.empty() ? "unnamed" : file.extension.substr(1);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::toupper(c)); });
    return &importer == &assimp_importer ? name + ", by Assimp" : name;
}

/// Registers a file in LoadContext::open_files for its lifetime; throws Error if the file is open already.
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
    InputFile input = context.open(file);
    if (input.head().empty()) throw Error(file.string(), "", "the file is empty");
    const bool is_named = options.format.empty() || context.open_files.size() > 1;
    const SourceFile source{file, is_named ? lower_extension(file) : "." + options.format, input, options};
    const auto* const found = std::find_if(std::begin(importers), std::end(importers),
                                           [&](const Importer* i) { return i->recognizes(source); });
    if (found == std::end(importers)) throw Error(file.string(), "", "this file format is not supported");
    const Importer& importer = **found;
    if (!options.scene.empty() && !importer.has_choices)
        throw Error(file.string(), "",
                    fmt::format("there is no scene '{}': only glTF files have scenes to choose from", options.scene));
    if (!options.variant.empty() && !importer.has_choices)
        throw Error(file.string(), "",
                    fmt::format("there is no variant '{}': only glTF files have variants", options.variant));
    if (context.open_files.size() == 1) context.format = format_name(importer, source);
    SceneDescription scene = importer.read(source, context);
    if (options.up_axis ? options.up_axis == 'z' : importer.z_up) rotate_z_up(scene);
    return scene;
}

SceneFileContents load_scene_file(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings)
{
    try {
        LoadContext context(file, options.confine, warnings);
        SceneDescription scene = load_file(file, options, context);
        for (ImageFile& image : scene.images)
            if (!image.path.empty()) image.path = context.locate(image.path);
        scene.files = context.files();
        context.mesh_faults.report(file.string(), warnings);
        check_scene(scene);
        SceneFileContents result = std::move(context.offered);
        result.scene = std::move(scene);
        result.format = context.format;
        return result;
    } catch (const std::bad_alloc&) {
        throw Error(file.string(), "", "the scene does not fit into memory");
    } catch (const std::length_error&) {
        throw Error(file.string(), "", "the scene does not fit into memory");
    }
}

SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings)
{
    return load_scene_file(file, options, warnings).scene;
}

std::size_t find_animation(const SceneFileContents& file, const std::string& wanted)
{
    std::vector<std::string> names;
    names.reserve(file.rig.animations.size());
    for (const Animation& animation : file.rig.animations) names.push_back(animation.name);
    if (names.empty()) throw Error(file.scene.file, "", "it contains no animations");
    if (wanted.empty()) return 0;
    if (const auto found = find_choice(wanted, names)) return *found;
    throw Error(file.scene.file, "",
                fmt::format("there is no animation '{}'{}", printable(wanted), choices(wanted, names)));
}

}  // namespace fathom
