// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reads the material at a surface: its parameters with textures applied, and the shading normal after bump and normal
/// mapping.
#include "geometry/surface/surface.h"
#include "materials/closures/closure.h"
#include "materials/hair_color.h"
#include "materials/read/bump.h"
#include "materials/read/disney.h"
#include "materials/read/layers.h"
#include "materials/read/measured.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Reads material parameters of hits, for all lanes at once.
class MaterialReader {
public:
    explicit MaterialReader(const LaneScene& scene) : scene_(scene), t_(scene.tables) {}

    const SceneTables& tables() const { return t_; }

    /// A member of the MaterialRecord of each lane.
    template <class Member>
    auto get(Member MaterialRecord::* member, UInt material, Mask m) const
    {
        return gather(t_.materials, member, material, m);
    }

    /// Emitted radiance of surfaces, or the radiance that unlit materials show. flags: those of MaterialRecord.
    Spectrum emission(const Surface& s, UInt flags, Mask m) const
    {
        Spectrum e = get(&MaterialRecord::emission, s.material, m);
        // Vertex colors multiply the base color, which is the radiance of unlit materials.
        constexpr std::uint32_t colored_base = MaterialRecord::unlit | MaterialRecord::vertex_colored;
        const Mask colored = m & ((flags & UInt(colored_base)) == UInt(colored_base));
        if (any(colored))
            for (int c = 0; c < channels; ++c) e.c[c] = select(colored, e.c[c] * s.at.vertex_color[c], e.c[c]);
        if (!scene_.has(Feature::textures)) return e;
        const UInt texture = get(&MaterialRecord::emission_texture, s.material, m);
        const Texel t = evaluate_textures(t_, texture, s.at, m);
        for (int c = 0; c < channels; ++c) e.c[c] = e.c[c] * t.c[c];
        return e;
    }

    /// Reads the parameters of the material, and applies bump and normal maps to the shading normal.
    ///
    /// Point  MaterialPoint or a type derived from it, as the closure requires
    template <class Point>
    [[gnu::always_inline]] void read(Surface& s, Mask entering, Mask m, Point& p) const
    {
        p.entering = entering;
        const RecordRow<MaterialRecord, MaterialRecord::row_words> row(t_.materials, s.material, m);
        for (std::size_t c = 0; c < channels; ++c)
            p.base_color.c[c] = row.word[detail::word_of(&MaterialRecord::base_color) + c];
        p.roughness = row.get(&MaterialRecord::roughness);
        p.metallic = row.get(&MaterialRecord::metallic);
        p.ior = row.get(&MaterialRecord::ior);
        p.fuzz = row.get(&MaterialRecord::fuzz);
        const UInt flags = row.get(&MaterialRecord::flags);
        p.thin = (flags & UInt(MaterialRecord::thin)) != UInt(0);
        p.sheet = (flags & UInt(MaterialRecord::sheet)) != UInt(0);
        p.beckmann = (flags & UInt(MaterialRecord::beckmann)) != UInt(0);
        p.separable = (flags & UInt(MaterialRecord::separable)) != UInt(0);
        p.compensated = (flags & UInt(MaterialRecord::compensated)) != UInt(0);
        p.nonlinear = (flags & UInt(MaterialRecord::nonlinear)) != UInt(0);
        if (scene_.has(Feature::bump_maps)) {
            const Mask bumped = m & ((flags & UInt(MaterialRecord::bumped)) != UInt(0));
            if (any(bumped)) apply_bump_map(t_, bumped, s);
        }
        const Mask colored = m & ((flags & UInt(MaterialRecord::vertex_colored)) != UInt(0));
        for (int c = 0; c < channels && any(colored); ++c)
            p.base_color.c[c] = select(colored, p.base_color.c[c] * s.at.vertex_color[c], p.base_color.c[c]);
        const Mask textured = m & ((flags & UInt(MaterialRecord::textured)) != UInt(0));
        if (any(textured)) apply_textures(s, row.get(&MaterialRecord::base_texture), textured, p);
        const Mask tinted = m & ((flags & UInt(MaterialRecord::tinted)) != UInt(0));
        if (any(tinted)) p.specular_tint = specular_tint(s, tinted);
        const Mask absorbing = m & ((flags & UInt(MaterialRecord::absorption)) != UInt(0));
        if (any(absorbing)) p.base_color = select(absorbing, hair_color(p.base_color, p.metallic), p.base_color);
        if (scene_.has(Feature::map_tangents)) {
            const Mask own = m & ((flags & UInt(MaterialRecord::map_tangents)) != UInt(0)) & !s.has_mesh_tangent;
            if (any(own)) use_map_tangents(row.get(&MaterialRecord::normal_texture), own, s);
        }
        if constexpr (std::is_same_v<Point, LayeredMaterialPoint>)
            LayersReader(t_, s, row.get(&MaterialRecord::layers), m).read(p.layers);
        if constexpr (std::is_same_v<Point, DisneyMaterialPoint>)
            read_disney(t_, s, get(&MaterialRecord::disney, s.material, m), m, p.disney);
        if constexpr (std::is_same_v<Point, MeasuredMaterialPoint>)
            read_measured(t_, s, get(&MaterialRecord::measured, s.material, m), m, p.measured);
        const Mask bent = m & ((flags & UInt(MaterialRecord::normal_mapped)) != UInt(0));
        if (any(bent)) {
            const UInt texture = row.get(&MaterialRecord::normal_texture);
            const Float scale = row.get(&MaterialRecord::normal_scale);
            s.ns = TangentFrame::of_map(t_, s, texture, bent)
                       .bend(evaluate_textures(t_, texture, s.at, bent), scale, bent);
        }
    }

private:
    /// Replaces the mesh's tangents by those of the normal map: parameters without a map, such as anisotropy, refer to
    /// them.
    [[gnu::noinline]] void use_map_tangents(UInt normal_texture, Mask own, Surface& s) const
    {
        s.has_map_tangents = own;
        const Mask mapped = own & (normal_texture != UInt(no_index));
        const TangentFrame frame = TangentFrame::of_map(t_, s, normal_texture, mapped);
        s.tangent = select(mapped, frame.tangent, s.tangent);
        const Float side = dot(cross(s.ns, frame.tangent), frame.bitangent);
        s.bitangent_sign = select(mapped, copysign(Float(1), side), s.bitangent_sign);
    }
    /// Color that multiplies reflections of glass and plastic; 1 in lanes outside m.
    [[gnu::noinline]] Spectrum specular_tint(const Surface& s, Mask m) const
    {
        Spectrum tint = get(&MaterialRecord::specular_tint, s.material, m);
        const Texel t = evaluate_textures(t_, get(&MaterialRecord::specular_tint_texture, s.material, m), s.at, m);
        for (int c = 0; c < channels; ++c) tint.c[c] = select(m, tint.c[c] * t.c[c], Float(1));
        return tint;
    }
    void apply_textures(const Surface& s, UInt base_texture, Mask m, MaterialPoint& p) const
    {
        const Texel base = evaluate_textures(t_, base_texture, s.at, m);
        for (int c = 0; c < channels; ++c)
            p.base_color.c[c] = select(m, p.base_color.c[c] * base.c[c], p.base_color.c[c]);
        using Word = std::uint32_t MaterialRecord::*;
        const auto scalar = [&](Word texture, Word channel, Float& value) {
            const UInt id = get(texture, s.material, m);
            const Mask has = m & (id != UInt(no_index));
            if (none(has)) return;
            const Texel t = evaluate_textures(t_, id, s.at, has);
            value = select(has, value * t.channel(get(channel, s.material, m)), value);
        };
        scalar(&MaterialRecord::roughness_texture, &MaterialRecord::roughness_channel, p.roughness);
        scalar(&MaterialRecord::metallic_texture, &MaterialRecord::metallic_channel, p.metallic);
    }

    const LaneScene& scene_;
    const SceneTables& t_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
