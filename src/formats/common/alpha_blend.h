// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom {

/// Whether the material is a fully transparent interface that rays pass without any effect.
inline bool is_null_interface(const Material& m)
{
    return m.kind == MaterialKind::none && m.opacity.alpha.value == 0;
}

/// Appends a texture and returns its index.
inline int add_texture(SceneDescription& scene, Texture texture)
{
    scene.textures.push_back(std::move(texture));
    return int(scene.textures.size()) - 1;
}

/// A mix texture that maps an input of 0 to the gray `at_zero` and an input of 1 to `at_one`.
inline int gray_texture(SceneDescription& scene, const FloatInput& input, float at_zero = 0, float at_one = 1)
{
    Texture gray;
    gray.kind = TextureKind::mix;
    gray.color_a = {{at_zero, at_zero, at_zero}, -1}, gray.color_b = {{at_one, at_one, at_one}, -1};
    gray.factor = input;
    return add_texture(scene, std::move(gray));
}

/// The product of two inputs; textures are multiplied by a scale texture.
inline FloatInput product(SceneDescription& scene, const FloatInput& a, const FloatInput& b)
{
    if (a.texture < 0 || b.texture < 0) {
        FloatInput result = a.texture >= 0 ? a : b;
        result.value = a.value * b.value;
        return result;
    }
    Texture both;
    both.kind = TextureKind::scale;
    both.color_a = {{1, 1, 1}, gray_texture(scene, a)}, both.color_b = {{1, 1, 1}, gray_texture(scene, b)};
    return {1, add_texture(scene, std::move(both)), 0};
}

/// Blends a material with full transparency by setting its alpha.
///
/// weight      fraction of the material
/// of_nothing  whether `weight` is the fraction of transparency instead of the material
inline Material blend_with_transparent(SceneDescription& scene, Material m, FloatInput weight, bool of_nothing)
{
    if (of_nothing && weight.texture < 0) weight.value = 1 - weight.value;
    if (of_nothing && weight.texture >= 0) weight = {1, gray_texture(scene, weight, 1, 0), 1};
    m.opacity.alpha = m.opacity.mode == AlphaMode::opaque ? weight : product(scene, m.opacity.alpha, weight);
    m.opacity.mode = AlphaMode::blend;
    return m;
}

}  // namespace fathom
