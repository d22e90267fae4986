// SPDX-License-Identifier: Apache-2.0
#include "lights/compile/light_pictures.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "compile/compiler.h"
#include "fathom/error.h"
#include "lights/ies/ies.h"
#include "math/luminance.h"
#include "scene/units.h"
#include "textures/compile/images.h"

namespace fathom {

namespace {

using std::numbers::pi;
/// Lanes index floats with 32 bits, which limits the number of texels.
constexpr std::size_t max_texels = std::size_t(1) << 29;
/// Limit of the tangent to which a spot's image is stretched; wide cones would need an infinite one.
constexpr double largest_tangent = 1e4;

/// Appends space for texels to the table; returns the index of the first.
std::uint32_t add_texels(Compiler& c, std::size_t texels, const std::string& name)
{
    const std::size_t first = c.tables.picture_texels.size() / 4;
    if (texels > max_texels - first) throw Error(name, "", "the images of lights have more than 2^29 pixels in all");
    c.tables.picture_texels.resize(4 * (first + texels));
    return std::uint32_t(first);
}

/// Smallest number of equal steps of `span` that contains each of the angles; `most` if there is none.
int steps_to_have(const std::vector<double>& angles, double from, double span, int most)
{
    for (int n = 1; n < most; ++n) {
        const auto is_step = [&](double angle) {
            const double at = (angle - from) / span * n;
            return std::abs(at - std::round(at)) < 1e-6 * n + 1e-9;
        };
        if (std::all_of(angles.begin(), angles.end(), is_step)) return n;
    }
    return most;
}

/// Sums over the pixels of an image, weighted by solid angle.
struct PixelSums {
    double flux = 0;     ///< sum for the image alone: luminance times solid angle
    double squares = 0;  ///< sum of squares of the image times the light's intensity
    double solid_angle = 0;

    void add(double own, double product, double solid)
    {
        flux += own * solid;
        squares += product * product * solid;
        solid_angle += solid;
    }
};

/// Luminance of texels, with and without the light's color.
class Texels {
public:
    Texels(const Compiler& c, const LightImages::Image& image, const Color& light)
        : texels_(c.tables.picture_texels.data() + 4 * std::size_t(image.first)), width_(image.width), light_(light)
    {
    }
    double own(int x, int y) const { return luminance(at(x, y)); }
    double product(int x, int y) const
    {
        const float* const t = at(x, y);
        const float lit[3] = {t[0] * light_.r, t[1] * light_.g, t[2] * light_.b};
        return luminance(lit);
    }

private:
    const float* at(int x, int y) const
    {
        return texels_ + 4 * (std::size_t(y) * std::size_t(width_) + std::size_t(x));
    }

    const float* texels_;
    int width_;
    Color light_;
};

/// width, height: tangents from center to edge. Pixels of small images are subdivided for the integral.
PixelSums sum_plane(const Texels& texels, const LightImages::Image& image, double width, double height, bool flat_field)
{
    const int parts = std::max(1, 256 / std::min(image.width, image.height));
    const double columns = double(image.width) * parts, rows = double(image.height) * parts;
    const double area = 4 * width * height / (columns * rows);
    PixelSums sums;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double own = texels.own(x, y), product = texels.product(x, y);
            for (int k = 0; k < parts * parts; ++k) {
                const int column = x * parts + k % parts, row = y * parts + k / parts;
                const double right = ((column + 0.5) / columns * 2 - 1) * width,
                             up = ((row + 0.5) / rows * 2 - 1) * height;
                const double cosine2 = 1 / (1 + right * right + up * up), cosine3 = cosine2 * std::sqrt(cosine2);
                const double factor = flat_field ? 1 / cosine3 : 1;
                sums.add(own * factor, product * factor, area * cosine3);
            }
        }
    return sums;
}

PixelSums sum_equal_area(const Texels& texels, const LightImages::Image& image)
{
    PixelSums sums;
    const double solid = 4 * pi / (double(image.width) * image.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) sums.add(texels.own(x, y), texels.product(x, y), solid);
    return sums;
}

/// Between two rows values change linearly with the angle, and solid angle with its sine.
PixelSums sum_angles(const Texels& texels, const LightImages::Image& image)
{
    constexpr int parts = 8;
    PixelSums sums;
    const double step = (image.last_angle - image.first_angle) / (image.height - 1) / parts;
    for (int y = 0; y + 1 < image.height; ++y)
        for (int k = 0; k < parts; ++k) {
            const double share = (k + 0.5) / parts, angle = image.first_angle + step * (y * parts + k + 0.5);
            const double solid = 2 * pi * std::sin(angle) * 2 * std::sin(step / 2) / image.width;
            const auto mixed = [&](double a, double b) { return a + share * (b - a); };
            for (int x = 0; x < image.width; ++x)
                sums.add(mixed(texels.own(x, y), texels.own(x, y + 1)),
                         mixed(texels.product(x, y), texels.product(x, y + 1)), solid);
        }
    return sums;
}

struct Tangents {
    double x, y;
};
/// Tangents of half a projector's field of view, for square pixels.
Tangents frustum(const Light& light, const LightImages::Image& image)
{
    const double aspect = double(image.width) / image.height, t = std::tan(light.fov / 2);
    switch (light.fov_axis) {
        case FovAxis::smaller:
            return aspect > 1 ? Tangents{t * aspect, t} : Tangents{t, t / aspect};
        case FovAxis::larger:
            return aspect > 1 ? Tangents{t, t / aspect} : Tangents{t * aspect, t};
        case FovAxis::height:
            return {t * aspect, t};
        case FovAxis::diagonal:
            return {t * aspect / std::hypot(1, aspect), t / std::hypot(1, aspect)};
        case FovAxis::width:
            break;
    }
    return {t, t / aspect};
}

/// Adds a margin against rounding, here and in the kernel.
double widened(double one_minus_cosine)
{
    return one_minus_cosine * (1 + 1e-4) + 1e-6;
}

PixelSums describe_plane(const Light& light, const LightImages::Image& image, const Texels& texels,
                         LightPictureRecord& t, PicturedIntensity& result)
{
    const double spot =
        std::min(light.outer_angle < pi / 2 ? std::tan(light.outer_angle) : largest_tangent, largest_tangent);
    const Tangents half = light.kind == LightKind::spot ? Tangents{spot, spot} : frustum(light, image);
    const bool flat_field = light.kind == LightKind::projector && light.flat_field;
    t.map = std::uint32_t(LightPictureMap::plane);
    t.scale_u = float(1 / half.x), t.scale_v = float(1 / half.y);
    if (flat_field) t.flags |= LightPictureRecord::flat_field;
    // This form has no cancellation for narrow fields of view.
    const double tangent2 = half.x * half.x + half.y * half.y, root = std::sqrt(1 + tangent2);
    result.outer = std::min(widened(tangent2 / (root * (1 + root))), 1.0);
    return sum_plane(texels, image, half.x, half.y, flat_field);
}

PixelSums describe_angles(const LightImages::Image& image, const Texels& texels, LightPictureRecord& t,
                          PicturedIntensity& result)
{
    t.map = std::uint32_t(LightPictureMap::angles);
    t.scale_u = float(image.width / (2 * pi));
    t.scale_v = float((image.height - 1) / (image.last_angle - image.first_angle));
    t.start = float(image.first_angle);
    const double s = std::sin(image.last_angle / 2);
    result.outer = image.last_angle < pi * 0.99 ? widened(2 * s * s) : 4;
    return sum_angles(texels, image);
}

}  // namespace

bool is_profile(const SceneDescription& scene, int image)
{
    return image >= 0 && is_ies_name(scene.images[std::size_t(image)].name);
}

void add_light_image(Compiler& c, const LightImages::Use& use, int width, int height, const LargeVector<float>& texels)
{
    const std::string name = use.first >= 0 ? name_of(c.scene, use.first) : c.scene.file;
    const std::uint32_t first = add_texels(c, std::size_t(width) * std::size_t(height), name);
    std::transform(texels.begin(), texels.end(), c.tables.picture_texels.begin() + std::ptrdiff_t(first) * 4,
                   [](float v) { return v > 0 && std::isfinite(v) ? v : 0.f; });
    c.light_images.by_use[use] = {first, width, height};
}

void add_light_profile(Compiler& c, const LightImages::Use& use)
{
    constexpr int finest = 1440;  // finest step: a quarter of a degree over the full circle
    const ImageFile& file = c.scene.images[std::size_t(use.first)];
    const IesProfile profile =
        file.bytes.empty()
            ? read_ies(file.path)
            : parse_ies(file.name, {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()});
    LightImages::Image image;
    const double first = profile.polar_deg.front(), span = profile.polar_deg.back() - first;
    // All planes of symmetry are multiples of 90 degrees; symmetry may put angles where the file has none.
    const bool is_round = profile.azimuth_deg.size() == 1;
    std::vector<double> azimuths = profile.azimuth_deg;
    if (!is_round) azimuths.push_back(90);
    image.width = is_round ? 1 : steps_to_have(azimuths, 0, 360, finest);
    image.height = 1 + steps_to_have(profile.polar_deg, first, span, finest);
    image.is_profile = true;
    image.first_angle = first * radians_per_degree, image.last_angle = (first + span) * radians_per_degree;
    image.first = add_texels(c, std::size_t(image.width) * std::size_t(image.height), file.name);
    float* texel = c.tables.picture_texels.data() + 4 * std::size_t(image.first);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x, texel += 4) {
            const double polar = y + 1 == image.height ? first + span : first + span * y / (image.height - 1);
            const double value = profile.at(polar, 360.0 * x / image.width);
            texel[0] = texel[1] = texel[2] = float(value);
            texel[3] = 1;
        }
    c.light_images.by_use[use] = image;
}

PicturedIntensity add_light_picture(Compiler& c, const Light& light)
{
    const LightImages::Image& image = c.light_images.by_use.at({light.picture.image, light.picture.color_space});
    const bool is_goniometric = light.kind == LightKind::goniometric;
    if (image.is_profile && !is_goniometric)
        throw Error(name_of(c.scene, light.picture.image), "", "IES files are supported for goniometric lights only");
    if (is_goniometric && !image.is_profile && image.width != image.height)
        throw Error(name_of(c.scene, light.picture.image), "",
                    fmt::format("the image of a goniometric light must be square: this one has {} by {} pixels",
                                image.width, image.height));
    PicturedIntensity result;
    result.picture = std::uint32_t(c.tables.light_pictures.size());
    LightPictureRecord& t = c.tables.light_pictures.emplace_back();
    t.first = image.first;
    t.width = float(image.width), t.height = float(image.height);
    if (light.picture.nearest && !image.is_profile) t.flags |= LightPictureRecord::nearest;
    t.map = std::uint32_t(LightPictureMap::equal_area);
    const Texels texels(c, image, light.intensity);
    const PixelSums sums = image.is_profile ? describe_angles(image, texels, t, result)
                           : is_goniometric ? sum_equal_area(texels, image)
                                            : describe_plane(light, image, texels, t, result);
    const bool is_flux = light.kind != LightKind::spot && light.intensity_is_flux;
    if (is_flux) result.factor = sums.flux > 0 ? 1 / sums.flux : 0;
    result.typical = result.factor * std::sqrt(sums.squares / sums.solid_angle);
    return result;
}

}  // namespace fathom
