// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Tests of single-sided surfaces: the camera sees through their backs, but they block all other light.
namespace fathom {
namespace {

using namespace test;

Material unlit_material(Color color, bool single_sided)
{
    Material m;
    m.kind = MaterialKind::unlit;
    m.base_color.value = color;
    m.visibility.camera_backface_culling = single_sided;
    return m;
}

/// A square of 2 n^2 triangles at height z, facing +z or -z. About 50 triangles are traced as a list, more with the
/// BVH.
Mesh square(double z, bool front_up, std::uint32_t n)
{
    Mesh mesh;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j)
            mesh.positions.push_back({2.0f * float(i) / float(n) - 1, 2.0f * float(j) / float(n) - 1, float(z)});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            if (front_up)
                mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
            else
                mesh.indices.insert(mesh.indices.end(), {a, a + 1, b, a + 1, b + 1, b});
        }
    return mesh;
}

struct Layers : SceneBuilder {
    explicit Layers(std::uint32_t triangles_a_side) : n(triangles_a_side) { camera({0, 0, 5}, {0, 0, 0}, 15); }
    void add_square(double z, bool front_up, const Material& m)
    {
        scene.meshes.push_back(square(z, front_up, n));
        add(MeshInstance{int(scene.meshes.size()) - 1}, material(m));
    }
    Image picture(std::vector<Aov> aovs = {}) const
    {
        RenderSettings settings = small_image_settings(4, 4);
        settings.aovs = std::move(aovs);
        return render_film(scene, settings, 4).image(false, false);
    }
    Color color() const
    {
        const Image image = picture();
        const auto& p = image.layers[0].pixels;
        return {p[0], p[1], p[2]};
    }
    std::uint32_t n;
};

constexpr Color red_color{1, 0, 0}, green_color{0, 1, 0}, blue_color{0, 0, 1};

/// In a closed room whose walls emit 1/2 and reflect 1/2, radiance is 1 everywhere. A camera outside sees it through a
/// wall that it passes; no path may leak out behind that wall.
TEST(SingleSided, NoPathLeaksBehindAPassedWall)
{
    for (const int spheres : {0, 100})
        for (const bool hidden : {false, true}) {
            SceneBuilder b;
            const int wall = b.diffuse(0.5f, {0.5f, 0.5f, 0.5f});
            Material seen_through = b.scene.materials[0];
            seen_through.visibility.hidden_from_camera = hidden;
            seen_through.visibility.camera_backface_culling = !hidden;
            b.add(Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, wall);
            b.add(Rectangle{{-1, 2, -1}, {2, 0, 0}, {0, 0, 2}}, wall);
            b.add(Rectangle{{-1, 0, -1}, {2, 0, 0}, {0, 2, 0}}, wall);
            b.add(Rectangle{{-1, 0, 1}, {0, 0, -2}, {0, 2, 0}}, wall);
            b.add(Rectangle{{1, 0, -1}, {0, 0, 2}, {0, 2, 0}}, wall);
            b.add(Rectangle{{-1, 0, 1}, {0, 2, 0}, {2, 0, 0}}, b.material(seen_through));
            // Spheres outside select how rays are traced.
            for (int i = 0; i < spheres; ++i) b.add(Sphere{{3 - 0.1 * i, -3, 0}, 0.02, {}}, wall);
            b.camera({0.1, 1.05, 3.4}, {0, 1, 0});
            const Film film = render_film(b.scene, small_image_settings(24, 24), 64);
            const Mean m = mean_of(film);
            EXPECT_NEAR(m.value[0], 1, 2e-3) << (hidden ? "hidden" : "culled") << ", " << spheres << " spheres";
        }
}

TEST(SingleSided, CamerasLookThroughBacks)
{
    for (const std::uint32_t n : {1u, 20u}) {
        for (const bool front_up : {true, false}) {
            Layers scene(n);
            scene.add_square(0, front_up, unlit_material(red_color, true));
            scene.add_square(-1, true, unlit_material(green_color, true));
            EXPECT_EQ(scene.color(), front_up ? red_color : green_color) << n;
        }
        Layers scene(n);
        scene.add_square(0, false, unlit_material(red_color, false));
        scene.add_square(-1, true, unlit_material(green_color, true));
        EXPECT_EQ(scene.color(), red_color) << "of two sides, " << n;
    }
}
TEST(SingleSided, ManyBacksInARow)
{
    for (const std::uint32_t n : {1u, 20u}) {
        Layers scene(n);
        for (int i = 0; i < 5; ++i) scene.add_square(1 - 0.1 * i, false, unlit_material(red_color, true));
        scene.add_square(0, true, unlit_material(blue_color, true));
        EXPECT_EQ(scene.color(), blue_color) << n;
        // Without a surface behind the backs, the background is visible.
        Layers open(n);
        open.add_square(0, false, unlit_material(red_color, true));
        EXPECT_EQ(open.color(), (Color{0, 0, 0})) << n;
    }
}
TEST(SingleSided, LayersDescribeTheVisibleSurface)
{
    for (const std::uint32_t n : {1u, 20u}) {
        Layers scene(n);
        Material m = unlit_material(red_color, true);
        m.kind = MaterialKind::diffuse;
        scene.add_square(0, false, m);
        m.base_color.value = {0.25f, 0.5f, 0.75f};
        scene.add_square(-1, true, m);
        const Image image = scene.picture({Aov::albedo, Aov::depth, Aov::normal});
        EXPECT_NEAR(image.find("depth")->pixels[0], 6, 1e-4) << n;
        EXPECT_NEAR(image.find("albedo")->pixels[1], 0.5, 1e-6) << n;
        EXPECT_NEAR(image.find("normal")->pixels[2], 1, 1e-5) << n;
    }
}
/// Single-sided surfaces block light from both sides.
TEST(SingleSided, LightDoesNotPass)
{
    for (const std::uint32_t n : {1u, 20u})
        for (const bool front_up : {true, false}) {
            Layers scene(n);
            scene.scene.cameras[0].position = {0, 0, 0.5};
            Material white;
            scene.add_square(0, true, white);
            white.visibility.camera_backface_culling = true;
            scene.add_square(1, front_up, white);
            Light sun;
            sun.kind = LightKind::directional;
            sun.intensity = {1, 1, 1};
            scene.light(sun, rotate_to({0, 0, -1}));
            EXPECT_LT(scene.color().g, 1e-6f) << n << front_up;
        }
}
/// Mirrors show back sides: culling applies to camera rays only.
TEST(SingleSided, MirrorsShowBacks)
{
    for (const std::uint32_t n : {1u, 20u}) {
        Layers scene(n);
        Material mirror;
        mirror.kind = MaterialKind::metal;
        mirror.base_color.value = {1, 1, 1};
        scene.add_square(0, true, mirror);
        // The camera is between mirror and square, whose front faces away from both.
        scene.scene.cameras[0].position = {0, 0, 0.5};
        scene.add_square(1, true, unlit_material(red_color, true));
        EXPECT_EQ(scene.color(), red_color) << n;
    }
}

}  // namespace
}  // namespace fathom
