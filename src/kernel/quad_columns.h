#pragma once
#include <vector>

#include "fathom/description.h"
#include "kernel/tables.h"
#include "math/spectrum.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// What shading needs to know of each quad, column by column: small tables are read from registers (lookup), larger
/// ones gathered. Any index may be asked for; what is not a quad's gives anything.
class QuadColumns {
public:
    /// front: the side of the normal.
    enum Flags : std::uint32_t {
        scatters = 1,
        emits_front = 2,
        emits_back = 4,
        unlit = 8 /* seen by the camera only */,
        plain = 16 /* smooth, diffuse, of one colour; what does not scatter is plain, too */
    };
    static constexpr int kind_shift = 8;  ///< above the flags: the ClosureKind

    static bool is_plain(const MaterialRecord& material);
    /// sheared: quads are met as triangles, by the test that shears coordinates.
    void build(const SceneTables& tables, bool sheared);

    Vec3 normal(UInt quad) const
    {
        return {number(0, quad), number(1, quad), number(2, quad)};
    }  ///< unit, along cross(edge_u, edge_v)
    Vec3 tangent(UInt quad) const
    {
        return {number(3, quad), number(4, quad), number(5, quad)};
    }  ///< unit, in its plane
    Float rounding(UInt quad) const { return number(6, quad); }  ///< by the size of it: see rounding_along
    UInt flags(UInt quad) const { return float_bits(number(7, quad)); }
    UInt light(UInt quad) const { return float_bits(number(8, quad)); }  ///< or no_index
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
        // For what is no quad stands the last entry: also for triangles, whose numbers lie before those of quads.
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
