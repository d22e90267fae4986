#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "import/gltf/accessors.h"
#include "import/gltf/container.h"

namespace fathom {

/// Turns a glTF file into a SceneDescription. Node i of the file is node i of the scene; images, textures, materials
/// and meshes come in as they are referred to.
class GltfReader {
public:
    GltfReader(GltfFile& file, const LoadOptions& options) : file_(file), options_(options) {}
    SceneDescription read();

private:
    /// One primitive of a mesh, as a shape; and what moves with skins and morph targets.
    struct Part {
        Shape shape;
        std::vector<std::uint16_t> joints;  ///< four for each vertex, if it has a skin
        std::vector<float> weights;
    };

    // gltf_texture.cpp
    int image(const JsonValue& index);
    std::optional<int> texture_image(const JsonValue& texture);
    int texture(const JsonValue& info, ColorSpace color_space);

    // gltf_material.cpp
    int material(const JsonValue& primitive, bool has_colors);
    Material read_material(const JsonValue& v);
    void read_metallic_roughness(const JsonValue& v, Material& m);

    // gltf_layers.cpp
    void read_layers(const JsonValue& extensions, Material& m);
    void read_specular_glossiness(const JsonValue& v, Material& m);
    void read_transmission(const JsonValue& extensions, Material& m);
    void read_specular(const JsonValue& v, Material& m);
    void read_coat(const JsonValue& v, Material& m);
    void read_iridescence(const JsonValue& v, Material& m);
    void read_anisotropy(const JsonValue& v, Material& m);
    /// A number, or colour, with the texture that it is multiplied with.
    FloatInput factor(const JsonValue& v, const char* factor, float otherwise, const char* texture_key, int channel);
    ColorInput color(const JsonValue& v, const char* factor, Color otherwise, const char* texture_key);
    /// A texture that goes from a to b.
    int add_mix(Color a, Color b, FloatInput by);
    static constexpr float mirror_ior = 10000;

    // gltf_mesh.cpp
    /// weights  of morph targets, if the node has its own
    const std::vector<Part>& mesh(const JsonValue& index, const std::optional<JsonValue>& weights, std::size_t node);
    void read_primitive(const JsonValue& primitive, const std::string& name, const std::optional<JsonValue>& weights,
                        std::vector<Part>& parts);
    std::vector<std::uint32_t> read_corners(const JsonValue& primitive, std::size_t vertices, int mode);
    void add_points_or_lines(const Mesh& mesh, int mode, Part part, std::vector<Part>& parts);
    void read_attributes(const JsonValue& attributes, std::size_t first, Mesh& mesh, Part& part);
    void add_morphs(const JsonValue& primitive, const JsonValue& weights, std::size_t first, Mesh& mesh);

    // gltf_scene.cpp
    void read_place(const JsonValue& v, std::size_t index);
    void read_contents(const JsonValue& v, std::size_t index);
    void read_roots();
    void remove_unused_meshes();
    int camera(const JsonValue& index);
    int light(const JsonValue& index);
    void add_instances(const JsonValue& instancing, std::size_t node);

    // gltf_skin.cpp
    void add_skinned(const JsonValue& skin_index, std::size_t node, const std::vector<Part>& parts);
    std::vector<Transform> joint_transforms(const JsonValue& skin);
    Transform world_from_node(const JsonValue& v, std::size_t node) const;

    GltfFile& file_;
    const LoadOptions& options_;
    SceneDescription scene_;

    std::map<std::size_t, int> images_, cameras_, lights_;
    std::map<std::string, int> textures_;
    std::map<std::pair<int, bool>, int> materials_;  ///< by index (-1: none) and whether there are vertex colours
    std::map<std::pair<std::size_t, std::size_t>, std::vector<Part>>
        meshes_;                   ///< by index and node with weights of its own
    std::vector<int> parents_;     ///< of each node, -1 for none
    std::vector<bool> invisible_;  ///< by node
};

}  // namespace fathom
