// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/load.h"
#include "formats/json/json_text.h"

namespace fathom {

/// Names of the things that materials and textures refer to, and the destination of warnings.
struct ParameterNames {
    const std::string& file;                    ///< for warnings
    const std::vector<std::string>& textures;   ///< by index
    const std::vector<std::string>& images;     ///< paths, by index
    const std::vector<std::string>& materials;  ///< by index
    const std::vector<std::string>& measured;   ///< paths, by index
    Warnings& warnings;
};

/// A single number for gray, three numbers otherwise.
Json color_json(Color color);
Json vector_json(const Vec3d& v);
Json matrix_json(const Transform& t);
/// An empty value for the identity.
Json transform_json(const Transform& t);
/// The parameters that differ from their defaults.
Json material_json(const Material& material, const ParameterNames& names);
/// Adds the parameters of the light's kind that differ from their defaults.
void add_light_parameters(const Light& light, const ParameterNames& names, Json& to);
/// The parameters that differ from their defaults.
Json texture_json(const Texture& texture, const ParameterNames& names);

}  // namespace fathom
