// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "fathom/vector.h"

namespace fathom {

/// Range of color temperatures for white balance, in kelvin.
inline constexpr double min_white_kelvin = 1000, max_white_kelvin = 25000;

/// Render settings that a scene file may contain; empty members are not given. Scene::compile and RenderJob ignore
/// them: programs apply them, and options of the command line override them.
struct RenderHints {
    /// Size of the image in pixels, samples per pixel, and the settings of the same names in RenderSettings.
    std::optional<int> width, height, samples, max_depth, roulette_depth;
    std::optional<std::string> filter;    ///< Pixel filter: box, gaussian, blackman-harris or tent.
    std::optional<double> filter_radius;  ///< Radius of the filter in pixels.
    std::optional<bool> light_sampling;   ///< Next event estimation.
    std::optional<double> exposure;       ///< Exposure in stops.
    std::optional<double> white_balance;  ///< Color temperature in kelvin that is shown as white.
    std::optional<Color> background;      ///< Radiance that the camera sees instead of the environment.
    bool own_light = false;               ///< The file's light is intended as it is: compile_lit() adds none.
    std::optional<std::string> tonemap;   ///< Name of a tone curve, see tonemap_names.
    std::optional<std::string> build;     ///< Quality of the BVH: fast, standard, high or compact, see BvhQuality.
};

}  // namespace fathom
