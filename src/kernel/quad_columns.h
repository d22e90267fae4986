// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"
#include "kernel/tables.h"
#include "math/spectrum.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Shading data of quads as columns: small tables are read from registers by lookup(), larger ones are gathered. Any
/// index may be passed; the result is unspecified for an index that is not a quad.
class QuadColumns {
public:
    /// Flags of a quad; `front` is the side of its normal.
    enum Flags : std::uint32_t {
        scatters = 1,
        emits_front = 2,
        emits_back = 4,
        unlit = 8 /* visible to camera and mirror rays, lights nothing */,
        plain = 16 /* smooth and diffuse of one color, or not scattering at all */
    };
    static constexpr int kind_shift = 8;  ///< bits above the flags hold the ClosureKind

    /// Whether a material is plain: see Flags::plain.
    static bool is_plain(const MaterialRecord& material);
    /// Fills the columns. sheared: quads are intersected as triangles by the test that shears coordinates.
    void build(const SceneTables& tables, bool sheared);

    /// Unit normal along cross(edge_u, edge_v).
    Vec3 normal(UInt quad) const { return {number(0, quad), number(1, quad), number(2, quad)}; }
    /// Unit tangent in the plane of the quad.
    Vec3 tangent(UInt quad) const { return {number(3, quad), number(4, quad), number(5, quad)}; }
    /// Bound on intersection rounding from the quad's size: see rounding_along.
    Float rounding(UInt quad) const { return number(6, quad); }
    UInt flags(UInt quad) const { return float_bits(number(7, quad)); }
    /// Light index of the quad, or no_index.
    UInt light(UInt quad) const { return float_bits(number(8, quad)); }
    Spectrum color(UInt quad) const { return spectrum(9, quad); }
    Spectrum emission(UInt quad) const { return spectrum(9 + channels, quad); }

    Vec3 center(UInt quad) const
    {
        return {number(first_center, quad), number(first_center + 1, quad), number(first_center + 2, quad)};
    }

    std::size_t memory_bytes() const { return values_.size() * sizeof(float); }

private:
    static constexpr int first_center = 9 + 2 * channels, columns = first_center + 3;

    Float number(int column, UInt quad) const
    {
        const float* table = values_.data() + std::size_t(column) * stride_;
        if (size_ <= lookup_size) return lookup(table, size_, quad);
        // The last entry stands for anything that is not a quad, such as triangles, which precede quads in numbering.
        const UInt last(static_cast<std::uint32_t>(size_));
        const Mask is_quad = less(quad, last) & !less(quad, UInt(0u));
        return gather(table, select(is_quad, quad, last));
    }
    Spectrum spectrum(int column, UInt quad) const
    {
        Spectrum s;
        for (int c = 0; c < channels; ++c) s.c[c] = number(column + c, quad);
        return s;
    }

    int size_ = 0;
    std::size_t stride_ = 0;
    std::vector<float> values_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
