#pragma once
#include <cstdint>
#include <vector>

#include "fathom/image.h"

namespace fathom {

/// Encoded value, 0 to 1, of linear light, 0 to 1: IEC 61966-2-1.
double srgb_from_linear(double linear);
double linear_from_srgb(double encoded);

/// Narkowicz's fit of the ACES curve: 0 to 0, 1 to 0.80, infinity to 1.
/// K. Narkowicz: ACES Filmic Tone Mapping Curve, 2016.
float filmic_curve(float x);

/// The display transform, value by value.
class DisplayMap {
public:
    explicit DisplayMap(const DisplayTransform& display);

    /// Nearest 8-bit code of linear radiance; NaN and what is negative give 0.
    unsigned char code8(float radiance) const;
    std::uint16_t code16(float radiance) const;

private:
    float display_linear(float radiance) const;

    float scale_;
    bool filmic_;
};

/// Nearest code of a value of 0 to 1 that is not light: alpha.
unsigned char unit8(float value);
std::uint16_t unit16(float value);

}  // namespace fathom
