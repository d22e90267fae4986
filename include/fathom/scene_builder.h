// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/description.h"
#include "fathom/load.h"

namespace fathom {

/// Adds objects to a scene that are given as JSON, in the notation of scene files (docs/scene-format.md).
///
///     SceneBuilder builder;
///     builder.add_material(R"({"kind": "metal", "roughness": 0.2})", "steel");
///     builder.add_node(R"({"sphere": {"radius": 2}, "material": "steel"})");
///
/// It is meant for bindings to other languages, which thereby have all parameters with their checks and messages.
/// Objects refer to others by name, or by `#` and the index in the description: `"material": "#3"`. Textures, materials
/// and meshes may also be defined in place; textures with equal definitions are added once. Functions throw Error for
/// invalid JSON; `what` names the object in its message.
class FATHOM_API SceneBuilder {
public:
    /// Takes over a scene.
    ///
    /// scene   The scene; may be empty.
    /// folder  Folder that paths in JSON are relative to; empty: the working directory.
    explicit SceneBuilder(SceneDescription scene = {}, const std::filesystem::path& folder = {});
    /// Moves the scene; the source may only be assigned to or destroyed afterwards.
    SceneBuilder(SceneBuilder&&) noexcept;
    /// Moves the scene; the source may only be assigned to or destroyed afterwards.
    SceneBuilder& operator=(SceneBuilder&&) noexcept;
    ~SceneBuilder();

    /// Returns the scene with everything that was added.
    const SceneDescription& scene() const;
    /// Returns the scene for other changes. Nothing may be removed that JSON refers to by index.
    SceneDescription& edit_scene();
    /// Returns the problems that left a usable scene since the last call.
    Warnings take_warnings();

    /// Adds an encoded image, which JSON refers to by `name` as if it were the path of a file. Returns its index. An
    /// image that was added under the same name before is kept.
    int add_image(const std::string& name, std::vector<std::byte> bytes);
    /// Adds a material and returns its index.
    int add_material(const std::string& json, const std::string& name);
    /// Replaces a material; its name is kept. Throws std::out_of_range if there is none of that index.
    void set_material(int material, const std::string& json);
    /// Adds a node at the root of the scene and returns its index.
    int add_node(const std::string& json);
    /// Adds a light at the root of the scene and returns the index of the node that holds it.
    int add_light(const std::string& json, const std::string& name);
    /// Replaces the light of a node that add_light() returned, and places that node. Throws std::out_of_range for other
    /// indices.
    void set_light(int node, const std::string& json);
    /// Returns a camera of the scene that is not placed yet.
    Camera read_camera(const std::string& json, const std::string& name) const;
    /// Replaces the environment.
    void set_environment(const std::string& json);
    /// Replaces the render settings that the scene contains, the object `render` of scene files.
    void set_render(const std::string& json);

    /// Returns the parameters of materials that are a texture and nothing else, such as `normal_map`. Others are colors
    /// or numbers, to which a texture is given as `{"texture": ...}`.
    static std::vector<std::string> texture_parameters();
    /// Returns an object of the scene as JSON. Textures, materials and images in it are referred to by index.
    std::string material_json(int material) const;
    /// Returns a texture in the same form.
    std::string texture_json(int texture) const;
    /// Returns a light in the same form.
    std::string light_json(int light) const;
    /// Returns a camera in the same form, in the space of its node.
    std::string camera_json(int camera) const;
    /// Returns the environment in the same form; one of kind `none` is an empty object.
    std::string environment_json() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace fathom
