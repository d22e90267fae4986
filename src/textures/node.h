// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Base of all textures. A texture is a node of a graph: a class with
///     static constexpr TextureKind kind
///     static Texel evaluate(const TextureGraph&, const TextureRecord&, const TexturePoint&, Mask)
/// Evaluate handles one texture that all lanes share; the graph evaluates the node's inputs.
#include "fathom/description.h"
#include "materials/records.h"
#include "math/elementary.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Value of a texture: red, green, blue, alpha.
struct Texel {
    Float c[4];

    /// Luminance by the weights of Rec. 709.
    Float luminance() const { return fma(c[0], Float(0.2126f), fma(c[1], Float(0.7152f), c[2] * Float(0.0722f))); }
    /// Channel by index, which may differ between lanes: 0 red to 3 alpha, 4 luminance.
    Float channel(UInt i) const
    {
        const Float plain = select(i == UInt(0), c[0], select(i == UInt(1), c[1], select(i == UInt(2), c[2], c[3])));
        return select(i == UInt(std::uint32_t(luminance_channel)), luminance(), plain);
    }
    /// Channel by index, which is the same in all lanes.
    Float common_channel(std::uint32_t i) const { return i == std::uint32_t(luminance_channel) ? luminance() : c[i]; }
};

/// Point at which textures are evaluated.
struct TexturePoint {
    Float u[2], v[2];  ///< two uv sets
    Vec3 p_world;
    Vec3 n_world;           ///< unit geometric normal; 0 if textures are evaluated before the normal is known
    Float vertex_color[4];  ///< white if the mesh has no vertex colors
};

/// Evaluates textures and the inputs of nodes.
class TextureGraph {
public:
    explicit TextureGraph(const ShadingTables& tables) : tables(tables) {}

    /// Evaluates one texture, which all lanes share.
    Texel evaluate(const TextureRecord& t, const TexturePoint& at, Mask m) const;
    /// color_a of a node, times its texture.
    Texel color_a(const TextureRecord& t, const TexturePoint& at, Mask m) const
    {
        return color(t.color_a, t.texture_a, at, m);
    }
    /// color_b of a node, times its texture.
    Texel color_b(const TextureRecord& t, const TexturePoint& at, Mask m) const
    {
        return color(t.color_b, t.texture_b, at, m);
    }
    /// Factor of a node, times a channel of its texture.
    Float factor(const TextureRecord& t, const TexturePoint& at, Mask m) const
    {
        if (t.factor_texture == no_index) return Float(t.factor);
        return evaluate(tables.textures[t.factor_texture], at, m).common_channel(t.factor_channel) * Float(t.factor);
    }
    /// Linear interpolation from color_a (amount 0) to color_b (1).
    Texel mix(const TextureRecord& t, Float amount, const TexturePoint& at, Mask m) const
    {
        Texel r;
        if (t.texture_a == no_index && t.texture_b == no_index) {
            for (std::size_t c = 0; c < 4; ++c)
                r.c[c] = fma(amount, Float(t.color_b[c] - t.color_a[c]), Float(t.color_a[c]));
            return r;
        }
        const Texel a = color_a(t, at, m), b = color_b(t, at, m);
        for (int c = 0; c < 4; ++c) r.c[c] = fma(amount, b.c[c] - a.c[c], a.c[c]);
        return r;
    }

    const ShadingTables& tables;

private:
    Texel color(const std::array<float, 4>& value, std::uint32_t texture, const TexturePoint& at, Mask m) const
    {
        Texel r;
        for (std::size_t c = 0; c < 4; ++c) r.c[c] = Float(value[c]);
        if (texture == no_index) return r;
        const Texel t = evaluate(tables.textures[texture], at, m);
        for (int c = 0; c < 4; ++c) r.c[c] = r.c[c] * t.c[c];
        return r;
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
