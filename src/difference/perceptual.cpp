// SPDX-License-Identifier: Apache-2.0
#include "difference/perceptual.h"

#include <cmath>

namespace fathom::perceptual {

namespace {

using Matrix = std::array<Triple, 3>;

/// CIE XYZ of linear sRGB, and its inverse.
constexpr Matrix xyz_from_linear{{{0.412386564f, 0.357591491f, 0.180450487f},
                                  {0.212636822f, 0.715182981f, 0.072180196f},
                                  {0.019330620f, 0.119197164f, 0.950372587f}}};
constexpr Matrix linear_from_xyz{{{3.241003233f, -1.537398969f, -0.498615882f},
                                  {-0.969224252f, 1.875929984f, 0.041554226f},
                                  {0.055639420f, -0.204011206f, 1.057148977f}}};
/// XYZ of white.
constexpr Triple white{0.950428545f, 1, 1.088900371f};

Triple multiply(const Matrix& m, const Triple& v)
{
    Triple result{};
    for (std::size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return result;
}

/// XYZ divided by that of white.
Triple relative_xyz(const Triple& rgb)
{
    const Triple xyz = multiply(xyz_from_linear, rgb);
    return {xyz[0] / white[0], xyz[1] / white[1], xyz[2] / white[2]};
}

/// The compression of CIELAB.
float lab_curve(float t)
{
    constexpr float delta = 6.0f / 29;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0f / 29;
}

float hyab(const Triple& a, const Triple& b)
{
    return std::abs(a[0] - b[0]) + std::sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

constexpr float color_exponent = 0.7f;  ///< q_c of the paper

}  // namespace

Triple ycxcz_from_linear(const Triple& rgb)
{
    const Triple t = relative_xyz(rgb);
    return {116 * t[1] - 16, 500 * (t[0] - t[1]), 200 * (t[1] - t[2])};
}

Triple linear_from_ycxcz(const Triple& ycxcz)
{
    const float y = (ycxcz[0] + 16) / 116;
    return multiply(linear_from_xyz, {(y + ycxcz[1] / 500) * white[0], y * white[1], (y - ycxcz[2] / 200) * white[2]});
}

float relative_luminance(const Triple& rgb)
{
    return xyz_from_linear[1][0] * rgb[0] + xyz_from_linear[1][1] * rgb[1] + xyz_from_linear[1][2] * rgb[2];
}

Triple hunt_lab(const Triple& rgb)
{
    const Triple t = relative_xyz(rgb);
    const float x = lab_curve(t[0]), y = lab_curve(t[1]), z = lab_curve(t[2]);
    const float lightness = 116 * y - 16;
    return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
}

float color_difference(const Triple& hunt_a, const Triple& hunt_b)
{
    constexpr float share = 0.4f, compressed = 0.95f;  // p_c and p_t of the paper
    static const float max = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), color_exponent);
    const float difference = std::pow(hyab(hunt_a, hunt_b), color_exponent), knee = share * max;
    if (difference < knee) return difference * compressed / knee;
    return compressed + (difference - knee) / (max - knee) * (1 - compressed);
}

}  // namespace fathom::perceptual
