// SPDX-License-Identifier: Apache-2.0
/// Tests of white furnaces: enclosures and skies of uniform radiance.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

TEST(Furnace, EnclosureHasTheRadianceOfTheGeometricSeries)
{
    // Inside a sphere with emission 1 and albedo a, radiance is 1 / (1 - a) everywhere.
    for (bool light_sampling : {true, false})
        for (float albedo : {0.5f, 0.8f}) {
            SceneBuilder b;
            b.add(Sphere{{0, 0, 0}, -1, {}}, b.diffuse(albedo, {1, 1, 1}));
            b.camera({0.3, 0.1, 0.2}, {1, 0, 0}, 60);
            RenderSettings settings = small_image_settings();
            settings.light_sampling = light_sampling;
            expect_mean(render_film(b.scene, settings, 64), 1 / (1 - albedo));
        }
}

TEST(Furnace, ClosedRoomOfRectangles)
{
    SceneBuilder b;
    const int wall = b.diffuse(0.6f, {1, 1, 1}, true);
    b.add(Box{{-1, -1, -1}, {1, 1, 1}}, wall);
    b.camera({0.3, 0.1, 0.2}, {1, 0, 0}, 60);
    expect_mean(render_film(b.scene, small_image_settings(), 256), 2.5);
}

TEST(Furnace, EveryMaterialUnderAWhiteSky)
{
    // A convex lossless object is invisible in a constant environment.
    const auto expect = [](Material m, double value, double tolerance) {
        m.base_color.value = {1, 1, 1};
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(m));
        b.scene.environment = uniform_sky();
        b.camera({0, 0, 2.2}, {0, 0, 0}, 30);
        expect_mean(render_film(b.scene, small_image_settings(), 64), value, tolerance);
    };
    Material m;
    for (float roughness : {0.0f, 0.5f, 1.0f}) {
        m.roughness.value = roughness;
        m.kind = MaterialKind::diffuse;
        expect(m, 1, 0.002);
        m.kind = MaterialKind::metal;
        expect(m, 1, 0.012);
        m.kind = MaterialKind::principled;
        m.metallic.value = 1;
        expect(m, 1, 0.015);
        m.metallic.value = 0;
    }
    m.kind = MaterialKind::glass;
    m.roughness.value = 0;
    expect(m, 1, 0.002);
    m.kind = MaterialKind::fuzz_metal;
    m.fuzz = 0;
    expect(m, 1, 0.002);
}

/// Russian roulette adds no noise without losses: each path through glass carries exactly the sky's radiance.
TEST(Furnace, LosslessPathsHaveNoVariance)
{
    for (const bool thin : {false, true}) {
        SceneBuilder b;
        Material glass;
        glass.kind = MaterialKind::glass;
        glass.interior.thin = thin;
        const int m = b.material(glass);
        if (thin)
            for (int i = 0; i < 4; ++i) b.add(Rectangle{{-50, -50, -2.0 - i}, {100, 0, 0}, {0, 100, 0}}, m);
        else
            for (int i = 0; i < 2; ++i) b.add(Sphere{{0, 0, -6.0 - 5 * i}, 2, {}}, m);
        b.scene.environment = uniform_sky();
        b.camera({0, 0, 0}, {0, 0, -1}, 30);
        const Mean mean = mean_of(render_film(b.scene, small_image_settings(), 64));
        EXPECT_NEAR(mean.value[0], 1, 1e-4);
        EXPECT_LT(mean.error[0], 1e-5);
    }
}

/// In a closed lossless room paths still end, after about 64 + 20 bounces. A black light of radiance 1 gives a radiance
/// of 1 everywhere.
TEST(Furnace, PathsEndInAClosedWhiteRoom)
{
    for (const bool lamp : {false, true}) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, -1, {}}, b.diffuse(1));
        if (lamp) b.add(Sphere{{0, 0, 0}, 0.5, {}}, b.diffuse(0, {1, 1, 1}));
        b.camera({0.3, 0.6, 0.2}, {1, 0.6, 0}, 60);
        Warnings warnings;
        const Scene scene = Scene::compile(b.scene, "", warnings);
        const RenderSettings settings = small_image_settings();
        const RenderJob job(scene, settings);
        Film film(job);
        std::uint64_t rays = 0;
        render(job, {0, 64}, film, nullptr,
               [&](const Progress& progress, const Film&) { rays = progress.costs.all_rays(); });
        expect_mean(film, lamp ? 1 : 0, 0.001);
        const double rays_per_path = double(rays) / (64 * 32 * 24);
        if (lamp)
            EXPECT_LT(rays_per_path, 2 * (64 + 20));
        else
            EXPECT_NEAR(rays_per_path, 64 + 20, 2);
    }
}

TEST(Furnace, TheSameForATreeOfTriangles)
{
    // An octahedron subdivided into enough triangles to need the BVH.
    SceneBuilder b;
    constexpr std::uint32_t n = 16;
    const Mesh mesh = octahedron_mesh(n, [](Vec3d sign, std::uint32_t i, std::uint32_t j) {
        return Vec3f{float(sign.x) * float(i) / n, float(sign.y) * float(j) / n, float(sign.z) * float(n - i - j) / n};
    });
    b.scene.meshes.push_back(mesh);
    b.add(MeshInstance{0}, b.diffuse(1));
    b.scene.environment = uniform_sky();
    b.camera({1, 2, 3}, {0, 0, 0}, 20);
    expect_mean(render_film(b.scene, small_image_settings(), 32), 1);
}

}  // namespace
}  // namespace fathom
