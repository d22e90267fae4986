// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "fathom/image.h"
#include "fathom/vector.h"

namespace fathom {

/// Encodes linear light in [0, 1] as sRGB in [0, 1]: IEC 61966-2-1.
double srgb_from_linear(double linear);
/// Inverse of srgb_from_linear().
double linear_from_srgb(double encoded);

/// The display transform of single colors. NaN and negative values count as 0.
class DisplayMap {
public:
    explicit DisplayMap(const DisplayTransform& display);

    /// Nearest display codes of linear radiance, or OpenColorIO's display values if it is used.
    std::array<unsigned char, 3> codes8(const Color& radiance) const;
    std::array<std::uint16_t, 3> codes16(const Color& radiance) const;

private:
    Color exposed(const Color& radiance) const;
    Color display_value(const Color& radiance) const;

    float scale_;
    std::optional<std::array<std::array<float, 3>, 3>> balance_;
    Tonemap tonemap_;
    std::shared_ptr<const OcioView> ocio_;
};

/// Nearest code of a value in [0, 1] that is stored linearly, such as alpha.
unsigned char unit8(float value);
std::uint16_t unit16(float value);

}  // namespace fathom
