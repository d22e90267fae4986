// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <variant>

#include "fathom/description.h"

namespace fathom {

/// Whether a material can displace the shape: curves, points and spheres with a motion of their own can't be displaced.
inline bool can_be_displaced(const Shape& shape)
{
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) return !sphere->center_end;
    return !std::holds_alternative<CurvesInstance>(shape.geometry) &&
           !std::holds_alternative<PointsInstance>(shape.geometry);
}

/// Range of displacement along the normal in scene units, for a height texture with values in [0, 1] (as images of 8
/// and 16 bits have).
struct HeightRange {
    double least = 0, most = 0;

    HeightRange() = default;
    explicit HeightRange(const Material& m)
    {
        const double factor = double(m.displacement.height.value), middle = double(m.displacement.midlevel);
        const double white = factor * (1 - middle),
                     black = m.displacement.height.texture < 0 ? white : factor * -middle;
        least = white < black ? white : black;
        most = white < black ? black : white;
    }
    bool moves() const { return least != 0 || most != 0; }
};

}  // namespace fathom
