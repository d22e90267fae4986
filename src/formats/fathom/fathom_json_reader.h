// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "formats/common/load_context.h"
#include "formats/common/measured_file.h"
#include "formats/json/json_object.h"
#include "formats/ply/ply.h"
#include "scene/append.h"
#include "scene/parameters.h"

namespace fathom {

struct LightKindInfo;

/// Reads {"axis": [x, y, z], "angle_deg": a} as a right-handed rotation.
Transform read_rotation(const JsonValue& v);

/// Reads two or more motion keys with increasing times. read_rest(object, key) reads the other members of a key;
/// `owner` names what moves, in messages.
template <class Key, class F>
void read_motion_keys(const JsonValue& v, const char* owner, std::vector<Key>& motion, const F& read_rest)
{
    v.array(2);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const JsonValue value = v[i];
        JsonObject o(value);
        const JsonValue time = o.require("time");
        Key key;
        key.time = time.number();
        if (!motion.empty() && !(motion.back().time < key.time)) time.fail("times must increase");
        read_rest(o, key);
        o.done(("in a key of " + std::string(owner) + " motion").c_str());
        motion.push_back(std::move(key));
    }
}

/// The reader of Fathom's own scene format. Names are resolved to indices, and things referred to by name are read on
/// first reference.
class FathomJsonReader {
public:
    FathomJsonReader(std::filesystem::path file, const JsonValue& root, LoadContext& context)
        : file_(std::move(file)), root_(root), context_(context)
    {
    }
    SceneDescription read();

private:
    friend class SceneBuilder;  // adds single objects to a scene

    /// The purpose of a texture decides how an 8-bit image is decoded if the file doesn't specify its color space.
    enum class Use { color, data };
    enum class State { unread, reading, read };
    struct Named {
        State state = State::unread;
        int index = -1;
    };
    /// A camera or a light, with its transform in the space of its node.
    struct Placed {
        int index = -1;
        Transform place;
        bool is_placed = false;  ///< whether a node refers to it
    };

    // Defined in fathom_json.cpp:
    Camera read_camera(const JsonValue& v, const std::string& name);
    void read_cameras(JsonObject& scene);
    void read_environment(const JsonValue& v);
    void read_render(const JsonValue& v);
    void keep_zero_exposure();
    void add_unplaced_to_roots();
    /// Reads objects that nothing refers to, so that errors in them are reported.
    void read_unused();

    // Defined in fathom_json_material.cpp:
    int image(const JsonValue& path);
    /// Index of the measured BRDF in a file, which is read on first use.
    int measured(const JsonValue& path);
    /// Reads all named textures whose decoding doesn't depend on their use, in the order of the file.
    void read_textures();
    /// Whether the texture contains an image without a color space, so that its use decides the decoding.
    bool is_decoded_by_use(const JsonValue& v);
    /// Index of a texture given by name or in place.
    int texture(const JsonValue& v, Use use);
    int add_texture(const JsonValue& v, const std::string& name, Use use);
    Texture read_texture(const JsonValue& v, const std::string& name, Use use);
    /// Reads the parameters that a kind of Owner has.
    ///
    /// use  purpose of their textures; if absent, `color` for color parameters and `data` for others
    template <class Owner>
    void read_parameters(JsonObject& o, std::span<const Parameter<Owner>> parameters, std::uint32_t kind,
                         std::optional<Use> use, Owner& owner);
    template <class Owner, class T>
    void read_value(const JsonValue& v, const Parameter<Owner>& p, std::optional<Use> use, T& out);
    void read_color(const JsonValue& v, Use use, ColorInput& out);
    void read_float(const JsonValue& v, Use use, FloatInput& out);
    static std::vector<RampStop> read_stops(const JsonValue& v);
    /// Index of a material given by name or in place.
    int material(const JsonValue& v);
    int add_material(const JsonValue& v, const std::string& name);
    Material read_material(const JsonValue& v, const std::string& name);
    /// Reads all named materials, in the order of the file.
    void read_materials();
    void read_emission_unit(JsonObject& o, Material& material);
    static void read_conductor(JsonObject& o, Material& material);

    // Defined in fathom_json_light.cpp:
    bool read_picture(JsonObject& o, const LightKindInfo& info, Light& light);
    Placed add_light(const JsonValue& v, const std::string& name);
    void read_light(const JsonValue& v, Node& node);

    // Defined in fathom_json_shape.cpp:
    // depth  number of enclosing arrays
    Transform transform(const JsonValue& v, int depth = 0);
    std::optional<Shape> read_shape(JsonObject& o);
    /// Index of a mesh, of curves or of points; unnamed ones are defined in place.
    using Add = int (FathomJsonReader::*)(const JsonValue&, const std::string&);
    int data(const JsonValue& v, const std::map<std::string, int>& named, const char* table, const char* what, Add add);
    int add_mesh(const JsonValue& v, const std::string& name);
    int add_curves(const JsonValue& v, const std::string& name);
    int add_points(const JsonValue& v, const std::string& name);
    void read_mesh_motion(const JsonValue& v, Mesh& mesh);
    void read_curves_motion(const JsonValue& v, Curves& curves);
    /// Reads the PLY file that holds the vertex data, as fathom::save_scene writes it; nothing if the data is in this
    /// file.
    std::optional<PlyData> read_data_file(JsonObject& o);

    // Defined in fathom_json_node.cpp:
    int node(const JsonValue& v, int depth);
    int add_node(const JsonValue& v, const std::string& name, int depth);
    /// Index of a named node, which is read on first reference; throws Error at a cycle.
    int named_node(const JsonValue& v, int depth);
    void read_motion(const JsonValue& v, Node& node);
    /// Instances another scene file below the node.
    void read_model(JsonObject& o, const JsonValue& path, Node& node);
    /// Throws Error if memory doesn't suffice for a copy of `nodes` nodes.
    void check_copy(const JsonValue& v, std::size_t nodes) const;
    /// Replaces materials of a model's copy by those that the node names.
    void override_materials(JsonObject& o, const Appended& model);

    /// The entry of a top-level table that the string `v` names. Throws Error with a suggestion if there is none.
    JsonValue find(const char* table, const char* what, const JsonValue& v);
    /// A top-level object with an entry for each name; nullptr if the file lacks it.
    const JsonValue* table(const char* key);
    /// Calls use(name, value) for each entry of a top-level object, in the order of the file.
    template <class Use>
    void for_each_named(const char* key, const Use& use)
    {
        const JsonValue* all = table(key);
        if (!all) return;
        for (const auto& [name, json] : all->json().items()) use(name, (*all)[name]);
    }
    /// The camera or light of that name, which is marked as placed.
    Placed place(IndexedMap<std::string, Placed>& all, const char* table, const char* what, const JsonValue& v);

    std::filesystem::path file_;
    const JsonValue& root_;
    LoadContext& context_;
    SceneDescription scene_;
    std::map<std::string, JsonValue> tables_;

    std::map<std::string, int> images_;
    MeasuredFiles measured_{context_, scene_};
    std::map<std::pair<std::string, Use>, int> textures_;
    /// Textures defined in place, by their JSON: SceneBuilder adds equal ones once. Nothing in the reader of a file.
    std::optional<std::map<std::pair<std::string, Use>, int>> shared_textures_;
    std::set<std::string> open_textures_;  ///< named textures being read; detects cycles
    std::map<std::string, bool> decoded_by_use_;
    std::map<std::string, int> materials_, meshes_, curves_, points_;
    IndexedMap<std::string, Placed> cameras_, lights_;
    std::map<std::string, Named> nodes_;
    std::vector<std::string> reading_nodes_;  ///< names of the enclosing nodes, for the message about a cycle
    std::map<std::string, Appended> models_;  ///< models by path and options: each is read once and then instanced
};

}  // namespace fathom
