// SPDX-License-Identifier: Apache-2.0
#include "fathom/scene_builder.h"

#include <fmt/format.h>

#include <utility>

#include "formats/fathom/fathom_json_reader.h"
#include "formats/fathom/parameters_json.h"
#include "formats/fathom/scene_json.h"
#include "formats/json/json.h"
#include "scene/material_table.h"

namespace fathom {

namespace {

std::string index_name(int index)
{
    return fmt::format("#{}", index);
}

/// Name of an object in messages.
std::string title(const char* what, const std::string& name)
{
    return name.empty() ? what : fmt::format("{} '{}'", what, name);
}

template <class T>
std::vector<std::string> index_names(const std::vector<T>& things)
{
    std::vector<std::string> names;
    for (std::size_t i = 0; i < things.size(); ++i) names.push_back(index_name(int(i)));
    return names;
}

/// The scene without geometry, which is quick to write as JSON.
SceneDescription without_shapes(const SceneDescription& scene)
{
    SceneDescription outline;
    outline.images = scene.images, outline.lights = scene.lights, outline.cameras = scene.cameras;
    outline.environment = scene.environment;
    // Writing leaves out lights and cameras that no node refers to.
    for (std::size_t i = 0; i < scene.lights.size() + scene.cameras.size(); ++i) {
        Node node;
        (i < scene.lights.size() ? node.light : node.camera) =
            int(i < scene.lights.size() ? i : i - scene.lights.size());
        outline.roots.push_back(int(i));
        outline.nodes.push_back(node);
    }
    return outline;
}

/// Names of image files come from their index, so that JSON can refer to them again.
void refer_by_index(Json& object, const char* key, int image)
{
    if (image >= 0 && object.contains(key)) object[key] = index_name(image);
}

/// The entry of that index in a table of a scene file.
Json entry(const Json& scene, const char* table, int index)
{
    return std::next(scene.at(table).items().begin(), index).value();
}

}  // namespace

struct SceneBuilder::Data {
    Data(SceneDescription&& description, const std::filesystem::path& folder)
        : root_json(Json::object()),
          root(name, root_json),
          context(folder / "scene", false, warnings),
          reader(folder / "scene", root, context)
    {
        reader.scene_ = std::move(description);
        reader.shared_textures_.emplace();
        name_new_objects();
    }

    /// Makes all objects known by their index.
    void name_new_objects()
    {
        const SceneDescription& scene = reader.scene_;
        const auto add = [](auto& names, int& first, std::size_t count, const auto& key) {
            for (; first < int(count); ++first) names[key(index_name(first))] = first;
        };
        const auto plain = [](std::string text) { return text; };
        const auto color = [](std::string text) { return std::pair(std::move(text), FathomJsonReader::Use::color); };
        add(reader.images_, images, scene.images.size(), plain);
        add(reader.textures_, textures, scene.textures.size(), color);
        add(reader.materials_, materials, scene.materials.size(), plain);
        add(reader.meshes_, meshes, scene.meshes.size(), plain);
    }

    /// Parses the JSON of one object and passes it to read(value).
    template <class Read>
    auto parse(const std::string& what, const std::string& text, const Read& read)
    {
        name_new_objects();
        const Json json = parse_json(what, text, DuplicateKeys::error);
        return read(JsonValue(what, json));
    }

    Json outline_json() const
    {
        const SceneDescription outline = without_shapes(reader.scene_);
        SaveFiles files(outline, "scene.json");
        Warnings ignored;
        return scene_json(outline, name, files, ignored);
    }

    std::string name = "scene";
    Warnings warnings;
    Json root_json;
    JsonValue root;
    LoadContext context;
    FathomJsonReader reader;
    int images = 0, textures = 0, materials = 0, meshes = 0;  ///< number of objects that are known by index
};

SceneBuilder::SceneBuilder(SceneDescription scene, const std::filesystem::path& folder)
    : data_(std::make_unique<Data>(std::move(scene), folder))
{
}
SceneBuilder::SceneBuilder(SceneBuilder&&) noexcept = default;
SceneBuilder& SceneBuilder::operator=(SceneBuilder&&) noexcept = default;
SceneBuilder::~SceneBuilder() = default;

const SceneDescription& SceneBuilder::scene() const
{
    return data_->reader.scene_;
}
SceneDescription& SceneBuilder::edit_scene()
{
    return data_->reader.scene_;
}
Warnings SceneBuilder::take_warnings()
{
    return std::exchange(data_->warnings, {});
}

int SceneBuilder::add_image(const std::string& name, std::vector<std::byte> bytes)
{
    std::vector<ImageFile>& images = edit_scene().images;
    const auto [found, is_new] = data_->reader.images_.try_emplace(name, int(images.size()));
    if (is_new) images.push_back({name, {}, std::move(bytes)});
    return found->second;
}

int SceneBuilder::add_material(const std::string& json, const std::string& name)
{
    const int index = data_->parse(title("material", name), json,
                                   [&](const JsonValue& v) { return data_->reader.add_material(v, name); });
    if (!name.empty()) data_->reader.materials_[name] = index;
    return index;
}

void SceneBuilder::set_material(int material, const std::string& json)
{
    const std::string name = scene().materials.at(std::size_t(material)).name;
    Material read = data_->parse(title("material", name), json,
                                 [&](const JsonValue& v) { return data_->reader.read_material(v, name); });
    edit_scene().materials[std::size_t(material)] = std::move(read);
}

int SceneBuilder::add_node(const std::string& json)
{
    const int node = data_->parse("node", json, [&](const JsonValue& v) { return data_->reader.node(v, 0); });
    edit_scene().roots.push_back(node);
    return node;
}

int SceneBuilder::add_light(const std::string& json, const std::string& name)
{
    const auto placed =
        data_->parse(title("light", name), json, [&](const JsonValue& v) { return data_->reader.add_light(v, name); });
    SceneDescription& scene = edit_scene();
    Node node;
    node.name = name;
    node.parent_from_node = placed.place;
    node.light = placed.index;
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
    return scene.roots.back();
}

void SceneBuilder::set_light(int node, const std::string& json)
{
    SceneDescription& scene = edit_scene();
    Node& holder = scene.nodes.at(std::size_t(node));
    Light& light = scene.lights.at(std::size_t(holder.light));
    const auto placed = data_->parse(title("light", light.name), json,
                                     [&](const JsonValue& v) { return data_->reader.add_light(v, light.name); });
    scene.lights[std::size_t(holder.light)] = scene.lights[std::size_t(placed.index)];
    scene.lights.pop_back();
    holder.parent_from_node = placed.place;
}

Camera SceneBuilder::read_camera(const std::string& json, const std::string& name) const
{
    return data_->parse("camera", json, [&](const JsonValue& v) { return data_->reader.read_camera(v, name); });
}

void SceneBuilder::set_environment(const std::string& json)
{
    const Environment before = std::exchange(edit_scene().environment, {});
    try {
        data_->parse("environment", json, [&](const JsonValue& v) { data_->reader.read_environment(v); });
    } catch (...) {
        edit_scene().environment = before;
        throw;
    }
}

void SceneBuilder::set_render(const std::string& json)
{
    const RenderHints before = edit_scene().hints;
    edit_scene().hints = {};
    edit_scene().hints.own_light = before.own_light;
    try {
        data_->parse("render", json, [&](const JsonValue& v) { data_->reader.read_render(v); });
    } catch (...) {
        edit_scene().hints = before;
        throw;
    }
}

std::vector<std::string> SceneBuilder::texture_parameters()
{
    std::vector<std::string> keys;
    for (const Parameter<Material>& p : material_parameters())
        if (std::holds_alternative<TextureReference<Material>>(p.member)) keys.emplace_back(p.key);
    return keys;
}

std::string SceneBuilder::material_json(int material) const
{
    const SceneDescription& s = scene();
    const auto textures = index_names(s.textures), images = index_names(s.images), materials = index_names(s.materials),
               measured = index_names(s.measured);
    Warnings ignored;
    return fathom::material_json(s.materials.at(std::size_t(material)),
                                 {data_->name, textures, images, materials, measured, ignored})
        .dump();
}

std::string SceneBuilder::texture_json(int texture) const
{
    const SceneDescription& s = scene();
    const auto textures = index_names(s.textures), images = index_names(s.images);
    Warnings ignored;
    return fathom::texture_json(s.textures.at(std::size_t(texture)), {data_->name, textures, images, {}, {}, ignored})
        .dump();
}

std::string SceneBuilder::light_json(int light) const
{
    Json json = entry(data_->outline_json(), "lights", light);
    refer_by_index(json, "image", scene().lights.at(std::size_t(light)).picture.image);
    return json.dump();
}

std::string SceneBuilder::camera_json(int camera) const
{
    scene().cameras.at(std::size_t(camera));
    return entry(data_->outline_json(), "cameras", camera).dump();
}

std::string SceneBuilder::environment_json() const
{
    Json scene_file = data_->outline_json();
    if (!scene_file.contains("environment")) return "{}";
    Json& json = scene_file["environment"];
    refer_by_index(json, "image", scene().environment.image);
    for (std::size_t i = 0; json.contains("faces") && i < 6; ++i)
        if (const int face = scene().environment.faces[i]; face >= 0) json["faces"][i] = index_name(face);
    return json.dump();
}

}  // namespace fathom
