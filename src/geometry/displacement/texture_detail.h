#pragma once
#include <array>
#include <vector>

#include "fathom/description.h"
#include "materials/records.h"

namespace fathom {

/// How finely a texture varies over a mesh: by the texels of its pictures, by some parts of each square of a checker
/// and of each period of what is computed.
class TextureDetail {
public:
    /// texture: no_index for none.
    TextureDetail(const ShadingTables& tables, std::uint32_t texture);

    /// The parts into which an edge between two vertices is to be cut. It doesn't matter which of them comes first.
    double parts(const Mesh& mesh, std::uint32_t a, std::uint32_t b) const;

private:
    /// Rows of the map from a set of texture coordinates, or those by place, to parts.
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
