#pragma once
#include <algorithm>
#include <cmath>
#include <string>

#include "fathom/description.h"

namespace fathom {

/// The boundary of a solid at which nothing happens but that a medium begins.
inline Material open_boundary()
{
    Material m;
    m.kind = MaterialKind::glass;
    m.base_color = {{1, 1, 1}, -1};
    m.roughness = {0, -1, 0};
    m.ior = 1;
    return m;
}

/// Fills a solid with what absorbs and scatters so much in a unit of length.
inline void fill_solid(Material& solid, Color absorption, Color scattering, float mean_cosine)
{
    const double most = std::max({double(absorption.r) + scattering.r, double(absorption.g) + scattering.g,
                                  double(absorption.b) + scattering.b});
    if (!(most > 0)) return;
    // Over the distance in which the densest colour is halved, so that its colour is a number of moderate size.
    const double distance = 0.6931471805599453 / most;
    // Of the straight way both are taken.
    const auto left = [&](float a, float s) { return float(std::exp(-(double(a) + double(s)) * distance)); };
    const auto scattered = [&](float s) { return float(double(s) * distance); };
    solid.attenuation_distance = distance;
    solid.attenuation_color = {left(absorption.r, scattering.r), left(absorption.g, scattering.g),
                               left(absorption.b, scattering.b)};
    solid.transmission_scatter = {scattered(scattering.r), scattered(scattering.g), scattered(scattering.b)};
    solid.transmission_scatter_anisotropy = mean_cosine;
}

/// Puts a ball of a medium, which is a solid of it, around all shapes and cameras: what is in nothing else is in it. It
/// has twice the radius of what it surrounds. Returns what is to be said of that; empty: nothing.
std::string surround(SceneDescription& scene, Material medium);

}  // namespace fathom
