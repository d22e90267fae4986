// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reading of the parameters of LayeredBsdf, with textures applied.
#include "kernel/tables.h"
#include "materials/closures/closure.h"
#include "materials/read/tangent_frame.h"
#include "textures/record_inputs.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Reads a LayersRecord of each lane into a LayersPoint. Parameters of features that no lane has are not read.
class LayersReader {
public:
    /// s: the surface, before its normal map is applied. index: index into ShadingTables::layers, for the lanes of m.
    LayersReader(const SceneTables& tables, const Surface& s, UInt index, Mask m)
        : t_(tables), s_(s), frame_(s), m_(m), inputs_(tables, tables.layers, s.at, index, m)
    {
        const UInt features = inputs_.get(&LayersRecord::features);
        for (std::uint32_t bit = 1; bit <= LayersRecord::textured; bit <<= 1)
            if (any(m & ((features & UInt(bit)) != UInt(0)))) features_ |= bit;
        inputs_.set_textured((features_ & LayersRecord::textured) != 0);
        compensated_ = (features & UInt(LayersRecord::energy_compensation)) != UInt(0);
        reciprocal_ = (features & UInt(LayersRecord::sheen_reciprocal)) != UInt(0);
        two_roughnesses_ = (features & UInt(LayersRecord::two_roughnesses)) != UInt(0);
        added_ = (features & UInt(LayersRecord::diffuse_transmission_added)) != UInt(0);
    }
    void read(LayersPoint& p) const
    {
        p.features = features_;
        p.compensation = select(compensated_, Float(1), Float(0));
        p.specular = inputs_.number(&LayersRecord::specular);
        p.specular_color = inputs_.color(&LayersRecord::specular_color);
        p.edge_color = inputs_.color(&LayersRecord::edge_color);
        if (p.has(LayersRecord::anisotropic)) read_anisotropy(p);
        if (p.has(LayersRecord::with_conductor)) {
            p.conductor_eta = inputs_.get(&LayersRecord::conductor_eta);
            p.conductor_k = inputs_.get(&LayersRecord::conductor_k);
        }
        if (p.has(LayersRecord::rough_diffuse)) p.diffuse_roughness = inputs_.number(&LayersRecord::diffuse_roughness);
        p.transmission = p.diffuse_transmission = p.dispersion = Float(0);
        p.transmission_color = p.diffuse_transmission_color = Spectrum(Float(0));
        if (p.has(LayersRecord::with_transmission)) {
            p.transmission = inputs_.number(&LayersRecord::transmission);
            p.transmission_color = inputs_.color(&LayersRecord::transmission_color);
        }
        if (p.has(LayersRecord::disperses)) p.dispersion = inputs_.get(&LayersRecord::dispersion);
        if (p.has(LayersRecord::with_diffuse_transmission)) {
            p.diffuse_transmission = inputs_.number(&LayersRecord::diffuse_transmission);
            p.diffuse_transmission_color = inputs_.color(&LayersRecord::diffuse_transmission_color);
            p.diffuse_transmission_added = added_;
        }
        if (p.has(LayersRecord::with_coat)) read_coat(p);
        if (p.has(LayersRecord::with_sheen)) {
            p.sheen_color = inputs_.color(&LayersRecord::sheen_color);
            p.sheen_roughness = inputs_.number(&LayersRecord::sheen_roughness);
            p.sheen_reciprocal = reciprocal_;
        }
        if (p.has(LayersRecord::with_subsurface)) {
            p.subsurface = inputs_.number(&LayersRecord::subsurface);
            p.subsurface_color = inputs_.color(&LayersRecord::subsurface_color);
            p.subsurface_radius = inputs_.color(&LayersRecord::subsurface_radius_scale) *
                                  inputs_.number(&LayersRecord::subsurface_radius);
        }
        if (p.has(LayersRecord::with_thin_film)) {
            p.thin_film = inputs_.number(&LayersRecord::thin_film);
            p.thin_film_thickness = inputs_.number(&LayersRecord::thin_film_thickness);
            p.thin_film_ior = inputs_.get(&LayersRecord::thin_film_ior);
        }
    }

private:
    /// The anisotropy direction of the texture is rotated by the material's anisotropy_rotation.
    void read_anisotropy(LayersPoint& p) const
    {
        p.anisotropy = inputs_.number(&LayersRecord::anisotropy);
        p.two_roughnesses = two_roughnesses_;
        const UInt texture = inputs_.get(&LayersRecord::anisotropy_texture);
        const Mask has = m_ & (texture != UInt(no_index));
        Float x(1), y(0);
        if (any(has)) {
            const Texel t = evaluate_textures(t_, texture, s_.at, has);
            x = select(has, fma(t.c[0], Float(2), Float(-1)), x), y = select(has, fma(t.c[1], Float(2), Float(-1)), y);
        }
        const TangentFrame frame = any(has & s_.has_map_tangents) ? TangentFrame::of_map(t_, s_, texture, has) : frame_;
        const Float cosine = inputs_.get(&LayersRecord::anisotropy_cos),
                    sine = inputs_.get(&LayersRecord::anisotropy_sin);
        const Float along = fma(x, cosine, -(y * sine)), across = fma(x, sine, y * cosine);
        p.tangent = fma(frame.tangent, along, frame.bitangent * across);
    }
    void read_coat(LayersPoint& p) const
    {
        p.coat = inputs_.number(&LayersRecord::coat);
        p.coat_roughness = inputs_.number(&LayersRecord::coat_roughness);
        p.coat_color = inputs_.color(&LayersRecord::coat_color);
        p.coat_f0 = inputs_.get(&LayersRecord::coat_f0);
        p.coat_inner = inputs_.get(&LayersRecord::coat_inner);
        p.coat_darkening = inputs_.get(&LayersRecord::coat_darkening);
        p.coat_normal = s_.ns;
        if (!p.has(LayersRecord::coat_normal_mapped)) return;
        const UInt texture = inputs_.get(&LayersRecord::coat_normal_texture);
        const Mask has = m_ & (texture != UInt(no_index));
        p.coat_normal =
            TangentFrame::of_map(t_, s_, texture, has)
                .bend(evaluate_textures(t_, texture, s_.at, has), inputs_.get(&LayersRecord::coat_normal_scale), has);
    }

    const SceneTables& t_;
    const Surface& s_;
    const TangentFrame frame_;
    const Mask m_;
    RecordInputs<LayersRecord> inputs_;
    std::uint32_t features_ = 0;
    Mask compensated_, reciprocal_, added_, two_roughnesses_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
