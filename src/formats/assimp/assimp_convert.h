// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <assimp/material.h>
#include <assimp/scene.h>

#include <map>
#include <optional>
#include <string>

#include "formats/assimp/module.h"

namespace fathom {

/// Converts an Assimp scene to a SceneDescription.
class AssimpConverter {
public:
    AssimpConverter(const aiScene& from, const std::filesystem::path& file, AssimpAnswer& answer)
        : from_(from), file_(file), answer_(answer), to_(answer.scene)
    {
    }
    /// world_from_file  transform applied above the root node
    void convert(const Transform& world_from_file);

private:
    void add_mesh(const aiMesh& mesh);
    void add_material(const aiMaterial& material);
    void add_layers(const aiMaterial& material, Color diffuse, Material& m);
    void add_camera(const aiCamera& camera);
    void add_light(const aiLight& light);
    int add_node(const aiNode& node, int depth);
    int texture(const aiMaterial& material, aiTextureType type, ColorSpace color_space, unsigned index = 0);
    int image(const std::string& path);
    bool read_embedded(const aiTexture& texture, ImageFile& image);
    void warn(std::string message) { answer_.warnings.push_back(std::move(message)); }

    const aiScene& from_;
    const std::filesystem::path& file_;
    AssimpAnswer& answer_;
    SceneDescription& to_;
    std::map<std::string, int> images_, cameras_, lights_;  ///< cameras and lights are keyed by the name of their node
    std::map<int, int> colored_;  ///< indexed by material: copies of materials for meshes with vertex colors
};

}  // namespace fathom
