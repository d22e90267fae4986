// SPDX-License-Identifier: Apache-2.0
// Reading of colors, spectra and textures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/common/spectra.h"
#include "formats/io/read_file.h"
#include "formats/mitsuba/reader.h"

namespace fathom::mitsuba {

namespace {

Color three(const Element& element, const std::vector<double>& v)
{
    if (v.size() == 1) return {float(v[0]), float(v[0]), float(v[0])};
    if (v.size() != 3) element.fail(fmt::format("a color must have one number or three, found {}", v.size()));
    return {float(v[0]), float(v[1]), float(v[2])};
}

/// Decodes an sRGB value in [0, 1].
float linear_of(double c)
{
    return float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

/// A color "#rrggbb", as in files for earlier versions.
Color from_hex(const Element& element, const std::string& text)
{
    int v[3] = {};
    char rest = 0;
    if (text.size() != 7 ||
        std::sscanf(text.c_str(), "#%2x%2x%2x%c", reinterpret_cast<unsigned*>(&v[0]),
                    reinterpret_cast<unsigned*>(&v[1]), reinterpret_cast<unsigned*>(&v[2]), &rest) != 3)
        element.fail(fmt::format("expected #rrggbb, found '{}'", printable(text)));
    return {linear_of(v[0] / 255.0), linear_of(v[1] / 255.0), linear_of(v[2] / 255.0)};
}

/// A spectrum such as "400:0.1, 500:0.5", with ascending wavelengths.
std::vector<SpectrumPoint> points_of(const Element& element, std::string text)
{
    std::replace(text.begin(), text.end(), ':', ' ');
    const std::vector<double> v = numbers_of(element, text);
    if (v.size() % 2 != 0) element.fail("a spectrum must have pairs of wavelength and value");
    std::vector<SpectrumPoint> points;
    for (std::size_t i = 0; i < v.size(); i += 2) {
        if (!points.empty() && v[i] <= points.back().wavelength) element.fail("wavelengths must increase");
        points.push_back({v[i], v[i + 1]});
    }
    return points;
}

bool is_light(const Element& element)
{
    return element.name() == "radiance" || element.name() == "intensity" || element.name() == "irradiance";
}

/// Mitsuba converts a constant color to a number by its mean, but a texture by its luminance.
float mean_of(const Color& c)
{
    return (c.r + c.g + c.b) / 3;
}

Color limited(Color c)
{
    const auto limit = [](float x) { return std::clamp(x, 0.f, 1.f); };
    return {limit(c.r), limit(c.g), limit(c.b)};
}

}  // namespace

std::optional<Color> Reader::color_of(const Element& element)
{
    const std::string& value = element.attribute("value");
    if (element.tag == "float" || element.tag == "integer") return three(element, numbers_of(element, value));
    if (element.tag == "rgb" || element.tag == "srgb" || element.tag == "color") {
        if (value.starts_with('#')) return from_hex(element, value);
        const Color c = three(element, numbers_of(element, value));
        if (element.tag == "srgb") return Color{linear_of(double(c.r)), linear_of(double(c.g)), linear_of(double(c.b))};
        return c;
    }
    if (element.tag == "spectrum") return spectrum(element);
    return std::nullopt;
}

namespace {

/// Points of a `regular` spectrum, which has a range of wavelengths, or of an `irregular` one, which lists them.
std::vector<SpectrumPoint> sampled_points(Object& spectrum)
{
    const Element& element = spectrum.element();
    std::vector<double> wavelengths = numbers_of(element, spectrum.text("wavelengths", ""));
    const std::vector<double> values = numbers_of(element, spectrum.text("values", ""));
    if (spectrum.type() == "regular") {
        const double low = spectrum.number("wavelength_min", 360), high = spectrum.number("wavelength_max", 830);
        for (std::size_t i = 0; i < values.size(); ++i)
            wavelengths.push_back(low + (high - low) * double(i) / std::max(1.0, double(values.size()) - 1));
    }
    if (values.empty() || wavelengths.size() != values.size())
        element.fail("a spectrum must have as many values as wavelengths");
    std::vector<SpectrumPoint> points;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i > 0 && wavelengths[i] <= wavelengths[i - 1]) element.fail("wavelengths must increase");
        points.push_back({wavelengths[i], values[i]});
    }
    return points;
}

}  // namespace

Color Reader::spectrum(const Element& element)
{
    Object object(element, document_);
    const std::string& type = element.type();
    const auto of_points = [&](const std::vector<SpectrumPoint>& points) {
        return is_light(element) ? color_of_light(points) : color_in_daylight(points);
    };
    const auto uniform = [&](double value) { return of_points({{300, value}, {900, value}}); };
    if (type.empty() && element.has("filename")) {
        const std::filesystem::path file = document_.locate(element.attribute("filename"), context_);
        return of_points(points_of(element, context_.read(file)));
    }
    if (type.empty() && element.attribute("value").find(':') == std::string::npos) {
        const std::vector<double> v = numbers_of(element, element.attribute("value"));
        return v.size() == 1 ? uniform(v[0]) : three(element, v);
    }
    if (type.empty()) return of_points(points_of(element, element.attribute("value")));
    if (type == "uniform") return uniform(object.number("value", 1));
    if (type == "d65") {
        const float scale = float(object.number("scale", 1));
        return {scale, scale, scale};
    }
    if (type == "blackbody") {
        const Color c = color_of_black_body(object.number("temperature", 5000));
        const float scale = float(object.number("scale", 1));
        return {scale * c.r, scale * c.g, scale * c.b};
    }
    if (type == "regular" || type == "irregular") return of_points(sampled_points(object));
    if (type == "srgb" || type == "rgb") return plain_color(object, type == "srgb" ? "color" : "value", {1, 1, 1});
    report(element, "is not supported: 1 is used");
    return {1, 1, 1};
}

ColorInput Reader::color(Object& of, std::string_view name, Color otherwise)
{
    const Element* const found = of.child(name);
    if (!found) return {otherwise, -1};
    if (const auto c = color_of(*found)) return {is_light(*found) ? *c : limited(*c), -1};
    return {{1, 1, 1}, texture(*found, false)};
}

FloatInput Reader::number_or_texture(Object& of, std::string_view name, float otherwise)
{
    const Element* const found = of.child(name);
    if (!found) return {otherwise, -1, 0};
    if (const auto c = color_of(*found)) return {mean_of(*c), -1, 0};
    return {1, texture(*found, true), luminance_channel};
}

Color Reader::plain_color(Object& of, std::string_view name, Color otherwise)
{
    const Element* const found = of.child(name);
    if (!found) return otherwise;
    if (const auto c = color_of(*found)) return *c;
    report(*found, fmt::format("a texture as '{}' is not supported: gray 0.5 is used", name));
    return {0.5f, 0.5f, 0.5f};
}

int Reader::texture(const Element& element, bool data)
{
    auto& known = data ? data_textures_ : textures_;
    if (const auto found = known.find(&element); found != known.end()) return found->second;
    if (element.tag != "texture")
        element.fail(fmt::format("expected a color or a texture, found <{}>", printable(element.tag)));
    Object object(element, document_);
    int index = -1;
    if (object.type() == "bitmap") {
        index = bitmap(object);
    } else if (object.type() == "checkerboard") {
        index = checkerboard(object, data);
    } else if (object.type() == "mesh_attribute") {
        index = mesh_attribute(object);
    } else {
        report(element, "is not supported: gray 0.5 is used");
        Texture gray;
        gray.kind = TextureKind::mix;
        gray.color_a = gray.color_b = {{0.5f, 0.5f, 0.5f}, -1};
        index = int(scene_.textures.size());
        scene_.textures.push_back(gray);
        return known[&element] = index;
    }
    object.finish(context_.warnings);
    return known[&element] = index;
}

namespace {

/// Sets rotation, scale and offset of texture coordinates from a transform; false if it has shear.
bool set_uv_map(const Transform& t, Texture& texture)
{
    const double a = t.m[0][0], b = t.m[0][1], c = t.m[1][0], d = t.m[1][1];
    const double su = std::hypot(a, c), sv = (su > 0 ? (a * d - b * c) / su : d);
    if (std::abs(a * b + c * d) > 1e-6 * (su * std::hypot(b, d) + 1e-30)) return false;
    texture.uv_scale = {float(su), float(sv)};
    // KHR_texture_transform's rotation is clockwise: (cos, sin; -sin, cos).
    texture.uv_rotation = float(std::atan2(-c, a));
    texture.uv_offset = {float(t.m[0][3]), float(t.m[1][3])};
    if (t.m[0][2] != 0 || t.m[1][2] != 0)
        texture.uv_offset = {float(t.m[0][2] + t.m[0][3]), float(t.m[1][2] + t.m[1][3])};
    return true;
}

}  // namespace

int Reader::bitmap(Object& object)
{
    Texture result;
    const std::string filename = object.text("filename", "");
    if (filename.empty()) object.element().fail("a bitmap needs a 'filename'");
    const std::filesystem::path file = document_.locate(filename, context_);
    const auto [image, is_new] = images_.emplace(file.string(), int(scene_.images.size()));
    if (is_new) scene_.images.push_back({filename, file, {}});
    result.name = filename;
    result.image = image->second;
    // Images for numbers are decoded from sRGB too, unless `raw` is set.
    result.color_space = object.boolean("raw", false) ? ColorSpace::linear : ColorSpace::srgb;
    const std::string wrap = object.text("wrap_mode", "repeat"), filter = object.text("filter_type", "bilinear");
    result.wrap_u = result.wrap_v = wrap == "clamp" ? Wrap::clamp : wrap == "mirror" ? Wrap::mirror : Wrap::repeat;
    result.nearest = filter == "nearest";
    object.ignore({"format", "accel"});
    if (!set_uv_map(object.transform("to_uv"), result))
        report(object.element(), "a shear of texture coordinates is ignored");
    scene_.textures.push_back(result);
    return int(scene_.textures.size()) - 1;
}

int Reader::mesh_attribute(Object& object)
{
    const std::string name = object.text("name", "");
    if (!name.starts_with("vertex_") && !name.starts_with("face_"))
        object.element().fail(
            fmt::format("a mesh attribute must be 'vertex_...' or 'face_...', found '{}'", printable(name)));
    Texture attribute;
    attribute.kind = TextureKind::vertex_color;
    const int index = int(scene_.textures.size());
    scene_.textures.push_back(attribute);
    attributes_[index] = name;
    const float scale = float(object.number("scale", 1));
    return scale == 1 ? index : scaled_input({{1, 1, 1}, index}, scale).texture;
}

int Reader::checkerboard(Object& object, bool data)
{
    Texture result;
    result.kind = TextureKind::checker_uv;
    // Squares are half a unit of uv wide.
    result.scale = 2;
    // Numbers may exceed 1, reflectances must not.
    const auto value = [&](const char* name, Color otherwise) {
        const Element* const found = data ? object.child(name) : nullptr;
        const std::optional<Color> number = found ? color_of(*found) : std::nullopt;
        if (!number) return color(object, name, otherwise);
        const float mean = mean_of(*number);
        return ColorInput{{mean, mean, mean}, -1};
    };
    result.color_a = value("color0", {0.4f, 0.4f, 0.4f});
    result.color_b = value("color1", {0.2f, 0.2f, 0.2f});
    // Mitsuba 3.9.1 exchanges the two colors when it evaluates a number.
    if (data) std::swap(result.color_a, result.color_b);
    if (!set_uv_map(object.transform("to_uv"), result))
        report(object.element(), "a shear of texture coordinates is ignored");
    scene_.textures.push_back(result);
    return int(scene_.textures.size()) - 1;
}

}  // namespace fathom::mitsuba
