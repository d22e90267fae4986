// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "fathom/description.h"

namespace fathom {

/// Raises a number or texture in [0, 1] to a power below 1, to convert other formats' roughness (alpha, or another
/// power of Fathom's roughness).
///
/// A texture is mapped by a piecewise linear curve: square roots are accurate to 0.9 % above 0.05 and to 1.8 % above
/// 0.01.
inline FloatInput raise_to_power(SceneDescription& scene, FloatInput input, double power)
{
    const auto raised = [&](double x) { return float(std::pow(std::clamp(x, 0.0, 1.0), power)); };
    if (input.texture < 0) {
        input.value = raised(input.value);
        return input;
    }
    Texture curve;
    curve.kind = TextureKind::ramp;
    curve.factor = input;
    constexpr int stops = 16;
    for (int i = 0; i < stops; ++i) {
        // Stops are denser near 0, where roots are steep.
        const double x = std::pow(double(i) / (stops - 1), 4);
        curve.stops.push_back({float(x), {raised(x), raised(x), raised(x)}});
    }
    scene.textures.push_back(curve);
    return {1, int(scene.textures.size()) - 1, 1};
}

}  // namespace fathom
