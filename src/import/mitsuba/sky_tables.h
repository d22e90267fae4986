#pragma once
#include <algorithm>
#include <cstddef>
#include <iterator>

#include "fathom/vector.h"

namespace fathom::mitsuba {

/// Of Mitsuba 3.9.1's `sunsky`, by turbidity from 1 to 10 and these heights of the sun above the horizon.
inline constexpr double sky_elevations_deg[] = {1, 4, 10, 20, 30, 40, 50, 60, 75, 90};
using SkyTable = float[10][10][3];

/// What its sun gives a surface that faces it, whatever its size.
inline constexpr SkyTable sun_irradiance = {
    {{0.4837f, 0.1378f, 0.f},
     {0.7261f, 0.3043f, 0.03191f},
     {1.147f, 0.7044f, 0.249f},
     {1.376f, 1.02f, 0.5783f},
     {1.46f, 1.154f, 0.7666f},
     {1.503f, 1.226f, 0.8796f},
     {1.528f, 1.269f, 0.9507f},
     {1.543f, 1.295f, 0.9962f},
     {1.555f, 1.317f, 1.034f},
     {1.558f, 1.323f, 1.045f}},
    {{0.3836f, 0.1071f, 0.f},
     {0.6365f, 0.2661f, 0.02892f},
     {1.087f, 0.664f, 0.2357f},
     {1.339f, 0.9898f, 0.562f},
     {1.433f, 1.131f, 0.7517f},
     {1.481f, 1.207f, 0.8662f},
     {1.509f, 1.252f, 0.9388f},
     {1.526f, 1.28f, 0.9849f},
     {1.54f, 1.303f, 1.023f},
     {1.544f, 1.309f, 1.035f}},
    {{0.2617f, 0.07069f, 0.f},
     {0.515f, 0.2143f, 0.02443f},
     {0.9933f, 0.6024f, 0.2153f},
     {1.28f, 0.942f, 0.5362f},
     {1.389f, 1.093f, 0.7277f},
     {1.446f, 1.175f, 0.8447f},
     {1.479f, 1.225f, 0.9192f},
     {1.499f, 1.255f, 0.9667f},
     {1.515f, 1.28f, 1.006f},
     {1.52f, 1.287f, 1.018f}},
    {{0.1394f, 0.0356f, 0.f},
     {0.3681f, 0.1516f, 0.01846f},
     {0.8572f, 0.5133f, 0.1853f},
     {1.188f, 0.8679f, 0.496f},
     {1.321f, 1.033f, 0.6899f},
     {1.39f, 1.125f, 0.8104f},
     {1.431f, 1.181f, 0.8877f},
     {1.456f, 1.215f, 0.9374f},
     {1.476f, 1.243f, 0.9791f},
     {1.482f, 1.252f, 0.9915f}},
    {{0.06945f, 0.01662f, 0.f},
     {0.2591f, 0.1052f, 0.01355f},
     {0.7314f, 0.432f, 0.1577f},
     {1.097f, 0.7945f, 0.456f},
     {1.25f, 0.9725f, 0.6514f},
     {1.332f, 1.073f, 0.775f},
     {1.381f, 1.135f, 0.855f},
     {1.411f, 1.173f, 0.9068f},
     {1.435f, 1.205f, 0.9503f},
     {1.442f, 1.214f, 0.9635f}},
    {{0.04001f, 0.009117f, 0.f},
     {0.2012f, 0.08082f, 0.01077f},
     {0.6524f, 0.3816f, 0.1404f},
     {1.035f, 0.7456f, 0.4293f},
     {1.202f, 0.9311f, 0.6251f},
     {1.292f, 1.038f, 0.7504f},
     {1.346f, 1.103f, 0.8324f},
     {1.379f, 1.144f, 0.8854f},
     {1.406f, 1.178f, 0.9301f},
     {1.414f, 1.188f, 0.9437f}},
    {{0.01615f, 0.003385f, 0.f},
     {0.1345f, 0.05277f, 0.007341f},
     {0.5405f, 0.3111f, 0.1159f},
     {0.9412f, 0.6712f, 0.3884f},
     {1.126f, 0.8665f, 0.5838f},
     {1.228f, 0.9811f, 0.7117f},
     {1.29f, 1.053f, 0.7962f},
     {1.328f, 1.098f, 0.8513f},
     {1.359f, 1.135f, 0.8978f},
     {1.369f, 1.146f, 0.9122f}},
    {{0.003657f, 0.000667f, 0.f},
     {0.07078f, 0.02651f, 0.003867f},
     {0.397f, 0.2225f, 0.08474f},
     {0.8044f, 0.5645f, 0.3296f},
     {1.011f, 0.7696f, 0.5217f},
     {1.13f, 0.8948f, 0.652f},
     {1.203f, 0.9743f, 0.7397f},
     {1.248f, 1.025f, 0.7977f},
     {1.286f, 1.067f, 0.8472f},
     {1.297f, 1.08f, 0.8623f}},
    {{0.000324f, 4.726e-05f, 0.f},
     {0.02517f, 0.008641f, 0.001344f},
     {0.2394f, 0.1286f, 0.05061f},
     {0.6204f, 0.4244f, 0.2513f},
     {0.8467f, 0.6328f, 0.4333f},
     {0.9843f, 0.7685f, 0.5642f},
     {1.071f, 0.8576f, 0.6553f},
     {1.127f, 0.9156f, 0.7166f},
     {1.174f, 0.9646f, 0.7695f},
     {1.188f, 0.9797f, 0.786f}},
    {{6.19e-06f, 4.952e-07f, 0.f},
     {0.004654f, 0.001373f, 0.0002357f},
     {0.1051f, 0.05259f, 0.02184f},
     {0.4043f, 0.2649f, 0.1605f},
     {0.6318f, 0.4584f, 0.3191f},
     {0.7839f, 0.5978f, 0.4448f},
     {0.8855f, 0.6948f, 0.5368f},
     {0.9524f, 0.7599f, 0.6005f},
     {1.009f, 0.8161f, 0.6568f},
     {1.026f, 0.8336f, 0.6746f}},
};

inline Color look_up(const SkyTable& table, double turbidity, double elevation_deg)
{
    constexpr std::size_t last = std::size(sky_elevations_deg) - 1;
    const double t = std::clamp(turbidity - 1, 0.0, 9.0);
    const auto row = std::min<std::size_t>(std::size_t(t), 8);
    std::size_t i = 0;
    while (i + 1 < last && sky_elevations_deg[i + 1] < elevation_deg) ++i;
    const double begin = sky_elevations_deg[i], end = sky_elevations_deg[i + 1],
                 x = std::clamp((elevation_deg - begin) / (end - begin), 0.0, 1.0), y = t - double(row);
    const auto channel = [&](std::size_t c) {
        const auto at = [&](std::size_t r) { return (1 - x) * table[r][i][c] + x * table[r][i + 1][c]; };
        return float((1 - y) * at(row) + y * at(row + 1));
    };
    return {channel(0), channel(1), channel(2)};
}

}  // namespace fathom::mitsuba
