#pragma once
/// What the material at a surface is like: its parameters with textures applied, and the shading normal bent.
#include "integrate/stages/surface.h"
#include "shading/closures/closure.h"

namespace fathom::inline FATHOM_LANES {

class MaterialReader {
public:
    explicit MaterialReader(const LaneScene& scene) : scene_(scene), t_(scene.tables) {}

    const SceneTables& tables() const { return t_; }

    /// A member of the record of each lane's material.
    template <class Member>
    auto get(Member MaterialRecord::* member, UInt material, Mask m) const
    {
        return gather(t_.materials, member, material, m);
    }

    Spectrum emission(const Surface& s, UInt material, Mask m) const
    {
        Spectrum e = get(&MaterialRecord::emission, material, m);
        if (!scene_.textured) return e;
        const UInt texture = get(&MaterialRecord::emission_texture, material, m);
        const Texel t = evaluate_textures(t_, texture, s.at, m);
        for (int c = 0; c < channels; ++c) e.c[c] = e.c[c] * t.c[c];
        return e;
    }

    /// Parameters of the material, and the shading normal bent by its normal map.
    MaterialPoint read(Surface& s, UInt index, Mask entering, Mask m) const
    {
        MaterialPoint p;
        p.entering = entering;
        p.base_color = get(&MaterialRecord::base_color, index, m);
        p.roughness = get(&MaterialRecord::roughness, index, m);
        p.metallic = get(&MaterialRecord::metallic, index, m);
        p.ior = get(&MaterialRecord::ior, index, m);
        p.fuzz = get(&MaterialRecord::fuzz, index, m);
        const UInt flags = get(&MaterialRecord::flags, index, m);
        p.thin = (flags & UInt(MaterialRecord::thin)) != UInt(0);
        const Mask colored = m & ((flags & UInt(MaterialRecord::vertex_colored)) != UInt(0));
        for (int c = 0; c < channels && any(colored); ++c)
            p.base_color.c[c] = select(colored, p.base_color.c[c] * s.at.vertex_color[c], p.base_color.c[c]);
        const Mask textured = m & ((flags & UInt(MaterialRecord::textured)) != UInt(0));
        if (any(textured)) apply_textures(s, index, textured, p);
        const Mask bent = m & ((flags & UInt(MaterialRecord::normal_mapped)) != UInt(0));
        if (any(bent)) bend_normal(s, index, bent);
        return p;
    }

private:
    void apply_textures(const Surface& s, UInt index, Mask m, MaterialPoint& p) const
    {
        const Texel base = evaluate_textures(t_, get(&MaterialRecord::base_texture, index, m), s.at, m);
        for (int c = 0; c < channels; ++c)
            p.base_color.c[c] = select(m, p.base_color.c[c] * base.c[c], p.base_color.c[c]);
        using Word = std::uint32_t MaterialRecord::*;
        const auto scalar = [&](Word texture, Word channel, Float& value) {
            const UInt id = get(texture, index, m);
            const Mask has = m & (id != UInt(no_index));
            if (none(has)) return;
            const Texel t = evaluate_textures(t_, id, s.at, has);
            const UInt c = get(channel, index, m);
            const Float factor =
                select(c == UInt(0), t.c[0], select(c == UInt(1), t.c[1], select(c == UInt(2), t.c[2], t.c[3])));
            value = select(has, value * factor, value);
        };
        scalar(&MaterialRecord::roughness_texture, &MaterialRecord::roughness_channel, p.roughness);
        scalar(&MaterialRecord::metallic_texture, &MaterialRecord::metallic_channel, p.metallic);
    }

    void bend_normal(Surface& s, UInt index, Mask m) const
    {
        const Texel t = evaluate_textures(t_, get(&MaterialRecord::normal_texture, index, m), s.at, m);
        const Float scale = get(&MaterialRecord::normal_scale, index, m);
        const Float x = fma(t.c[0], Float(2), Float(-1)) * scale, y = fma(t.c[1], Float(2), Float(-1)) * scale,
                    z = fma(t.c[2], Float(2), Float(-1));
        // Gram-Schmidt: the tangent may not be perpendicular to the interpolated normal.
        const Vec3 raw = s.tangent - s.ns * dot(s.tangent, s.ns);
        const Mask known = m & (dot(raw, raw) > Float(1e-20f));
        const Vec3 tangent = normalize(select(known, raw, Vec3(Float(1), Float(0), Float(0))));
        const Vec3 bitangent = cross(s.ns, tangent) * s.bitangent_sign;
        const Vec3 bent = fma(tangent, x, fma(bitangent, y, s.ns * z));
        const Mask use = known & (dot(bent, bent) > Float(1e-12f));
        s.ns = select(use, normalize(bent), s.ns);
    }

    const LaneScene& scene_;
    const SceneTables& t_;
};

}  // namespace fathom::inline FATHOM_LANES
