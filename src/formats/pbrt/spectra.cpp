// SPDX-License-Identifier: Apache-2.0
// Conversion of colors and spectra to linear Rec.709.
#include "formats/common/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fathom/error.h"
#include "formats/common/suggest.h"
#include "formats/io/read_file.h"
#include "formats/io/text_encoding.h"
#include "formats/io/text_scanner.h"
#include "formats/pbrt/named_spectra.h"
#include "formats/pbrt/reader.h"

namespace fathom::pbrt {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

constexpr Matrix rec709_from_xyz = {
    {{3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}}};
constexpr Matrix xyz_from_aces = {
    {{0.9525523959, 0, 0.0000936786}, {0.3439664498, 0.7281660966, -0.0721325464}, {0, 0, 1.0088251844}}};
constexpr Matrix rec709_from_rec2020 = {
    {{1.6604910, -0.5876411, -0.0728499}, {-0.1245505, 1.1328999, -0.0083494}, {-0.0181508, -0.1005789, 1.1187297}}};
constexpr Matrix rec709_from_p3 = {
    {{1.2249402, -0.2249402, 0}, {-0.0420570, 1.0420570, 0}, {-0.0196376, -0.0786361, 1.0982736}}};
/// Bradford-adapted matrix that maps white to white: reflectances of 1 are white under any illuminant.
constexpr Matrix rec709_from_aces_adapted = {
    {{2.5216, -1.1341, -0.3875}, {-0.2765, 1.3727, -0.0962}, {-0.0154, -0.1530, 1.1684}}};

Color apply(const Matrix& m, Color c)
{
    const auto row = [&](std::size_t i) { return float(m[i][0] * c.r + m[i][1] * c.g + m[i][2] * c.b); };
    return {row(0), row(1), row(2)};
}

Color from_space(Space space, Color c, bool of_light)
{
    switch (space) {
        case Space::srgb:
            return c;
        case Space::dci_p3:
            return apply(rec709_from_p3, c);
        case Space::rec2020:
            return apply(rec709_from_rec2020, c);
        case Space::aces2065:
            return of_light ? apply(rec709_from_xyz, apply(xyz_from_aces, c)) : apply(rec709_from_aces_adapted, c);
    }
    return c;
}

Color of_luminance_one(Color c)
{
    const double y = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
    if (!(y > 0)) return {0, 0, 0};
    return {float(c.r / y), float(c.g / y), float(c.b / y)};
}

Color of_chromaticity(double x, double y)
{
    return of_luminance_one(apply(rec709_from_xyz, {float(x / y), 1, float((1 - x - y) / y)}));
}

}  // namespace

std::vector<SpectrumPoint> spectrum_points(const Parameter& parameter, const std::vector<float>& numbers)
{
    if (numbers.size() < 2 || numbers.size() % 2 != 0)
        parameter.place.fail(
            fmt::format("the spectrum '{}' needs pairs of a wavelength and a value", printable(parameter.name)));
    std::vector<SpectrumPoint> points;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
        if (!points.empty() && !(numbers[i] > points.back().wavelength))
            parameter.place.fail(
                fmt::format("the wavelengths of the spectrum '{}' must increase", printable(parameter.name)));
        points.push_back({numbers[i], numbers[i + 1]});
    }
    return points;
}

std::vector<float> numbers_of_file(const std::string& file, const std::string& text)
{
    std::vector<float> numbers;
    TextScanner scan(file, utf8_text(file, text), 1, '#');
    for (; !scan.at_end(); scan.next_line())
        for (std::string_view word = scan.word(); !word.empty(); word = scan.word())
            numbers.push_back(scan.to_number(word));
    return numbers;
}

std::vector<float> Reader::spectrum_file(const Parameter& p)
{
    const std::filesystem::path file = locate(p.place, p.strings.at(0));
    try {
        return numbers_of_file(file.string(), context_.read(file));
    } catch (const Error& error) {
        p.place.fail(error.what());
    }
}

Color Reader::color_value(const Parameters& of, const Parameter& p, bool of_light)
{
    if (p.type == "rgb") {
        if (p.numbers.size() != 3) p.place.fail(fmt::format("'{}' must be three numbers", printable(p.name)));
        Color c = from_space(of.space(), {p.numbers[0], p.numbers[1], p.numbers[2]}, of_light);
        if (of.space() != Space::srgb)
            for (float* channel : {&c.r, &c.g, &c.b}) *channel = std::max(0.f, *channel);
        return c;
    }
    if (p.type == "blackbody") {
        if (p.numbers.size() != 1 || !(p.numbers[0] > 0)) p.place.fail("a blackbody must have a temperature above 0");
        return of_luminance_one(color_of_black_body(p.numbers[0]));
    }
    if (p.type == "float" && p.numbers.size() == 1) return {p.numbers[0], p.numbers[0], p.numbers[0]};
    if (p.type != "spectrum") p.place.fail(fmt::format("'{}' must be a color or a spectrum", printable(p.name)));
    std::vector<float> numbers = p.numbers;
    if (p.strings.size() == 1) {
        const std::string& name = p.strings[0];
        if (const NamedLight* light = find_light(name)) return of_chromaticity(light->x, light->y);
        if (is_named_spectrum(name)) {
            report(of, fmt::format("the spectrum '{}' is not a color: gray 0.5 is used", printable(name)));
            return {0.5f, 0.5f, 0.5f};
        }
        numbers = spectrum_file(p);
    }
    const std::vector<SpectrumPoint> points = spectrum_points(p, numbers);
    return of_light ? of_luminance_one(color_of_light(points)) : color_of_surface(points);
}

Color Reader::color_value(const Parameters& of, std::string_view name, Color otherwise, bool of_light)
{
    const Parameter* const p = of.find(name);
    return p ? color_value(of, *p, of_light) : otherwise;
}

Color Reader::light_color(const Parameters& of, std::string_view name)
{
    Color color = color_value(of, name, from_space(of.space(), {1, 1, 1}, true), true);
    const auto scale = float(of.number("scale", 1));
    for (float* channel : {&color.r, &color.g, &color.b}) *channel *= scale;
    return color;
}

ColorInput Reader::color(const Parameters& of, std::string_view name, Color otherwise)
{
    const Parameter* const p = of.find(name);
    if (!p) return {otherwise, -1};
    if (p->type == "texture") return limited(texture(of, name, false));
    Color c = color_value(of, *p, false);
    for (float* channel : {&c.r, &c.g, &c.b}) *channel = std::clamp(*channel, 0.f, 1.f);
    return {c, -1};
}

FloatInput Reader::number_or_texture(const Parameters& of, std::string_view name, float otherwise)
{
    const Parameter* const p = of.find(name);
    if (!p) return {otherwise, -1, 1};
    if (p->type != "texture") return {float(of.number(name, otherwise)), -1, 1};
    const ColorInput input = texture(of, name, true);
    return {input.value.g, input.texture, 1};
}

GlassIndex Reader::glass_index(const Parameters& of, std::string_view name, float otherwise)
{
    const Parameter* const p = of.find(name);
    if (!p) return {otherwise};
    GlassIndex glass{otherwise};
    if (p->type == "spectrum" && p->strings.size() == 1) {
        const std::optional<GlassIndex> named = find_glass(p->strings[0]);
        if (!named && is_named_spectrum(p->strings[0]))
            p->place.fail(fmt::format("the glass '{}' is unknown", printable(p->strings[0])));
        glass = named ? *named : glass_of(spectrum_points(*p, spectrum_file(*p)));
    } else if (p->type == "spectrum") {
        glass = glass_of(spectrum_points(*p, p->numbers));
    } else if (p->type == "rgb") {
        report(of, fmt::format("an RGB '{}' gives no dispersion: its green value is used for all colors", name));
        glass.middle = color_value(of, *p, true).g;
    } else {
        glass.middle = of.number(name, otherwise);
    }
    if (!(glass.middle > 0) || !std::isfinite(glass.middle)) p->place.fail("an index of refraction must be above 0");
    return glass;
}

float Reader::ior(const Parameters& of, std::string_view name, float otherwise)
{
    const GlassIndex glass = glass_index(of, name, otherwise);
    if (glass.abbe > 0) report(of, fmt::format("'{}' is evaluated at 587.6 nm: only glass supports dispersion", name));
    return float(glass.middle);
}

}  // namespace fathom::pbrt
