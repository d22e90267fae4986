// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// A lit corner of a room with a sphere and a mesh, of the given size and position.
SceneDescription corner(double s, Vec3d shift)
{
    SceneBuilder b;
    const int gray = b.diffuse(0.7f);
    b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, gray);
    b.add(Rectangle{{-2, 0, -2}, {4, 0, 0}, {0, 4, 0}}, gray);
    b.add(Sphere{{0.5, 0.5, 0}, 0.5, {}}, gray);
    Mesh mesh;
    mesh.positions = {{-1.5f, 0, 0}, {-0.5f, 0, 0}, {-1, 1, 0}, {-1, 0, -1}};
    mesh.indices = {0, 1, 2, 1, 3, 2, 3, 0, 2};
    b.scene.meshes.push_back(mesh);
    b.add(MeshInstance{0}, gray);
    b.add(Rectangle{{-1, 3.5, 1}, {0, 0, -2}, {2, 0, 0}}, b.diffuse(0, {5, 5, 5}));
    b.camera({0.5, 2, 5}, {0, 0.8, 0}, 40);
    b.scene.nodes[0].parent_from_node = Transform::translate(shift) * Transform::scale({s, s, s});
    return b.scene;
}

double mean_difference(const Film& a, const Film& b)
{
    const Image x = a.image(false, false), y = b.image(false, false);
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < x.layers[0].pixels.size(); ++i) {
        sum += std::abs(x.layers[0].pixels[i] - y.layers[0].pixels[i]);
        total += x.layers[0].pixels[i];
    }
    return sum / total;
}

TEST(Invariance, ScaleByPowersOfTwoChangesNoBit)
{
    const Film one = render_film(corner(1, {}), small_image_settings(), 8);
    EXPECT_EQ(mean_difference(one, render_film(corner(0x1p-20, {}), small_image_settings(), 8)), 0);
    EXPECT_EQ(mean_difference(one, render_film(corner(0x1p20, {}), small_image_settings(), 8)), 0);
}

TEST(Invariance, ScaleAndPlaceChangeThePictureByRoundingOnly)
{
    const Film one = render_film(corner(1, {}), small_image_settings(), 64);
    const Mean expected = mean_of(one);
    for (double s : {1e-6, 1e-3, 1e6})
        for (double far : {0.0, 1e7}) {
            const Film other = render_film(corner(s, Vec3d{far, -far, far} * (4 * s)), small_image_settings(), 64);
            // The random numbers are equal, so paths differ only where rounding decides.
            EXPECT_LT(mean_difference(one, other), 0.01) << s << " " << far;
            EXPECT_NEAR(mean_of(other).value[0], expected.value[0], 4 * expected.error[0]) << s << " " << far;
        }
}

TEST(Triangles, APairIsThePictureOfItsParallelogram)
{
    const auto scene = [](bool as_mesh) {
        SceneBuilder b;
        const int gray = b.diffuse(0.6f), lamp = b.diffuse(0, {4, 4, 4});
        const auto quad = [&](Vec3d corner, Vec3d u, Vec3d v, int material) {
            if (!as_mesh) return b.add(Rectangle{corner, u, v}, material);
            Mesh mesh;
            for (Vec3d p : {corner, corner + u, corner + u + v, corner + v})
                mesh.positions.push_back({float(p.x), float(p.y), float(p.z)});
            mesh.indices = {0, 1, 2, 2, 3, 0};
            b.scene.meshes.push_back(mesh);
            b.add(MeshInstance{int(b.scene.meshes.size()) - 1}, material);
        };
        quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, gray);
        quad({-2, 0, -2}, {4, 0, 1}, {0.5, 4, 0}, gray);
        quad({-1, 3, 1}, {0, 0, -2}, {2, 0, 0}, lamp);
        b.camera({0.5, 2, 5}, {0, 0.8, 0});
        return b.scene;
    };
    const Mean a = mean_of(render_film(scene(false), small_image_settings(), 256)),
               b = mean_of(render_film(scene(true), small_image_settings(), 256));
    EXPECT_GT(a.value[0], 0.1);
    EXPECT_NEAR(a.value[0], b.value[0], 4 * std::hypot(a.error[0], b.error[0]));
}

TEST(Estimators, LightSamplingOnlyChangesTheNoise)
{
    RenderSettings settings = small_image_settings();
    const Mean with = mean_of(render_film(corner(1, {}), settings, 256));
    settings.light_sampling = false;
    const Mean without = mean_of(render_film(corner(1, {}), settings, 4096));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(with.value[c], without.value[c], 4 * std::hypot(with.error[c], without.error[c]));
}

TEST(Estimators, RouletteOnlyChangesTheNoise)
{
    RenderSettings settings = small_image_settings();
    settings.roulette_depth = 0;
    const Mean early = mean_of(render_film(corner(1, {}), settings, 512));
    settings.roulette_depth = 1000;
    const Mean never = mean_of(render_film(corner(1, {}), settings, 512));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(early.value[c], never.value[c], 4 * std::hypot(early.error[c], never.error[c]));
}

}  // namespace
}  // namespace fathom
