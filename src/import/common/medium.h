#pragma once
#include <algorithm>
#include <cmath>

#include "fathom/description.h"

namespace fathom {

/// Fills a solid with what absorbs and scatters so much in a unit of length.
inline void fill_solid(Material& solid, Color absorption, Color scattering, float mean_cosine)
{
    const double most = std::max({double(absorption.r) + scattering.r, double(absorption.g) + scattering.g,
                                  double(absorption.b) + scattering.b});
    if (!(most > 0)) return;
    // Over the distance in which the densest colour is halved, so that its colour is a number of moderate size.
    const double distance = 0.6931471805599453 / most;
    const auto left = [&](float a) { return float(std::exp(-double(a) * distance)); };
    const auto scattered = [&](float s) { return float(double(s) * distance); };
    solid.attenuation_distance = distance;
    solid.attenuation_color = {left(absorption.r), left(absorption.g), left(absorption.b)};
    solid.transmission_scatter = {scattered(scattering.r), scattered(scattering.g), scattered(scattering.b)};
    solid.transmission_scatter_anisotropy = mean_cosine;
}

}  // namespace fathom
