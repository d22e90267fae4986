#pragma once
#include <variant>

#include "fathom/description.h"

namespace fathom {

/// Whether a material can displace it: curves, points, and spheres that move of themselves it can't.
inline bool can_be_displaced(const Shape& shape)
{
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) return !sphere->center_end;
    return !std::holds_alternative<CurvesInstance>(shape.geometry) &&
           !std::holds_alternative<PointsInstance>(shape.geometry);
}

/// Between which heights a material moves surfaces, if its texture has values from 0 to 1: pictures of 8 and 16 bits
/// have.
struct HeightRange {
    double least = 0, most = 0;

    HeightRange() = default;
    explicit HeightRange(const Material& m)
    {
        const double factor = double(m.displacement.value), middle = double(m.displacement_midlevel);
        const double white = factor * (1 - middle), black = m.displacement.texture < 0 ? white : factor * -middle;
        least = white < black ? white : black;
        most = white < black ? black : white;
    }
    bool moves() const { return least != 0 || most != 0; }
};

}  // namespace fathom
