// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/load.h"
#include "formats/json/json_text.h"

namespace fathom {

/// Names of the objects that materials and textures refer to, and the destination of warnings.
struct ParameterNames {
    const std::string& file;                    ///< scene file named in warnings
    const std::vector<std::string>& textures;   ///< names of textures, by index
    const std::vector<std::string>& images;     ///< paths of images, by index
    const std::vector<std::string>& materials;  ///< names of materials, by index
    const std::vector<std::string>& measured;   ///< paths of measured BRDFs, by index
    Warnings& warnings;
};

/// JSON of a color: a single number for gray, three numbers otherwise.
Json color_json(Color color);
Json vector_json(const Vec3d& v);
Json matrix_json(const Transform& t);
/// JSON of a transform; an empty value for the identity.
Json transform_json(const Transform& t);
/// JSON of a material: the parameters that differ from their defaults.
Json material_json(const Material& material, const ParameterNames& names);
/// Adds the parameters of the light's kind that differ from their defaults.
void add_light_parameters(const Light& light, const ParameterNames& names, Json& to);
/// JSON of a texture: the parameters that differ from their defaults.
Json texture_json(const Texture& texture, const ParameterNames& names);

}  // namespace fathom
