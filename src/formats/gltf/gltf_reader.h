// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/accessors.h"
#include "formats/gltf/container.h"

namespace fathom {

/// Converts a glTF file to a SceneDescription. Node i of the file becomes node i of the scene; images, textures,
/// materials and meshes are added when they are first referred to.
class GltfReader {
public:
    /// offered  receives the scenes, variants and animations of the file
    GltfReader(GltfFile& file, const LoadOptions& options, SceneFileContents& offered)
        : file_(file), options_(options), offered_(offered)
    {
    }
    SceneDescription read();

private:
    /// One primitive of a mesh as a shape, with its data for skinning and morph targets.
    struct Part {
        Shape shape;
        std::vector<std::uint16_t>
            joints;  ///< indices of joints, as many for each vertex; empty if the mesh has no skin
        std::vector<float> weights;
        // Members below are set if the file has animations.
        Mesh rest;  ///< the mesh without morphing and skinning
        std::vector<MorphTarget> targets;
        std::vector<float> target_weights;
    };

    // Defined in gltf_texture.cpp:
    int image(const JsonValue& index);
    /// Index of the image of a texture; nothing if this build can't read any of its encodings.
    std::optional<int> texture_image(const JsonValue& texture);
    /// Index of the texture that a texture info object refers to, with its uv transform; -1 if its image can't be read.
    int texture(const JsonValue& info, ColorSpace color_space);

    // Defined in gltf_material.cpp:
    int material(const JsonValue& primitive, bool has_colors);
    Material read_material(const JsonValue& v);
    void read_metallic_roughness(const JsonValue& v, Material& m);

    // Defined in gltf_layers.cpp:
    void read_layers(const JsonValue& extensions, Material& m);
    void read_specular_glossiness(const JsonValue& v, Material& m);
    void read_transmission(const JsonValue& extensions, Material& m);
    void read_specular(const JsonValue& v, Material& m);
    void read_coat(const JsonValue& v, Material& m);
    void read_iridescence(const JsonValue& v, Material& m);
    void read_anisotropy(const JsonValue& v, Material& m);
    /// A number or color factor, with the texture that it multiplies.
    FloatInput factor(const JsonValue& v, const char* factor, float otherwise, const char* texture_key, int channel);
    ColorInput color(const JsonValue& v, const char* factor, Color otherwise, const char* texture_key);
    /// Index of a new texture that mixes a and b.
    int add_mix(Color a, Color b, FloatInput by);
    static constexpr float mirror_ior = 10000;

    std::optional<std::size_t> material_index(const JsonValue& primitive);

    // Defined in gltf_mesh.cpp:
    // weights  weights of the morph targets, if the node has its own
    const std::vector<Part>& mesh(const JsonValue& index, const std::optional<JsonValue>& weights, std::size_t node);
    /// Returns nothing, with a warning, if the primitive has no positions.
    std::optional<Accessor> read_positions(const JsonValue& primitive);
    void read_primitive(const JsonValue& primitive, const std::string& name, const std::optional<JsonValue>& weights,
                        std::vector<Part>& parts);
    /// Vertex indices of a primitive as triangles, lines or points; consecutive ones if it has no indices.
    std::vector<std::uint32_t> read_corners(const JsonValue& primitive, std::size_t vertices, int mode);
    void add_points_or_lines(const Mesh& mesh, int mode, Part part, std::vector<Part>& parts);
    void read_attributes(const JsonValue& attributes, std::size_t first, Mesh& mesh, Part& part);
    /// Reads the offsets of a morph target for the attributes that the mesh has.
    MorphTarget read_morph_target(const JsonValue& target, std::size_t first, const Mesh& mesh);
    void add_morphs(const JsonValue& primitive, const std::optional<JsonValue>& weights, std::size_t first, Mesh& mesh,
                    Part& part);

    // Defined in gltf_scene.cpp. Reads a node's name, transform, children and visibility.
    void read_node_transform(const JsonValue& v, std::size_t index);
    /// Reads a node's camera, light, mesh, skin and instances.
    void read_contents(const JsonValue& v, std::size_t index);
    /// Sets the root nodes and the environment of the selected scene; without scenes, nodes without parents are roots.
    void read_roots();
    /// Selects the material variant that LoadOptions names.
    void choose_variant();
    void remove_unused_meshes();
    int camera(const JsonValue& index);
    int light(const JsonValue& index);
    void read_environment(const JsonValue& reference);
    /// EXT_mesh_gpu_instancing: adds one child per instance, with the node's shapes.
    void add_instances(const JsonValue& instancing, std::size_t node);

    // Defined in gltf_skin.cpp. Adds a skinned mesh, bent to its rest pose, as a root node; primitives without joints
    // stay at the node.
    void add_skinned(const JsonValue& skin_index, std::size_t node, const std::vector<Part>& parts);
    Skin read_skin(const JsonValue& skin) const;
    Transform world_from_node(const JsonValue& v, std::size_t node) const;

    // Defined in gltf_animation.cpp:
    void read_animations();
    Animation read_animation(const JsonValue& v);
    /// Reads a channel; nothing if its target is not supported, which is reported.
    std::optional<AnimationChannel> read_channel(const JsonValue& channel, const JsonValue& samplers);
    AnimationChannel channel_of_path(const JsonValue& target, const std::string& path) const;
    std::optional<AnimationChannel> channel_of_pointer(const JsonValue& pointer);
    void scale_by_rest_value(const std::string& pointer, AnimationChannel& channel) const;
    void find_targets();
    /// Registers a mesh that morph targets or a skin deform.
    void add_deformed(const Part& part, int mesh, std::size_t node, int skin);
    void hide_nodes();

    GltfFile& file_;
    const LoadOptions& options_;
    SceneFileContents& offered_;
    SceneDescription scene_;
    std::optional<std::size_t> variant_;  ///< material variant (KHR_materials_variants)

    std::map<std::size_t, int> images_, cameras_, lights_;
    std::map<std::string, int> textures_;
    std::map<std::pair<int, bool>, int>
        materials_;  ///< scene materials by glTF index (-1: none) and presence of vertex colors
    std::map<std::pair<std::size_t, std::size_t>, std::vector<Part>>
        meshes_;                   ///< by mesh index and index of the node that has weights of its own
    std::vector<int> parents_;     ///< parent of each node, -1 for roots
    std::vector<bool> invisible_;  ///< whether the node is hidden, by node index

    AnimationRig rig_;
    std::vector<bool> is_morphed_, may_hide_;         ///< nodes whose morph weights or visibility are animated
    std::vector<std::pair<int, int>> skinned_nodes_;  ///< pairs of a node that holds a skinned mesh and the node that
                                                      ///< it belongs to
};

}  // namespace fathom
