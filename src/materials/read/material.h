// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reads the material at a surface: its parameters with textures applied, and the shading normal after bump and normal
/// mapping.
#include "geometry/surface/surface.h"
#include "materials/closures/closure.h"
#include "materials/hair_color.h"
#include "materials/lane_features.h"
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

    /// Features of the material of each lane.
    LaneFeatures features(UInt material, Mask m) const
    {
        return {gather(t_.materials, &MaterialRecord::features, &MaterialFeatures::bits, material, m)};
    }

    /// Index into ShadingTables::layers. The lanes of m must have a layered closure.
    UInt layers(UInt material, Mask m) const
    {
        const auto* base = reinterpret_cast<const std::uint32_t*>(t_.materials.data());
        const std::size_t word =
            detail::word_of(&MaterialRecord::parameters) + detail::word_of(&PrincipledRecord::table);
        return gather(base + word, material * UInt(detail::record_words<MaterialRecord>), m);
    }

    /// Emitted radiance of surfaces, or the radiance that unlit materials show.
    Spectrum emission(const Surface& s, LaneFeatures features, Mask m) const
    {
        Spectrum e = get(&MaterialRecord::emission, s.material, m);
        // Vertex colors multiply the base color, and therefore the radiance of unlit materials.
        const Mask colored = m & features.has_all(MaterialFeature::unlit | MaterialFeature::vertex_colored);
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
        const MaterialRow row(t_.materials, s.material, m);
        for (std::size_t c = 0; c < channels; ++c)
            p.base_color.c[c] = row.word[detail::word_of(&MaterialRecord::base_color) + c];
        const LaneFeatures features{row.get(&MaterialRecord::features, &MaterialFeatures::bits)};
        p.thin = features.has(MaterialFeature::thin);
        if (scene_.has(Feature::bump_maps)) {
            const Mask bumped = m & features.has(MaterialFeature::bumped);
            if (any(bumped)) apply_bump_map(t_, bumped, s);
        }
        const Mask colored = m & features.has(MaterialFeature::vertex_colored);
        for (int c = 0; c < channels && any(colored); ++c)
            p.base_color.c[c] = select(colored, p.base_color.c[c] * s.at.vertex_color[c], p.base_color.c[c]);
        const Mask textured = m & features.has(MaterialFeature::textured);
        if (any(textured)) apply_base_texture(s, row.get(&MaterialRecord::base_texture), textured, p);
        if constexpr (requires { typename Point::Record; })
            p.read(ParameterReader<typename Point::Record>(t_, row, s.at, s.material, m, textured));
        const Mask absorbing = m & features.has(MaterialFeature::absorbing_fiber);
        if (any(absorbing))
            apply_absorption(ParameterReader<HairRecord>(t_, row, s.at, s.material, absorbing, textured & absorbing),
                             absorbing, p);
        if (scene_.has(Feature::map_tangents)) {
            const Mask own = m & features.has(MaterialFeature::map_tangents) & !s.has_mesh_tangent;
            if (any(own)) use_map_tangents(row.get(&MaterialRecord::normal_texture), own, s);
        }
        if constexpr (std::is_same_v<Point, LayeredMaterialPoint>)
            LayersReader(t_, s, parameter(row, &PrincipledRecord::table), m).read(p.layers);
        if constexpr (std::is_same_v<Point, DisneyMaterialPoint>)
            read_disney(t_, s, parameter(row, &PrincipledRecord::table), m, p.disney);
        if constexpr (std::is_same_v<Point, MeasuredMaterialPoint>)
            read_measured(t_, s, parameter(row, &MeasuredSurfaceRecord::table), m, p.measured);
        const Mask bent = m & features.has(MaterialFeature::normal_mapped);
        if (any(bent)) {
            const UInt texture = row.get(&MaterialRecord::normal_texture);
            const Float scale = row.get(&MaterialRecord::normal_scale);
            s.ns = TangentFrame::of_map(t_, s, texture, bent)
                       .bend(evaluate_textures(t_, texture, s.at, bent), scale, bent);
        }
    }

private:
    /// Replaces the mesh's tangents by those of the normal map, which also apply to parameters without a map, such as
    /// anisotropy.
    [[gnu::noinline]] void use_map_tangents(UInt normal_texture, Mask own, Surface& s) const
    {
        s.has_map_tangents = own;
        const Mask mapped = own & (normal_texture != UInt(no_index));
        const TangentFrame frame = TangentFrame::of_map(t_, s, normal_texture, mapped);
        s.tangent = select(mapped, frame.tangent, s.tangent);
        const Float side = dot(cross(s.ns, frame.tangent), frame.bitangent);
        s.bitangent_sign = select(mapped, copysign(Float(1), side), s.bitangent_sign);
    }
    /// Sets the base color of fibers whose materials give an absorption instead.
    static void apply_absorption(const ParameterReader<HairRecord>& hair, Mask m, MaterialPoint& p)
    {
        const Float beta_n = hair.number(&HairRecord::beta_n, &HairRecord::beta_n_texture);
        p.base_color = select(m, hair_color(p.base_color, beta_n), p.base_color);
    }
    void apply_base_texture(const Surface& s, UInt base_texture, Mask m, MaterialPoint& p) const
    {
        const Texel base = evaluate_textures(t_, base_texture, s.at, m);
        for (int c = 0; c < channels; ++c)
            p.base_color.c[c] = select(m, p.base_color.c[c] * base.c[c], p.base_color.c[c]);
    }
    template <class Record>
    static UInt parameter(const MaterialRow& row, std::uint32_t Record::* member)
    {
        return float_bits(row.word[detail::word_of(&MaterialRecord::parameters) + detail::word_of(member)]);
    }

    const LaneScene& scene_;
    const SceneTables& t_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
