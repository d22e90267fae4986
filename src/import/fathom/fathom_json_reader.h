#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "import/common/json_object.h"
#include "import/common/load_context.h"
#include "scene/append.h"
#include "scene/parameters.h"

namespace fathom {

/// {"axis": [x, y, z], "angle_deg": a}: right-handed.
Transform read_rotation(const JsonValue& v);

/// The reader of Fathom's own scene file, while it works. Names become indices here: whatever is referred to by name is
/// read when it is first asked for.
class FathomJsonReader {
public:
    FathomJsonReader(std::filesystem::path file, const JsonValue& root, LoadContext& context)
        : file_(std::move(file)), root_(root), context_(context)
    {
    }
    SceneDescription read();

private:
    /// What a texture is looked up for decides how an 8-bit image is decoded where the file doesn't say it.
    enum class Use { color, data };
    enum class State { unread, reading, read };
    struct Named {
        State state = State::unread;
        int index = -1;
    };

    // fathom_json.cpp
    Camera read_camera(const JsonValue& v, const std::string& name);
    void read_cameras(JsonObject& scene);
    void read_environment(const JsonValue& v);
    void read_render(const JsonValue& v);
    void keep_own_light();
    /// Reads what nobody refers to, so that mistakes in it show before it is used.
    void read_unused();

    // fathom_json_material.cpp
    int image(const JsonValue& path);
    int texture(const JsonValue& v, Use use);
    int add_texture(const JsonValue& v, const std::string& name, Use use);
    /// The parameters that a kind of Owner has. use: of what their textures are looked up for; if not given, of a
    /// colour for colours, else of data.
    template <class Owner>
    void read_parameters(JsonObject& o, std::span<const Parameter<Owner>> parameters, std::uint32_t kind,
                         std::optional<Use> use, Owner& owner);
    void read_color(const JsonValue& v, Use use, ColorInput& out);
    void read_float(const JsonValue& v, Use use, FloatInput& out);
    static std::vector<RampStop> read_stops(const JsonValue& v);
    int material(const JsonValue& v);
    int add_material(const JsonValue& v, const std::string& name);
    void read_emission_unit(JsonObject& o, Material& material);

    // fathom_json_light.cpp
    /// Adds a light and the node that places it; returns the node.
    int add_light(const JsonValue& v, const std::string& name);
    void read_lights(JsonObject& scene);

    // fathom_json_shape.cpp
    /// depth  of arrays around it
    Transform transform(const JsonValue& v, int depth = 0);
    std::optional<Shape> read_shape(JsonObject& o);
    int mesh(const JsonValue& v);
    int add_mesh(const JsonValue& v, const std::string& name);

    // fathom_json_node.cpp
    int node(const JsonValue& v, int depth);
    int add_node(const JsonValue& v, const std::string& name, int depth);
    int named_node(const JsonValue& v, int depth);
    void read_motion(const JsonValue& v, Node& node);
    void read_model(JsonObject& o, const JsonValue& path, Node& node);
    /// Throws Error if there is no memory for a copy of so many nodes.
    void check_copy(const JsonValue& v, std::size_t nodes) const;
    void override_materials(JsonObject& o, const Appended& model);

    /// The entry of a top-level table that `v`, a string, names. Throws Error with a suggestion if there is none.
    JsonValue find(const char* table, const char* what, const JsonValue& v);
    /// A top-level object of named things; nullptr if the file has none of that name.
    const JsonValue* table(const char* key);

    std::filesystem::path file_;
    const JsonValue& root_;
    LoadContext& context_;
    SceneDescription scene_;
    std::map<std::string, JsonValue> tables_;

    std::map<std::string, int> images_;
    std::map<std::pair<std::string, Use>, int> textures_;
    std::map<std::string, int> materials_, meshes_;
    std::map<std::string, Named> nodes_;
    std::vector<std::string> reading_nodes_;  ///< names on the way to here, for the message about a cycle
    std::map<std::string, Appended> models_;  ///< by path and options: read once, then instanced
};

}  // namespace fathom
