// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "fathom/description.h"
#include "fathom/load.h"
#include "formats/gltf/glb_buffer.h"

namespace fathom {

/// Converts materials to glTF's metallic-roughness model with its ratified extensions, and writes their images. Losses
/// are reported once for each material.
class GlbMaterials {
public:
    GlbMaterials(const SceneDescription& scene, GlbBuffer& buffer, const std::string& file, Warnings& warnings);

    /// glTF index of a material of the scene; for -1 that of a gray material.
    int index(int material);

    /// Adds "materials", "textures", "images" and "samplers" to the file's root object.
    void put_into(Json& gltf) const;
    const std::set<std::string>& extensions() const { return extensions_; }

private:
    /// The dominant material of a mixture, with the mixture's own parameters; other materials unchanged.
    Material dominant_material(int material);
    Json material_json(const Material& m);
    Material approximated(Material m);
    void put_base_color(const Material& m, Json& json);
    FloatInput ggx_roughness(const Material& m);
    void put_metallic_roughness(const Material& m, Json& json);
    void put_emission(const Material& m, Json& json);
    static void put_alpha_mode(const Material& m, Json& json);
    void add_transmission(const Material& m, Json& json);
    void add_layers(const Material& m, Json& json);
    void report_losses(const Material& m);

    /// The object of an extension, which is marked as used.
    Json& extension(Json& json, const char* name);
    /// A reference to an image texture; null if there is none, or if glTF can't express it, which is reported.
    Json texture_info(int texture, ColorSpace color_space);
    Json thickness_info(const Material& m, Json& layer);
    void put_factor(Json& json, const char* key, const FloatInput& input, float usual, const char* texture_key,
                    int channel);
    void put_color(Json& json, const char* key, const ColorInput& input, Color usual, const char* texture_key);
    void put_normal(Json& json, const char* key, int texture, float scale);
    /// The image texture behind textures that only transform uv, with that transform; nullptr if there is none.
    const Texture* picture_of(int texture);
    int texture_json(const Texture& t);
    int image(int index);
    int sampler(const Texture& t);
    /// The mean color of a texture that is not an image.
    Color mean_of(int texture) const;
    bool is_picture(int texture) const;
    void report(const std::string& what);

    const SceneDescription& scene_;
    GlbBuffer& buffer_;
    const std::string& file_;
    Warnings& warnings_;
    const Material* current_ = nullptr;  ///< the material named in reports of losses
    std::map<int, int> indices_, images_;
    std::map<std::tuple<Wrap, Wrap, bool>, int> samplers_;
    std::map<std::pair<int, int>, int> textures_;  ///< glTF textures by image and sampler
    Json materials_ = Json::array(), texture_list_ = Json::array(), image_list_ = Json::array(),
         sampler_list_ = Json::array();
    std::set<std::string> extensions_;
};

}  // namespace fathom
