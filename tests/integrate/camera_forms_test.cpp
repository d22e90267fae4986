// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Tests of each camera parameter, pixel filter and film layer by simple scenes.
namespace fathom {
namespace {

using namespace test;

/// A scene of white unlit objects on a black background.
struct Whites : SceneBuilder {
    int white(Color color = {1, 1, 1})
    {
        Material m;
        m.kind = MaterialKind::unlit;
        m.base_color.value = color;
        return material(m);
    }
    std::vector<float> pixels(const RenderSettings& settings, std::uint64_t samples)
    {
        return render_film(scene, settings, samples).image(false, false).layers[0].pixels;
    }
};

TEST(CameraForms, FieldOfViewAspectAndHeight)
{
    for (const auto& [width, height] : {std::pair{32, 32}, {48, 24}, {20, 40}})
        for (double degrees : {20.0, 60.0, 110.0}) {
            Whites s;
            s.camera({0, 0, 3}, {0, 0, 0}, degrees);
            // The rectangle covers half of the image's height and a quarter of its width.
            const double h = 3 * std::tan(degrees * std::numbers::pi / 360) / 2, w = h / 2 * width / height;
            s.add(Rectangle{{-w, -h, 0}, {2 * w, 0, 0}, {0, 2 * h, 0}}, s.white());
            const std::vector<float> p = s.pixels(small_image_settings(width, height), 64);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const bool in = std::abs(x + 0.5 - width / 2.0) < width / 8.0 &&
                                    std::abs(y + 0.5 - height / 2.0) < height / 4.0;
                    // Pixels near the rectangle's edge are skipped.
                    if (std::abs(std::abs(x + 0.5 - width / 2.0) - width / 8.0) < 0.75 ||
                        std::abs(std::abs(y + 0.5 - height / 2.0) - height / 4.0) < 0.75)
                        continue;
                    ASSERT_EQ(p[std::size_t(3 * (y * width + x))], in ? 1 : 0) << degrees << " " << x << " " << y;
                }
            s.scene.cameras[0].kind = CameraKind::orthographic;
            s.scene.cameras[0].height = 4 * h;
            EXPECT_NEAR(mean_of(render_film(s.scene, small_image_settings(width, height), 64)).value[0], 1.0 / 8, 2e-3);
        }
}

/// A camera of 40 degrees designed for 2:1 images, rendered at other aspect ratios: the side that keeps its angle, and
/// the resulting height.
TEST(CameraForms, WhatKeepsItsAngle)
{
    const double own = 3 * std::tan(20 * std::numbers::pi / 180);  // half height of the 2:1 image at a distance of 3
    struct Case {
        FovAxis axis;
        int width, height;
        double half_height;
    };
    const double diagonal = own * std::sqrt(5.0);
    const Case cases[] = {{FovAxis::height, 24, 24, own},
                          {FovAxis::width, 24, 24, 2 * own},
                          {FovAxis::width, 24, 48, 4 * own},
                          {FovAxis::width, 48, 24, own},
                          {FovAxis::smaller, 24, 24, own},
                          {FovAxis::smaller, 24, 48, 2 * own},
                          {FovAxis::larger, 24, 48, 2 * own},
                          {FovAxis::larger, 24, 24, 2 * own},
                          {FovAxis::diagonal, 24, 24, diagonal / std::sqrt(2.0)},
                          {FovAxis::diagonal, 24, 48, diagonal / std::sqrt(1.25)}};
    for (const Case& c : cases)
        for (const bool is_orthographic : {false, true}) {
            Whites s;
            s.camera({0, 0, 3}, {0, 0, 0}, 40);
            const double side = own / 2;
            s.add(Rectangle{{-side / 2, -side / 2, 0}, {side, 0, 0}, {0, side, 0}}, s.white());
            Camera& camera = s.scene.cameras[0];
            camera.fov_axis = c.axis, camera.fov_aspect = 2;
            if (is_orthographic) camera.kind = CameraKind::orthographic, camera.height = 2 * own;
            const double half_width = c.half_height * c.width / c.height;
            EXPECT_NEAR(mean_of(render_film(s.scene, small_image_settings(c.width, c.height), 256)).value[0],
                        side * side / (4 * c.half_height * half_width), 1e-3)
                << int(c.axis) << ' ' << c.width << ' ' << c.height << ' ' << is_orthographic;
        }
}

/// Two lights of different color tell apart the up and right directions.
TEST(CameraForms, PlaceDirectionAndRoll)
{
    for (const bool nested : {false, true})
        for (double roll : {0.0, 0.5, std::numbers::pi / 2, 3.0}) {
            Whites s;
            s.camera({4, 1, 2}, {4, 1, -3}, 40);
            // `up` need not be perpendicular to the view direction.
            s.scene.cameras[0].up = {-2 * std::sin(roll), 2 * std::cos(roll), 1};
            s.add(Sphere{{5, 1, -3}, 0.1, {}}, s.white({1, 0, 0}));  // a light to the right
            s.add(Sphere{{4, 2, -3}, 0.1, {}}, s.white({0, 1, 0}));  // a light above
            s.add(Sphere{{4, 1, -3}, 0.1, {}}, s.white({0, 0, 1}));  // a light ahead
            // The whole scene moved and doubled in size gives the same image.
            if (nested)
                s.scene.nodes[0].parent_from_node =
                    Transform::translate({10, -20, 30}) * Transform::rotate({1, 2, 3}, 1) * Transform::scale({2, 2, 2});
            const int n = 64;
            const std::vector<float> p = s.pixels(small_image_settings(n, n), 16);
            double sum[3] = {}, x[3] = {}, y[3] = {};
            for (int i = 0; i < n * n; ++i)
                for (int c = 0; c < 3; ++c) {
                    const double v = p[std::size_t(3 * i + c)];
                    sum[c] += v, x[c] += v * (i % n + 0.5), y[c] += v * (i / n + 0.5);
                }
            // Size in pixels of one meter at a distance of 5 m.
            const double unit = n / 2.0 / (5 * std::tan(20 * std::numbers::pi / 180));
            const double cosine = std::cos(roll), sine = std::sin(roll);
            const double expected[3][2] = {{cosine, -sine}, {sine, cosine}, {0, 0}};
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(x[c] / sum[c], n / 2.0 + unit * expected[c][0], 0.15) << roll << nested << c;
                EXPECT_NEAR(y[c] / sum[c], n / 2.0 - unit * expected[c][1], 0.15) << roll << nested << c;
            }
        }
}

/// A point-like square at depth z, seen through a lens of diameter a focused at f, becomes a disk whose diameter in the
/// plane of focus is a |z - f| / z, measured by its second moment.
TEST(CameraForms, CircleOfConfusion)
{
    struct Case {
        double aperture, focus, look_at, depth;
    };
    for (const Case& c :
         {Case{0.4, 4, 9, 8}, {0.4, 4, 9, 2}, {0.2, 4, 9, 8}, {0.4, 0, 4, 8}, {0.4, 8, 4, 8}, {0, 4, 4, 8}}) {
        Whites s;
        s.camera({0, 0, 0}, {0, 0, -c.look_at}, 30);
        s.scene.cameras[0].aperture = c.aperture;
        s.scene.cameras[0].focus_distance = c.focus;
        const double half = 0.01 * c.depth;
        s.add(Rectangle{{-half, -half, -c.depth}, {2 * half, 0, 0}, {0, 2 * half, 0}}, s.white());
        const int n = 64;
        const std::uint64_t samples = 256;
        const std::vector<float> p = s.pixels(small_image_settings(n, n), samples);
        double sum = 0, moment[2] = {}, mean[2] = {};
        for (int i = 0; i < n * n; ++i) {
            const double v = p[std::size_t(3 * i)], at[2] = {i % n + 0.5 - n / 2.0, i / n + 0.5 - n / 2.0};
            sum += v;
            for (int k = 0; k < 2; ++k) mean[k] += v * at[k], moment[k] += v * at[k] * at[k];
        }
        // Pixel size at distance 1 is 2 tan(15 deg) / n.
        const double focus = c.focus > 0 ? c.focus : c.look_at, pixel = 2 * std::tan(std::numbers::pi / 12) / n;
        const double radius = c.aperture / 2 * std::abs(c.depth - focus) / c.depth / focus / pixel;
        // The expected variance is the sum of those of the uniform disk, the square and the pixel.
        const double expected = radius * radius / 4 + std::pow(half / c.depth / pixel, 2) / 3 + 1.0 / 12;
        for (int k = 0; k < 2; ++k) {
            EXPECT_NEAR(mean[k] / sum, 0, 0.1);
            // The fourth moment of a disk is twice the squared second moment; sum * samples is the number of samples
            // that hit.
            const double error = expected / std::sqrt(sum * double(samples));
            EXPECT_NEAR(moment[k] / sum, expected, 4 * error + 0.01 * expected)
                << c.aperture << " " << c.focus << " " << c.depth;
        }
    }
}

/// Pixels near the edge of a white half plane have the filter's integral beyond the edge, computed numerically.
TEST(FilterForms, ResponseToAnEdge)
{
    const auto gaussian = [](double x) { return std::abs(x) < 2 ? std::exp(-2 * x * x) - std::exp(-8.0) : 0; };
    const auto blackman_harris = [](double x) {
        const double t = std::numbers::pi * (x / 1.65 + 1);
        return std::abs(x) < 1.65
                   ? 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t)
                   : 0;
    };
    const auto box = [](double x) { return std::abs(x) < 0.5 ? 1.0 : 0; };
    const auto tent = [](double x) { return std::max(0.0, 1 - std::abs(x)); };
    const auto share_right = [](const auto& f, double from) {
        double right = 0, all = 0;
        for (int i = 0; i < 40000; ++i) {
            const double x = -2 + (i + 0.5) / 10000;
            all += f(x);
            if (x > from) right += f(x);
        }
        return right / all;
    };
    struct Case {
        Filter filter;
        double radius, own;
    };
    for (const bool upright : {false, true})
        for (const auto& [filter, radius, own] :
             {Case{Filter::box, 0, 0.5}, Case{Filter::gaussian, 0, 2}, Case{Filter::blackman_harris, 0, 1.65},
              Case{Filter::tent, 0, 1}, Case{Filter::box, 1.25, 0.5}, Case{Filter::gaussian, 1.2, 2},
              Case{Filter::blackman_harris, 3, 1.65}, Case{Filter::tent, 2, 1}}) {
            Whites s;
            s.camera({0, 0, 5}, {0, 0, 0});
            s.scene.cameras[0].kind = CameraKind::orthographic;
            s.scene.cameras[0].height = 16;  // one pixel per meter
            // The half plane is on the right, or at the bottom.
            s.add(upright ? Rectangle{{-50, -100, 0}, {100, 0, 0}, {0, 100, 0}}
                          : Rectangle{{0, -50, 0}, {100, 0, 0}, {0, 100, 0}},
                  s.white());
            RenderSettings settings = small_image_settings(16, 16);
            settings.filter = filter;
            settings.filter_radius = radius;
            const std::vector<float> p = s.pixels(settings, 1024);
            for (int k = 0; k < 16; ++k) {
                double mean = 0;
                for (int j = 0; j < 16; ++j) mean += p[std::size_t(3 * (upright ? k * 16 + j : j * 16 + k))] / 16;
                // The edge is 8 - (k + 0.5) beyond the pixel's center.
                const double from = (8 - (k + 0.5)) * (radius > 0 ? own / radius : 1);
                const double expected = filter == Filter::box        ? share_right(box, from)
                                        : filter == Filter::gaussian ? share_right(gaussian, from)
                                        : filter == Filter::tent     ? share_right(tent, from)
                                                                     : share_right(blackman_harris, from);
                EXPECT_NEAR(mean, expected, 2e-3) << int(filter) << ' ' << radius << upright << " " << k;
            }
        }
}

/// Layers of a sphere agree with its equation.
TEST(Layers, OfASphere)
{
    for (const bool tree : {false, true}) {
        SceneBuilder b;
        b.diffuse(0.1f);
        const int material = b.diffuse(0.25f);
        b.scene.materials[1].base_color.value = {0.125f, 0.25f, 0.5f};
        for (int i = 0; i < (tree ? 100 : 0); ++i) b.add(Sphere{{80, 0.1 * i, 0}, 0.01, {}}, 0);
        b.add(Sphere{{80, -5, 0}, 0.01, {}}, 0);
        b.add(Sphere{{1, 2, -3}, 1.5, {}}, material);
        b.camera({1, 2, 4}, {1, 2, -3}, 30);
        RenderSettings settings = small_image_settings(33, 33);
        settings.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::instance_id, Aov::material_id};
        settings.alpha = true;
        const Image image = render_film(b.scene, settings, 32).image(true, false);
        for (const auto& [x, y] : {std::pair{16, 16}, {22, 16}, {16, 10}, {11, 21}}) {
            const std::size_t i = std::size_t(y * 33 + x);
            const double scale = std::tan(15 * std::numbers::pi / 180) * 2 / 33;
            const Vec3d d = normalize(Vec3d{(x - 16) * scale, (16 - y) * scale, -1});
            // The hit point (0, 0, 7) + t d is relative to the center.
            const double t = -7 * d.z - std::sqrt(49 * d.z * d.z - 49 + 2.25);
            const Vec3d p = Vec3d{0, 0, 7} + d * t, n = p * (1 / 1.5);
            const auto value = [&](const char* name, std::size_t stride, std::size_t c) {
                return image.find(name)->pixels[stride * i + c];
            };
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(value("albedo", 3, c), 0.125 * double(1 << c), 1e-6);
            EXPECT_NEAR(value("normal", 3, 0), n.x, 0.02);
            EXPECT_NEAR(value("normal", 3, 1), n.y, 0.02);
            EXPECT_NEAR(value("normal", 3, 2), n.z, 0.02);
            EXPECT_NEAR(value("depth", 1, 0), -d.z * t, 0.02);  // depth is along the view axis
            EXPECT_NEAR(value("position", 3, 0), 1 + p.x, 0.02);
            EXPECT_NEAR(value("position", 3, 1), 2 + p.y, 0.02);
            EXPECT_NEAR(value("position", 3, 2), -3 + p.z, 0.02);
            EXPECT_EQ(value("instance", 1, 0), tree ? 101 : 1);
            EXPECT_EQ(value("material", 1, 0), 1);
            EXPECT_EQ(image.layers[0].pixels[4 * i + 3], 1);
        }
        // A corner pixel sees no object.
        EXPECT_TRUE(std::isinf(image.find("depth")->pixels[0]));
        EXPECT_EQ(image.find("position")->pixels[1], 0);
        EXPECT_EQ(image.find("normal")->pixels[2], 0);
        EXPECT_EQ(image.layers[0].pixels[3], 0);
    }
}

/// Planes at 4 and 8 m have an edge that cuts a pixel column. Depth is along the axis, averaged over samples that hit;
/// albedo and normals average all samples including the sky; ids come from one sample.
TEST(Layers, OfPlanesAndTheirEdge)
{
    SceneBuilder b;
    const int near = b.diffuse(0.5f), far = b.diffuse(0.25f);
    b.add(Rectangle{{-9, -9, 0}, {9.03, 0, 0}, {0, 12, 0}}, near);
    b.add(Rectangle{{-30, -30, -4}, {60, 0, 0}, {0, 32.1, 0}}, far);
    b.camera({0, 0, 4}, {0, 0, 0}, 90);
    RenderSettings settings = small_image_settings(32, 32);
    settings.filter = Filter::box;
    settings.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::instance_id, Aov::material_id};
    const Image image = render_film(b.scene, settings, 64).image(false, false);
    const auto value = [&](const char* name, std::size_t stride, int x, int y) {
        return image.find(name)->pixels[stride * std::size_t(32 * y + x)];
    };
    // A pixel is 0.25 m wide at 4 m: the near plane ends at 0.03 m, 12 % of the column right of the center.
    for (const int x : {0, 9, 15}) EXPECT_NEAR(value("depth", 1, x, 20), 4, 1e-4) << x;
    for (const int x : {17, 25, 31}) EXPECT_NEAR(value("depth", 1, x, 20), 8, 1e-4) << x;
    const float depth = value("depth", 1, 16, 20), share = (8 - depth) / 4;
    EXPECT_NEAR(share, 0.12, 0.03);
    EXPECT_NEAR(value("albedo", 3, 16, 20), share * 0.5f + (1 - share) * 0.25f, 1e-4);
    const float id = value("instance", 1, 16, 20);
    EXPECT_TRUE(id == 0 || id == 1);
    EXPECT_EQ(value("material", 1, 16, 20), id == 0 ? near : far);
    // The far plane ends 2.1 m above the axis: at 0.5 m per pixel, a fifth of the fifth row above the center.
    EXPECT_NEAR(value("depth", 1, 25, 11), 8, 1e-4) << "samples that miss are ignored";
    EXPECT_NEAR(value("albedo", 3, 25, 11), 0.2 * 0.25, 0.01);
    EXPECT_NEAR(value("normal", 3, 25, 11), 0, 1e-6);
    EXPECT_NEAR(image.find("normal")->pixels[3 * (32 * 11 + 25) + 2], 0.2, 0.04);
    EXPECT_EQ(value("instance", 1, 25, 11), 1) << "the sky has no id";
    EXPECT_TRUE(std::isinf(value("depth", 1, 25, 10)));
    EXPECT_EQ(value("albedo", 3, 25, 10), 0);
    EXPECT_EQ(value("instance", 1, 25, 10), 0);
}

/// Each placement of a shape has its own instance id, with the material of that placement.
TEST(Layers, IdsOfInstances)
{
    SceneBuilder b;
    Points points;
    points.centers = {{0, 0, 0}, {0, 0.3f, 0}};
    points.radii = {0.4f, 0.4f};
    b.scene.points.push_back(points);
    for (int i = 0; i < 3; ++i) {
        Node node;
        node.parent_from_node = Transform::translate({1.2 * i - 1.2, 0, 0});
        node.shapes.push_back({PointsInstance{0}, b.diffuse(0.25f * float(i + 1)), ""});
        b.scene.roots.push_back(int(b.scene.nodes.size()));
        b.scene.nodes.push_back(node);
    }
    b.camera({0, 0, 5}, {0, 0, 0});
    b.scene.cameras[0].kind = CameraKind::orthographic;
    b.scene.cameras[0].height = 1.2;
    RenderSettings settings = small_image_settings(33, 11);
    settings.aovs = {Aov::instance_id, Aov::material_id, Aov::albedo};
    const Image image = render_film(b.scene, settings, 4).image(false, false);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t pixel = 5 * 33 + 5 + 11 * i;
        EXPECT_EQ(image.find("instance")->pixels[pixel], float(i));
        EXPECT_EQ(image.find("material")->pixels[pixel], float(i));
        EXPECT_FLOAT_EQ(image.find("albedo")->pixels[3 * pixel], 0.25f * float(i + 1));
    }
}

/// The normal layer faces the viewer, also on back sides; smooth meshes have interpolated vertex normals.
TEST(Layers, NormalsOfSmoothMeshesAndBacks)
{
    SceneBuilder b;
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}};
    mesh.normals = {{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}};
    mesh.indices = {0, 1, 2};
    b.scene.meshes.push_back(mesh);
    b.add(MeshInstance{0}, b.diffuse(0.5f));
    b.add(Rectangle{{-1, -1, -4}, {0, 2, 0}, {2, 0, 0}}, b.diffuse(0.5f));  // the front of this rectangle faces away
    b.camera({0, 0, 5}, {0, 0, 0});
    b.scene.cameras[0].kind = CameraKind::orthographic;
    RenderSettings settings = small_image_settings(16, 16);
    settings.aovs = {Aov::normal};
    const Image image = render_film(b.scene, settings, 64).image(false, false);
    const float* n = &image.find("normal")->pixels[3 * (12 * 16 + 4)];
    const double u = 4.5 / 16, v = 3.5 / 16;
    const Vec3d expected = normalize(Vec3d{0, 0, 1} * (1 - u - v) + Vec3d{0.6, 0, 0.8} * u + Vec3d{0, 0.6, 0.8} * v);
    EXPECT_NEAR(n[0], expected.x, 0.01);
    EXPECT_NEAR(n[1], expected.y, 0.01);
    EXPECT_NEAR(n[2], expected.z, 0.01);
    EXPECT_NEAR(image.find("normal")->pixels[3 * (2 * 16 + 13) + 2], 1, 1e-6);
}

/// Each pixel center of an all-around camera sees the environment in the direction of the projection's formula. A
/// vertical gradient is joined by lights that identify right and ahead.
TEST(CameraForms, AllDirections)
{
    for (const bool equal_area : {false, true}) {
        SceneBuilder b;
        Camera c;
        c.kind = equal_area ? CameraKind::equal_area : CameraKind::spherical;
        c.position = {5, 0, 0}, c.look_at = {5, 0, -2}, c.aperture = 0.5;
        b.scene.cameras.push_back(c);
        b.scene.nodes[0].camera = 0;
        b.scene.environment.kind = EnvironmentKind::gradient;
        b.scene.environment.bottom = {0, 0, 0}, b.scene.environment.top = {1, 1, 1};
        b.add(Sphere{{5, 0, -10}, 0.5, {}}, b.diffuse(0, {7, 0, 0}));  // a light ahead of the camera
        b.add(Sphere{{15, 0, 0}, 0.5, {}}, b.diffuse(0, {0, 7, 0}));   // a light to the right of the camera
        b.add(Sphere{{5, 0, 10}, 0.5, {}}, b.diffuse(0, {0, 0, 7}));   // a light behind the camera
        const int w = 80, h = equal_area ? 80 : 40;
        const Film film = render_film(b.scene, small_image_settings(w, h), 16);
        const Image image = film.image(false, false);
        const auto& pixels = image.layers[0].pixels;
        const auto at = [&](double x, double y) {
            const auto i = std::size_t(std::clamp(int(y * h), 0, h - 1) * w + std::clamp(int(x * w), 0, w - 1));
            return Color{pixels[3 * i], pixels[3 * i + 1], pixels[3 * i + 2]};
        };
        if (equal_area) {
            EXPECT_GT(at(0.5, 0).r, 3);
            EXPECT_GT(at(1, 0.5).g, 3);
            EXPECT_GT(at(0.5, 1).b, 3);
            EXPECT_NEAR(at(0.5, 0.5).r, 1, 0.02);  // the view straight up
            for (const double corner : {0.0, 1.0}) EXPECT_NEAR(at(corner, corner).r, 0, 0.02);
            // The mean weighted by solid angle is that of the whole sphere.
            double sum = 0;
            for (std::size_t i = 0; i < pixels.size(); i += 3) sum += std::min(1.0, double(pixels[i])) / (w * h);
            EXPECT_NEAR(sum, 0.5, 0.005);
        } else {
            EXPECT_GT(at(0.5, 0.5).r, 1.5);
            EXPECT_GT(at(0.75, 0.5).g, 1.5);
            EXPECT_GT(at(0, 0.5).b, 1.5);
            for (const double y : {0.1, 0.3, 0.8})
                EXPECT_NEAR(at(0.2, y).r, (1 + std::cos(std::numbers::pi * (std::floor(y * h) + 0.5) / h)) / 2, 0.005);
        }
    }
}

}  // namespace
}  // namespace fathom
