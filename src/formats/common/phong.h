// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "fathom/description.h"

namespace fathom {

/// The surface parameters of older formats: a diffuse color, a Phong highlight and an opacity.
struct Phong {
    Color diffuse{0.8f, 0.8f, 0.8f}, specular{0, 0, 0};
    float shininess = 0;  ///< Phong exponent
    float opacity = 1;
    float ior = 1.5f;
    bool refracts = false;  ///< transmitted light is refracted, as by glass
};

/// Converts Phong parameters to the nearest Fathom material; the caller sets textures and emission.
///
/// A Phong exponent n is about as wide as GGX with alpha = sqrt(2 / (n + 2)): Walter et al., "Microfacet Models for
/// Refraction through Rough Surfaces", 2007, section 5.2.
inline void set_phong(Material& m, const Phong& phong)
{
    const auto largest = [](Color c) { return std::max({c.r, c.g, c.b}); };
    const auto bounded = [](Color c) {
        return Color{std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
    };
    const float alpha = std::sqrt(2 / (std::max(phong.shininess, 0.0f) + 2));
    m.roughness = {std::sqrt(alpha), -1, 1};
    m.metallic = {0, -1, 2};
    m.ior = phong.ior >= 1 && phong.ior <= 100 ? phong.ior : 1.5f;
    m.base_color.value = bounded(phong.diffuse);
    if (phong.refracts) {
        m.kind = MaterialKind::glass;
        m.base_color.value = {1, 1, 1};
        // Glass without a highlight means smooth glass, not glass of maximal roughness.
        if (phong.shininess <= 0 || phong.shininess >= 200) m.roughness.value = 0;
        return;
    }
    if (largest(phong.specular) > 0.3f && largest(phong.diffuse) < 0.05f * largest(phong.specular)) {
        m.kind = MaterialKind::metal;
        m.base_color.value = bounded(phong.specular);
    } else if (largest(phong.specular) > 0 && phong.shininess > 0) {
        m.kind = MaterialKind::principled;
    } else {
        m.kind = MaterialKind::diffuse;
        m.roughness.value = 0;
    }
    m.opacity.alpha.value = std::clamp(phong.opacity, 0.0f, 1.0f);
    if (m.opacity.alpha.value < 1) m.opacity.mode = AlphaMode::blend;
}

}  // namespace fathom
