// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "fathom/description.h"
#include "materials/records.h"

namespace fathom {

/// Spatial frequency of a texture over a mesh: by texels of images, and by a fixed number of parts per checker square
/// or period of procedural textures.
class TextureDetail {
public:
    /// texture: index of the texture, or no_index for none.
    TextureDetail(const ShadingTables& tables, std::uint32_t texture);

    /// Number of parts that the edge between two vertices needs. Symmetric in a and b.
    double parts(const Mesh& mesh, std::uint32_t a, std::uint32_t b) const;

private:
    /// Linear map from texture coordinates (stored, or computed from positions) to the number of parts needed.
    struct UvMap {
        std::size_t set;
        double rows[2][2];
        TextureMapping mapping = TextureMapping::uv;
        Transform texture_from_mesh{};
    };
    static std::array<double, 2> change(const UvMap& map, const Mesh& mesh, std::uint32_t a, std::uint32_t b);
    void add(const ShadingTables& tables, std::uint32_t texture, const UvMap* outer);
    void add_uv(UvMap map, double across, double down);

    std::vector<UvMap> in_uv_;
    double per_length_ = 0;
};

}  // namespace fathom
