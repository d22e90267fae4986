#pragma once
#include <string>
#include <vector>

#include "fathom/load.h"
#include "formats/json/json_text.h"

namespace fathom {

/// What materials and textures are written with: how others are called, and where warnings go.
struct ParameterNames {
    const std::string& file;                    ///< for warnings
    const std::vector<std::string>& textures;   ///< by index
    const std::vector<std::string>& images;     ///< paths, by index
    const std::vector<std::string>& materials;  ///< by index
    const std::vector<std::string>& measured;   ///< paths, by index
    Warnings& warnings;
};

Json color_json(Color color);
Json vector_json(const Vec3d& v);
Json matrix_json(const Transform& t);
/// Nothing for the identity.
Json transform_json(const Transform& t);
/// What differs from the default.
Json material_json(const Material& material, const ParameterNames& names);
Json texture_json(const Texture& texture, const ParameterNames& names);

}  // namespace fathom
