#pragma once
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "fathom/description.h"
#include "fathom/load.h"
#include "formats/gltf/glb_buffer.h"

namespace fathom {

/// Materials as glTF's metallic-roughness model and its ratified extensions have them, with their pictures. What these
/// can't say is told, once for each material.
class GlbMaterials {
public:
    GlbMaterials(const SceneDescription& scene, GlbBuffer& buffer, const std::string& file, Warnings& warnings);

    /// The index among glTF's of one of the scene's; of what has none (-1) a grey one.
    int index(int material);

    /// Adds "materials", "textures", "images" and "samplers".
    void put_into(Json& gltf) const;
    const std::set<std::string>& extensions() const { return extensions_; }

private:
    /// Of a mixture, with what the mixture itself says; else the material.
    Material greater_part(int material);
    Json material_json(const Material& m);
    Json base_json(const Material& m);
    void add_transmission(const Material& m, Json& json);
    void add_layers(const Material& m, Json& json);
    void report_losses(const Material& m);

    /// An object of "extensions", which then counts as used.
    Json& extension(Json& json, const char* name);
    /// A reference to a picture; null where there is none, or none that glTF can have, which is told.
    Json texture_info(int texture, ColorSpace color_space);
    Json thickness_info(const Material& m, Json& layer);
    void put_factor(Json& json, const char* key, const FloatInput& input, float usual, const char* texture_key,
                    int channel);
    void put_color(Json& json, const char* key, const ColorInput& input, Color usual, const char* texture_key);
    /// The picture at the end of textures that only turn uv, and how; nullptr if it is none.
    const Texture* picture_of(int texture);
    int texture_json(const Texture& t);
    int image(int index);
    int sampler(const Texture& t);
    /// What a texture that is no picture is on average.
    Color mean_of(int texture) const;
    bool is_picture(int texture) const;
    void report(const std::string& what);

    const SceneDescription& scene_;
    GlbBuffer& buffer_;
    const std::string& file_;
    Warnings& warnings_;
    const Material* current_ = nullptr;  ///< of which something is told
    std::map<int, int> indices_, images_;
    std::map<std::tuple<Wrap, Wrap, bool>, int> samplers_;
    std::map<std::pair<int, int>, int> textures_;  ///< by picture and sampler
    Json materials_ = Json::array(), texture_list_ = Json::array(), image_list_ = Json::array(),
         sampler_list_ = Json::array();
    std::set<std::string> extensions_;
};

}  // namespace fathom
