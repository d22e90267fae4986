// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Fixture for texture nodes: a graph of records that is evaluated at one point.
#include <gtest/gtest.h>

#include "support/lane_helpers.h"
#include "textures/textures.h"

namespace fathom::test {

struct TextureFixture {
    ShadingTables tables;

    std::uint32_t add(TextureRecord record)
    {
        tables.textures.push_back(record);
        return std::uint32_t(tables.textures.size() - 1);
    }
    /// Adds a constant color.
    std::uint32_t add_color(float r, float g, float b, float a = 1)
    {
        TextureRecord t = of(TextureKind::scale);
        t.color_a = {r, g, b, a};
        return add(t);
    }
    static TextureRecord of(TextureKind kind)
    {
        TextureRecord t;
        t.kind = std::uint32_t(kind);
        t.color_b = {1, 1, 1, 1};
        t.color_a = {0, 0, 0, 1};
        return t;
    }
    std::array<float, 4> at(std::uint32_t texture, float u = 0, float v = 0) const
    {
        return at_place(texture, {double(u), double(v), 0}, u, v);
    }
    std::array<float, 4> at_place(std::uint32_t texture, Vec3d p, float u = 0, float v = 0) const
    {
        TexturePoint point;
        for (int set = 0; set < 2; ++set) point.u[set] = Float(u), point.v[set] = Float(v);
        point.p_world = Vec3(to_float(p));
        point.n_world = Vec3(Float(0), Float(0), Float(1));
        for (int c = 0; c < 4; ++c) point.vertex_color[c] = Float(0.125f * float(c + 1));
        const Texel t = evaluate_textures(tables, UInt(texture), point, Mask(true));
        return {first(t.c[0]), first(t.c[1]), first(t.c[2]), first(t.c[3])};
    }
};

using Rgba = std::array<float, 4>;

}  // namespace fathom::test
