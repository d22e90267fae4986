// SPDX-License-Identifier: Apache-2.0
#include "image/color/primaries.h"

#include <algorithm>
#include <cmath>

#include "fathom/error.h"

namespace fathom {

namespace {

using Column = std::array<double, 3>;

ColorMatrix multiply(const ColorMatrix& a, const ColorMatrix& b)
{
    ColorMatrix product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) product[i][j] += a[i][k] * b[k][j];
    return product;
}

Column multiply(const ColorMatrix& a, const Column& v)
{
    Column product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) product[i] += a[i][k] * v[k];
    return product;
}

ColorMatrix inverse(const ColorMatrix& m)
{
    ColorMatrix cofactors;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            cofactors[j][i] = m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3] -
                              m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3];
    const double determinant = m[0][0] * cofactors[0][0] + m[0][1] * cofactors[1][0] + m[0][2] * cofactors[2][0];
    if (!(std::abs(determinant) > 1e-9)) throw Error("", "chromaticities", "these primaries don't span a color space");
    for (auto& row : cofactors)
        for (double& c : row) c /= determinant;
    return cofactors;
}

/// XYZ of a chromaticity at luminance 1.
Column xyz(Vec2f at)
{
    if (!(at.y > 0)) throw Error("", "chromaticities", "a white point or primary has a y of 0");
    return {double(at.x) / double(at.y), 1, (1 - double(at.x) - double(at.y)) / double(at.y)};
}

/// Matrix from RGB to XYZ, with primaries scaled so that their sum is the white of luminance 1: SMPTE RP 177.
ColorMatrix xyz_from_rgb(const Chromaticities& c)
{
    ColorMatrix m{};
    const Vec2f primaries[] = {c.red, c.green, c.blue};
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = double(primaries[i].x), y = double(primaries[i].y);
        m[0][i] = x, m[1][i] = y, m[2][i] = 1 - x - y;
    }
    const Column scale = multiply(inverse(m), xyz(c.white));
    for (auto& row : m)
        for (std::size_t i = 0; i < 3; ++i) row[i] *= scale[i];
    return m;
}

/// Bradford's cone response matrix: K. M. Lam, "Metamerism and colour constancy", 1985; ICC.1:2022, annex E.
constexpr ColorMatrix bradford{{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

ColorMatrix adaptation(Vec2f from_white, Vec2f to_white)
{
    const Column from = multiply(bradford, xyz(from_white)), to = multiply(bradford, xyz(to_white));
    ColorMatrix scaled = bradford;
    for (std::size_t i = 0; i < 3; ++i)
        for (double& c : scaled[i]) c *= to[i] / from[i];
    return multiply(inverse(bradford), scaled);
}

}  // namespace

Chromaticities chromaticities_of(Primaries primaries)
{
    return primaries == Primaries::acescg ? acescg_chromaticities : rec709_chromaticities;
}

bool is_same(const Chromaticities& a, const Chromaticities& b)
{
    const auto near = [](Vec2f p, Vec2f q) { return std::abs(p.x - q.x) < 1e-4f && std::abs(p.y - q.y) < 1e-4f; };
    return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) && near(a.white, b.white);
}

ColorMatrix conversion(const Chromaticities& from, const Chromaticities& to)
{
    return multiply(inverse(xyz_from_rgb(to)), multiply(adaptation(from.white, to.white), xyz_from_rgb(from)));
}

Vec2f white_chromaticity(double kelvin)
{
    const double t = kelvin;
    if (t < 4000) {
        // The Planckian locus in u, v of CIE 1960 is approximated to 1e-4: M. Krystek, "An algorithm to calculate
        // correlated colour temperature", 1985.
        const double u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) /
                         (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t),
                     v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) /
                         (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t);
        const double whole = 2 * u - 8 * v + 4;
        return {float(3 * u / whole), float(2 * v / whole)};
    }
    const double m = 1000 / t, x = t <= 7000 ? 0.244063 + m * (0.09911 + m * (2.9678 - m * 4.6070))
                                             : 0.237040 + m * (0.24748 + m * (1.9018 - m * 2.0064));
    return {float(x), float(-3 * x * x + 2.870 * x - 0.275)};
}

ColorMatrix white_balance(double kelvin)
{
    const ColorMatrix xyz = xyz_from_rgb(rec709_chromaticities);
    return multiply(inverse(xyz), multiply(adaptation(white_chromaticity(kelvin), rec709_chromaticities.white), xyz));
}

void convert(Image::Layer& layer, const ColorMatrix& matrix)
{
    std::array<std::size_t, 3> places;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto found = std::find(layer.channels.begin(), layer.channels.end(), std::string(1, "RGB"[i]));
        if (found == layer.channels.end()) return;
        places[i] = std::size_t(found - layer.channels.begin());
    }
    for (std::size_t at = 0; at < layer.pixels.size(); at += layer.channels.size()) {
        float* pixel = &layer.pixels[at];
        const Column color{double(pixel[places[0]]), double(pixel[places[1]]), double(pixel[places[2]])};
        if (!std::isfinite(color[0] + color[1] + color[2])) continue;
        const Column converted = multiply(matrix, color);
        for (std::size_t i = 0; i < 3; ++i) pixel[places[i]] = float(converted[i]);
    }
}

}  // namespace fathom
