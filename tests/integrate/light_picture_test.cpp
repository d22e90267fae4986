// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <filesystem>
#include <limits>
#include <random>

#include "fathom/editable_scene.h"
#include "fathom/error.h"
#include "fathom/image.h"
#include "floor.h"

// Tests of lights with an intensity image: irradiance of floor points against formulas in double precision.
namespace fathom {
namespace {

using namespace test;

/// A linear 8-bit image: red, green, blue of each pixel.
ImageFile image_of(int width, int height, const std::vector<int>& values)
{
    ImageFile file{"picture.ppm", {}, {}};
    for (const char c : "P6\n" + std::to_string(width) + ' ' + std::to_string(height) + "\n255\n")
        file.bytes.push_back(std::byte(c));
    for (const int v : values) file.bytes.push_back(std::byte(v));
    return file;
}
ImageFile profile_of(const std::string& numbers)
{
    ImageFile file{"lamp.ies", {}, {}};
    for (const char c : "IESNA:LM-63-2002\nTILT=NONE\n" + numbers) file.bytes.push_back(std::byte(c));
    return file;
}

/// Image value at (u, v) from the top left, bilinear or nearest, with clamped edges.
double looked_up(int width, int height, const std::vector<int>& values, bool nearest, double u, double v, int channel)
{
    const auto texel = [&](int x, int y) {
        x = std::clamp(x, 0, width - 1), y = std::clamp(y, 0, height - 1);
        return values[std::size_t(3 * (y * width + x) + channel)] / 255.0;
    };
    if (nearest) return texel(int(u * width), int(v * height));
    const double x = u * width - 0.5, y = v * height - 0.5;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const auto row = [&](int k) { return texel(x0, k) + (x - x0) * (texel(x0 + 1, k) - texel(x0, k)); };
    return row(y0) + (y - y0) * (row(y0 + 1) - row(y0));
}

/// A light above a floor, and its expected illumination.
struct Case {
    Light light;
    ImageFile image;
    Transform place;
    /// Luminous intensity along a unit direction in node space, by channel.
    std::function<double(const Vec3d&, int)> intensity;

    void expect(double x, double z, double relative = 1e-3) const
    {
        Floor floor;
        floor.samples = 32;
        floor.add_objects = [&](SceneBuilder& b) {
            b.scene.images.push_back(image);
            b.light(light, place);
        };
        const Vec3d to = place.point({0, 0, 0}) - Vec3d{x, 0, z};
        for (int way = 0; way < 16; ++way) {
            const Mean m = floor.irradiance(x, z, way);
            for (int c = 0; c < 3; ++c) {
                const double e = intensity(normalize(place.inverse().vector(-to)), c) * to.y / std::pow(length(to), 3);
                EXPECT_NEAR(m.value[c], e, 4 * m.error[c] + relative * e + 1e-6)
                    << "at " << x << ", " << z << " as " << Floor::ways[way] << ", channel " << c;
            }
        }
    }
};

const std::vector<int> colors = {255, 10, 40, 90, 200, 30, 20, 60, 250, 130, 120, 0, 5, 255, 99, 240, 240, 240};

/// 3 x 2 pixels with right at +x and top at +y of a node that emits along -z, over half angles with tangents tx and ty.
std::function<double(const Vec3d&, int)> through_window(double tx, double ty, bool nearest, bool flat_field)
{
    return [=](const Vec3d& d, int channel) {
        if (d.z >= 0) return 0.0;
        const double u = 0.5 + 0.5 * d.x / -d.z / tx, v = 0.5 - 0.5 * d.y / -d.z / ty;
        if (u < 0 || u > 1 || v < 0 || v > 1) return 0.0;
        return 5 * looked_up(3, 2, colors, nearest, u, v, channel) * (flat_field ? std::pow(-d.z, -3.0) : 1);
    };
}

const Vec3d floor_places[] = {{0, 0, 0}, {0.4, 0, -0.2}, {-0.5, 0, 0.3}, {1.1, 0, 0.4}, {-1.2, 0, -0.35}, {2.5, 0, 1}};

Case projector(bool nearest, bool flat_field)
{
    Case c;
    c.light.kind = LightKind::projector;
    c.light.intensity = {5, 5, 5};
    c.light.picture = {0, ColorSpace::linear, nearest};
    c.light.flat_field = flat_field;
    c.light.fov = 0.9;
    c.image = image_of(3, 2, colors);
    c.place = Transform::translate({0.1, 1.4, 0.05}) * rotate_to({0.1, -1, 0.05}) * Transform::rotate({0, 0, 1}, 0.3);
    c.intensity = through_window(std::tan(0.45) * 1.5, std::tan(0.45), nearest, flat_field);
    return c;
}

TEST(LightPictures, ProjectorsThroughTheirWindow)
{
    for (const bool nearest : {false, true})
        for (const bool flat_field : {false, true}) {
            const Case c = projector(nearest, flat_field);
            for (const Vec3d& p : floor_places) c.expect(p.x, p.z);
            // The points are inside and outside each of the four corners.
            for (const double x : {-1.0, 1.0})
                for (const double y : {-1.0, 1.0})
                    for (const double share : {0.98, 1.02}) {
                        const Vec3d from = c.place.point({0, 0, 0});
                        const double t = std::tan(0.45) * share;
                        const Vec3d d = c.place.vector({x * 1.5 * t, y * t, -1});
                        const Vec3d p = from + d * (-from.y / d.y);
                        c.expect(p.x, p.z);
                    }
        }
}

TEST(LightPictures, AnglesOfViewAcrossEachAxis)
{
    const double t = std::tan(0.45);
    const std::pair<FovAxis, double> heights[] = {{FovAxis::smaller, t},
                                                  {FovAxis::larger, t / 1.5},
                                                  {FovAxis::width, t / 1.5},
                                                  {FovAxis::height, t},
                                                  {FovAxis::diagonal, t / std::hypot(1, 1.5)}};
    for (const auto& [axis, height] : heights) {
        Case c = projector(false, false);
        c.light.fov_axis = axis;
        c.intensity = through_window(1.5 * height, height, false, false);
        for (const Vec3d& p : {floor_places[1], floor_places[4]}) c.expect(p.x, p.z);
    }
}

/// Scaled and sheared nodes leave the image unchanged; mirroring nodes mirror it.
TEST(LightPictures, NodesThatStretchAndMirror)
{
    Case c = projector(false, false);
    const Transform straight = c.place;
    c.place = straight * Transform::scale({3, 3, 3});
    for (const Vec3d& p : floor_places) c.expect(p.x, p.z);
    c = projector(false, false);
    c.place = straight * Transform::scale({-1, 1, 1});
    for (const Vec3d& p : floor_places) c.expect(p.x, p.z);
    // Under shear the axis and the image's right stay, and its top becomes perpendicular to both.
    Transform shear;
    shear.m[0][1] = 0.4, shear.m[1][1] = 2;
    const Case plain = projector(false, false);
    Floor floor;
    floor.samples = 16;
    const auto red = [&](const Transform& place) {
        floor.add_objects = [&](SceneBuilder& b) {
            b.scene.images.push_back(plain.image);
            b.light(plain.light, place);
        };
        return floor.irradiance(0.4, -0.2, 1).value[0];
    };
    EXPECT_NEAR(red(straight * shear), red(straight), 1e-4 * red(straight));
}

/// A projector without an image is white; an unreadable image becomes gray.
TEST(LightPictures, ProjectorsWithoutAPicture)
{
    Case c = projector(false, false);
    c.light.picture.image = -1;
    const double t = std::tan(0.45);
    c.intensity = [t](const Vec3d& d, int) {
        return d.z < 0 && std::max(std::abs(d.x), std::abs(d.y)) < -d.z * t ? 5.0 : 0.0;
    };
    for (const Vec3d& p : floor_places) c.expect(p.x, p.z);
}

/// Total flux of a projector: a square window covers the solid angle 4 asin(sin^2(half angle)); a flat field has the
/// window's area.
TEST(LightPictures, FluxIsSharedAmongAllDirections)
{
    const double half = 0.45, t = std::tan(half);
    for (const int gray : {255, 20}) {
        Case c = projector(false, false);
        c.image = image_of(1, 1, {gray, gray, gray});
        c.light.intensity_is_flux = true;
        const double solid_angle = 4 * std::asin(std::sin(half) * std::sin(half));
        c.intensity = [&](const Vec3d& d, int) {
            return d.z < 0 && std::max(std::abs(d.x), std::abs(d.y)) < -d.z * t ? 5 / solid_angle : 0.0;
        };
        c.expect(0, 0);
        c.light.flat_field = true;
        c.intensity = [&](const Vec3d& d, int) { return 5 / (4 * t * t) / std::pow(-d.z, 3); };
        c.expect(0, 0), c.expect(0.3, 0.1);
        c.light.kind = LightKind::goniometric;
        c.intensity = [&](const Vec3d&, int) { return 5 / (4 * std::numbers::pi); };
        c.expect(0, 0), c.expect(3, 0.1);
        c.image = profile_of("1 1 1 3 1 1 1 0 0 0 1 1 1  0 45 180  0  7 7 7");
        c.expect(0, 0), c.expect(3, 0.1);
        // This profile covers half of the sphere.
        c.image = profile_of("1 1 1 3 1 1 1 0 0 0 1 1 1  0 45 90  0  7 7 7");
        c.intensity = [&](const Vec3d& d, int) { return d.z < 0 ? 5 / (2 * std::numbers::pi) : 0; };
        c.expect(0, 0), c.expect(0.5, 0.1);
    }
}

/// A goniometric image of one color is a point light in any orientation.
TEST(LightPictures, UniformGoniometric)
{
    Case c;
    c.light.kind = LightKind::goniometric;
    c.light.intensity = {3, 3, 3};
    c.light.picture = {0, ColorSpace::linear, false};
    std::vector<int> values;
    for (int i = 0; i < 16; ++i) values.insert(values.end(), {200, 100, 50});
    c.image = image_of(4, 4, values);
    c.intensity = [](const Vec3d&, int channel) { return 3 * (channel == 0 ? 200 : channel == 1 ? 100 : 50) / 255.0; };
    for (int i = 0; i < 6; ++i) {
        c.place = Transform::translate({0.1, 1.4, 0.05}) * Transform::rotate({1, 2.0 * i, 0.5}, 1.1 * i);
        c.expect(0.3 * i, -0.2);
    }
}

/// If the image's left half is black, so are directions left of the axis; likewise for its bottom half and for its
/// edges, which are behind the light.
TEST(LightPictures, HalvesOfAGoniometricPicture)
{
    struct Half {
        std::function<bool(int, int)> is_lit;      ///< texel (column, row) of 32 x 32
        std::function<double(const Vec3d&)> side;  ///< positive where light is emitted
    };
    const Half halves[] = {{[](int x, int) { return x >= 16; }, [](const Vec3d& d) { return d.x; }},
                           {[](int, int y) { return y < 16; }, [](const Vec3d& d) { return d.y; }},
                           {[](int x, int y) { return std::abs(x - 15.5) + std::abs(y - 15.5) < 16; },
                            [](const Vec3d& d) { return -d.z; }}};
    std::mt19937 engine(5);
    const auto chance = [&] { return double(engine() >> 8) * 0x1p-23 - 1; };
    for (const Half& half : halves) {
        Case c;
        c.light.kind = LightKind::goniometric;
        c.light.picture = {0, ColorSpace::linear, true};
        std::vector<int> values;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) values.insert(values.end(), 3, half.is_lit(x, y) ? 255 : 0);
        c.image = image_of(32, 32, values);
        c.intensity = [&](const Vec3d& d, int) { return half.side(d) > 0 ? 1.0 : 0.0; };
        for (int i = 0; i < 12; ++i) {
            c.place = Transform::translate({0.1, 1.4, 0.05}) *
                      Transform::rotate(normalize(Vec3d{chance(), chance(), chance()}), 3 * chance());
            const Vec3d p{0.5 * chance(), 0, chance()};
            // Points near the image's steps are skipped.
            if (std::abs(half.side(normalize(c.place.inverse().point(p)))) > 0.3) c.expect(p.x, p.z);
        }
    }
}

/// Photometric angles: nadir is where the light points, 0 degrees is the node's +x, increasing towards its +y.
TEST(LightPictures, ProfilesOfLuminaires)
{
    Case c;
    c.light.kind = LightKind::goniometric;
    c.light.intensity = {2, 2, 2};
    c.light.picture.image = 0;
    c.image = profile_of(
        "1 1000 1\n5 5 1 1 0.1 0.1 0.1\n1 1 60\n0 20 50 90 120\n0 90 180 270 360\n"
        "100 80 60 40 20  100 200 30 10 5  100 70 90 20 0  100 10 5 50 30  100 80 60 40 20\n");
    const std::vector<double> polar = {0, 20, 50, 90, 120};
    const double candela[5][5] = {{100, 80, 60, 40, 20},
                                  {100, 200, 30, 10, 5},
                                  {100, 70, 90, 20, 0},
                                  {100, 10, 5, 50, 30},
                                  {100, 80, 60, 40, 20}};
    c.intensity = [&](const Vec3d& d, int) {
        const double degree = std::numbers::pi / 180, p = std::acos(-d.z) / degree;
        double a = std::atan2(d.y, d.x) / degree;
        if (a < 0) a += 360;
        if (p > 120) return 0.0;
        const std::size_t column = std::min<std::size_t>(std::size_t(a / 90), 3);
        std::size_t row = 0;
        while (row < 3 && p > polar[row + 1]) ++row;
        const double s = (p - polar[row]) / (polar[row + 1] - polar[row]), t = a / 90 - double(column);
        const auto at = [&](std::size_t i) { return candela[i][row] + s * (candela[i][row + 1] - candela[i][row]); };
        return 2 * (at(column) + t * (at(column + 1) - at(column)));
    };
    for (const Vec3d& along : {Vec3d{0, -1, 0}, {0.3, -1, -0.6}, {1, 0.2, 0.3}, {-1, 0.9, 0}}) {
        c.place = Transform::translate({0.1, 1.4, 0.05}) * rotate_to(along) * Transform::rotate({0, 0, 1}, 0.7);
        for (const Vec3d& p : floor_places) c.expect(p.x, p.z, 2e-3);
    }
}

/// A spot light's image covers the square around its cone.
TEST(LightPictures, SpotsShowThem)
{
    Case c = projector(false, false);
    c.light.kind = LightKind::spot;
    c.light.inner_angle = 0.2, c.light.outer_angle = 0.6;
    const auto picture = through_window(std::tan(0.6), std::tan(0.6), false, false);
    c.intensity = [&](const Vec3d& d, int channel) {
        const double x = std::clamp((-d.z - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6)), 0.0, 1.0);
        return picture(d, channel) * x * x;
    };
    for (const Vec3d& p : floor_places) c.expect(p.x, p.z, 2e-3);
}

/// 8-bit images are sRGB unless declared linear.
TEST(LightPictures, ColorSpaces)
{
    Case c = projector(false, false);
    c.image = image_of(1, 1, {188, 188, 188});
    for (const ColorSpace space : {ColorSpace::srgb, ColorSpace::linear}) {
        c.light.picture.color_space = space;
        const double v = space == ColorSpace::linear ? 188 / 255.0 : std::pow((188 / 255.0 + 0.055) / 1.055, 2.4);
        c.intensity = [v](const Vec3d&, int) { return 5 * v; };
        c.expect(0, 0);
    }
}

/// Negative values and NaN become black.
TEST(LightPictures, OddValues)
{
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "fathom_odd_light.exr";
    Image image;
    image.width = 4, image.height = 1;
    image.layers.push_back({"", {"R", "G", "B"}, {}});
    for (const float v : {-3.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 6.f})
        image.layers[0].pixels.insert(image.layers[0].pixels.end(), 3, v);
    write_image(file, image, {});
    Case c = projector(true, false);
    c.image = {"odd.exr", file, {}};
    c.intensity = [](const Vec3d& d, int) {
        const double t = std::tan(0.45), u = 0.5 + d.x / -d.z / t / 8, v = 0.5 - d.y / -d.z / t / 2;
        return d.z < 0 && u > 0.75 && u < 1 && v > 0 && v < 1 ? 30.0 : 0.0;
    };
    for (const Vec3d& p : floor_places) c.expect(p.x, p.z);
    std::filesystem::remove(file);
}

/// Forty lights with mostly dark images and a sphere: light selection only changes the noise.
TEST(LightPictures, SelectionOnlyChangesTheNoise)
{
    std::mt19937 engine(11);
    const auto chance = [&](double lo, double hi) { return lo + (hi - lo) * double(engine() >> 8) * 0x1p-24; };
    SceneBuilder b;
    b.add(Rectangle{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}}, b.diffuse(0.5f));
    b.add(Sphere{{0, 0.4, 0}, 0.4, {}}, b.diffuse(0.5f, {0.2f, 0.2f, 0.2f}));
    std::vector<int> sparse(3 * 64);
    for (int i = 0; i < 60; ++i) sparse[std::size_t(chance(40, 191))] = 255;
    b.scene.images = {image_of(8, 8, sparse), image_of(3, 2, colors),
                      profile_of("1 1 1 3 1 1 1 0 0 0 1 1 1  0 20 80  0  9 3 0")};
    for (int i = 0; i < 40; ++i) {
        Light light;
        light.kind = i % 3 == 0 ? LightKind::goniometric : i % 3 == 1 ? LightKind::projector : LightKind::spot;
        light.picture = {i % 3 == 0 ? (i % 2 ? 0 : 2) : i % 2, ColorSpace::linear, i % 4 == 0};
        light.outer_angle = chance(0.2, 1), light.fov = chance(0.3, 1.5);
        light.intensity = {float(chance(0, 2)), 1, float(chance(0, 2))};
        light.flat_field = i % 5 == 0;
        b.light(light, Transform::translate({chance(-2, 2), chance(0.8, 2), chance(-2, 2)}) *
                           rotate_to({chance(-1, 1), -1, chance(-1, 1)}));
    }
    b.camera({0.5, 2, 5.5}, {0, 0.5, 0}, 50);
    RenderSettings settings = small_image_settings(24, 18);
    settings.max_depth = 2;
    const std::array<Mean, 3> means = means_by_selection(b.scene, settings, 2048);
    const Mean& tree = means[int(LightSelection::tree)];
    for (const LightSelection other : {LightSelection::power, LightSelection::uniform})
        for (int c = 0; c < 3; ++c) {
            EXPECT_LT(tree.error[c], 0.02 * tree.value[c]);
            EXPECT_LT(tree.error[c], means[int(other)].error[c]);
            EXPECT_NEAR(tree.value[c], means[int(other)].value[c],
                        4.5 * std::hypot(tree.error[c], means[int(other)].error[c]))
                << "channel " << c << ", selection " << int(other);
        }
}

/// Editing a light gives the scene compiled anew, also if its image changes.
TEST(LightPictures, Edits)
{
    const Case c = projector(false, false);
    SceneBuilder b;
    b.add(Rectangle{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}}, b.diffuse(0.5f));
    b.scene.images = {c.image, image_of(1, 1, {9, 90, 200})};
    b.light(c.light, c.place);
    b.camera({0, 3, 0.1}, {0, 0, 0});
    EditableScene edit(b.scene);
    Warnings warnings;
    std::uint64_t before = edit.compile(warnings).fingerprint();
    const auto change = [&](const char* what, bool anew, auto&& f) {
        SCOPED_TRACE(what);
        f(b.scene.lights[0]);
        edit.set_light(0, b.scene.lights[0]);
        const std::uint64_t now = edit.compile(warnings).fingerprint();
        EXPECT_EQ(now, Scene::compile(b.scene, "", warnings).fingerprint());
        EXPECT_NE(now, before);
        EXPECT_EQ(edit.recompiled(), anew);
        before = now;
    };
    change("fov", false, [](Light& l) { l.fov = 0.5; });
    change("flat field", false, [](Light& l) { l.flat_field = true; });
    change("lookup", false, [](Light& l) { l.picture.nearest = true; });
    change("flux", false, [](Light& l) { l.intensity_is_flux = true; });
    change("axis", false, [](Light& l) { l.fov_axis = FovAxis::width; });
    change("image", true, [](Light& l) { l.picture.image = 1; });
    change("space", true, [](Light& l) { l.picture.color_space = ColorSpace::srgb; });
    change("kind", false, [](Light& l) { l.kind = LightKind::spot; });
    change("point", true, [](Light& l) { l.kind = LightKind::point; });
    change("spot", true, [](Light& l) { l.kind = LightKind::spot; });
}

/// An unreadable image gives one warning that names the file.
TEST(LightPictures, WhatCannotBeShown)
{
    const auto error_of = [](const Light& light, const ImageFile& image) {
        SceneBuilder b;
        b.scene.images.push_back(image);
        b.light(light, {});
        b.camera({0, 0, 0}, {0, 0, -1});
        Warnings warnings;
        try {
            Scene::compile(b.scene, "", warnings);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("compiled");
    };
    Light light;
    light.kind = LightKind::goniometric;
    light.picture.image = 0;
    EXPECT_EQ(error_of(light, image_of(3, 2, colors)),
              "picture.ppm: the image of a goniometric light must be square: this one has 3 by 2 pixels");
    EXPECT_EQ(error_of(light, profile_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 5 -1")),
              "lamp.ies: IES: the candela value 2 of 2 is negative");
    EXPECT_EQ(error_of(light, ImageFile{"x.ies", "/nowhere/x.ies", {}}), "/nowhere/x.ies: there is no such file");
    light.kind = LightKind::projector;
    EXPECT_EQ(error_of(light, profile_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 5 1")),
              "lamp.ies: IES files are supported for goniometric lights only");
    light.fov = 0;
    EXPECT_NE(error_of(light, image_of(3, 2, colors)).find("fov"), std::string::npos);
    light.fov = 1, light.picture.image = 3;
    EXPECT_NE(error_of(light, image_of(3, 2, colors)).find("there is no image 3"), std::string::npos);
    light.kind = LightKind::goniometric, light.picture.image = -1;
    EXPECT_NE(error_of(light, image_of(3, 2, colors)).find("needs an image"), std::string::npos);
}

}  // namespace
}  // namespace fathom
