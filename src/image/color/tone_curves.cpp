// SPDX-License-Identifier: Apache-2.0
#include "image/color/tone_curves.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

using Matrix = float[3][3];

Color operator*(const Matrix& m, const Color& c)
{
    const auto row = [&](int i) { return m[i][0] * c.r + m[i][1] * c.g + m[i][2] * c.b; };
    return {row(0), row(1), row(2)};
}

template <class F>
Color each(const Color& c, F f)
{
    return {f(c.r), f(c.g), f(c.b)};
}

Color clamp_unit(const Color& c)
{
    return each(c, [](float x) { return std::clamp(x, 0.0f, 1.0f); });
}

/// S. Hill's fit of the reference rendering and output transforms of ACES (BakingLab, ACES.hlsl). Exposure is raised by
/// 1 / 0.6, as in glTF viewers, which keeps middle gray in place.
Color aces(const Color& radiance)
{
    constexpr Matrix ap1_from_rec709 = {
        {0.59719f, 0.35458f, 0.04823f}, {0.07600f, 0.90834f, 0.01566f}, {0.02840f, 0.13383f, 0.83777f}};
    constexpr Matrix rec709_from_ap1 = {
        {1.60475f, -0.53108f, -0.07367f}, {-0.10208f, 1.10813f, -0.00605f}, {-0.00327f, -0.07276f, 1.07602f}};
    const Color exposed = each(radiance, [](float x) { return x / 0.6f; });
    const auto curve = [](float x) {
        return (x * (x + 0.0245786f) - 0.000090537f) / (x * (0.983729f * x + 0.4329510f) + 0.238081f);
    };
    return clamp_unit(rec709_from_ap1 * each(ap1_from_rec709 * exposed, curve));
}

/// T. Sobotka's AgX in Rec.2020 primaries, as in Blender 4, Filament and three.js. The curve, from 10 stops below to
/// 6.5 above middle gray, is B. Wrensch's polynomial ("Minimal AgX Implementation", 2023).
Color agx(const Color& radiance)
{
    constexpr Matrix rec2020_from_rec709 = {
        {0.6274f, 0.3293f, 0.0433f}, {0.0691f, 0.9195f, 0.0113f}, {0.0164f, 0.0880f, 0.8956f}};
    constexpr Matrix rec709_from_rec2020 = {
        {1.6605f, -0.5876f, -0.0728f}, {-0.1246f, 1.1329f, -0.0083f}, {-0.0182f, -0.1006f, 1.1187f}};
    constexpr Matrix inset = {{0.856627153315983f, 0.0951212405381588f, 0.0482516061458583f},
                              {0.137318972929847f, 0.761241990602591f, 0.101439036467562f},
                              {0.11189821299995f, 0.0767994186031903f, 0.811302368396859f}};
    constexpr Matrix outset = {{1.1271005818144368f, -0.11060664309660323f, -0.016493938717834573f},
                               {-0.1413297634984383f, 1.157823702216272f, -0.016493938717834257f},
                               {-0.14132976349843826f, -0.11060664309660294f, 1.2519364065950405f}};
    constexpr float min_ev = -12.47393f, max_ev = 4.026069f;
    const auto curve = [](float light) {
        const float ev = std::log2(std::max(light, 1e-10f));
        const float x = std::clamp((ev - min_ev) / (max_ev - min_ev), 0.0f, 1.0f), x2 = x * x, x4 = x2 * x2;
        return 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x -
               0.00232f;
    };
    const Color encoded = outset * each(inset * (rec2020_from_rec709 * radiance), curve);
    const auto decode = [](float x) { return std::pow(std::max(x, 0.0f), 2.2f); };
    return clamp_unit(rec709_from_rec2020 * each(encoded, decode));
}

/// The PBR Neutral Tone Mapper of the Khronos Group (2024). It subtracts the 4 % that a dielectric reflects, so that a
/// base color up to 0.8 under white light is displayed unchanged. Brighter values are compressed toward white at
/// constant hue.
Color khronos_neutral(const Color& radiance)
{
    constexpr float reflection = 0.04f, start = 0.8f - reflection, desaturation = 0.15f, room = 1 - start;
    const float least = std::min({radiance.r, radiance.g, radiance.b});
    const float offset = least < 2 * reflection ? least - least * least / (4 * reflection) : reflection;
    const Color shifted = each(radiance, [&](float x) { return x - offset; });
    const float peak = std::max({shifted.r, shifted.g, shifted.b});
    if (peak < start) return shifted;
    const float compressed = 1 - room * room / (peak + room - start);
    const float white = 1 - 1 / (desaturation * (peak - compressed) + 1);
    return each(shifted, [&](float x) { return std::lerp(x * compressed / peak, compressed, white); });
}

}  // namespace

float filmic_curve(float x)
{
    return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

Color tone_map(Tonemap tonemap, const Color& radiance)
{
    switch (tonemap) {
        case Tonemap::srgb:
            return clamp_unit(radiance);
        case Tonemap::filmic:
            return clamp_unit(each(radiance, filmic_curve));
        case Tonemap::agx:
            return agx(radiance);
        case Tonemap::khronos_neutral:
            return clamp_unit(khronos_neutral(radiance));
        case Tonemap::aces:
            return aces(radiance);
    }
    return radiance;
}

}  // namespace fathom
