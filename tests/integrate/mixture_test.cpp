// SPDX-License-Identifier: Apache-2.0
#include "fathom/error.h"
#include "picture_helpers.h"

// Tests of materials that choose between two others at random.
namespace fathom {
namespace {

using namespace test;

Material diffuse(Color color)
{
    Material m;
    m.base_color.value = color;
    return m;
}

Material mirror(Color color)
{
    Material m;
    m.kind = MaterialKind::metal;
    m.base_color.value = color;
    return m;
}

/// A square that fills the image in a white environment shows its albedo. Optionally seen from behind, with two
/// triangles or enough for the BVH.
struct Square : SceneBuilder {
    explicit Square(bool from_behind = false, std::uint32_t n = 1)
    {
        camera({0, 0, from_behind ? -5.0 : 5.0}, {0, 0, 0}, 15);
        scene.environment.kind = EnvironmentKind::constant;
        scene.environment.color = {1, 1, 1};
        Mesh mesh;
        for (std::uint32_t i = 0; i <= n; ++i)
            for (std::uint32_t j = 0; j <= n; ++j) {
                mesh.positions.push_back({2.0f * float(i) / float(n) - 1, 2.0f * float(j) / float(n) - 1, 0});
                mesh.uvs[0].push_back({float(i) / float(n), float(j) / float(n)});
            }
        for (std::uint32_t i = 0; i < n; ++i)
            for (std::uint32_t j = 0; j < n; ++j) {
                const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
                mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
            }
        scene.meshes.push_back(mesh);
    }
    int mix(int a, int b, FloatInput factor)
    {
        Material m;
        m.kind = MaterialKind::mix;
        m.mixture.material_a = a, m.mixture.material_b = b;
        m.mixture.factor = factor;
        return material(m);
    }
    int two_sided(int front, int back)
    {
        Material m;
        m.kind = MaterialKind::two_sided;
        m.mixture.material_a = front, m.mixture.material_b = back;
        return material(m);
    }
    Film film(int index, std::vector<Aov> aovs = {})
    {
        add(MeshInstance{0}, index);
        RenderSettings settings = small_image_settings(16, 16);
        settings.aovs = std::move(aovs);
        return render_film(scene, settings, 256);
    }
    void expect(int index, Color expected)
    {
        const Mean m = mean_of(film(index));
        const float values[] = {expected.r, expected.g, expected.b};
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.value[c], values[c], 4 * m.error[c] + 1e-3) << "channel " << c;
    }
};

TEST(Mixture, HasItsShareOfEach)
{
    for (const std::uint32_t n : {1u, 20u})
        for (const float factor : {0.f, 0.3f, 1.f}) {
            Square square(false, n);
            const int a = square.material(diffuse({0.8f, 0.2f, 0})), b = square.material(mirror({0, 0.6f, 1}));
            square.expect(square.mix(a, b, {factor, -1, 0}), {0.8f * (1 - factor), 0.2f + 0.4f * factor, factor});
        }
}

TEST(Mixture, OfMixturesHasTheProduct)
{
    Square square;
    const int a = square.material(diffuse({1, 0, 0})), b = square.material(mirror({0, 1, 0})),
              c = square.material(diffuse({0, 0, 1}));
    // The inner mixture follows the outer one in the list.
    const int outer = square.mix(c, int(square.scene.materials.size()) + 1, {0.6f, -1, 0});
    square.mix(a, b, {0.25f, -1, 0});
    square.expect(outer, {0.6f * 0.75f, 0.6f * 0.25f, 0.4f});
}

TEST(Mixture, FactorByTexture)
{
    Square square;
    Texture halves;
    halves.kind = TextureKind::checker_uv;
    halves.scale = 1;
    halves.uv_scale = {2, 1};
    halves.color_a.value = {1, 0.2f, 0}, halves.color_b.value = {1, 0.6f, 0};
    square.scene.textures.push_back(halves);
    const int a = square.material(diffuse({1, 0, 0.5f})), b = square.material(diffuse({0, 1, 0.5f}));
    // The green channel has two values, so each half has weights 0.2 and 0.6.
    square.expect(square.mix(a, b, {1, 0, 1}), {0.6f, 0.4f, 0.5f});
}

TEST(Mixture, ShowsEachSideItsOwn)
{
    for (const bool behind : {false, true}) {
        Square square(behind);
        const int a = square.material(diffuse({0.8f, 0.2f, 0})), b = square.material(mirror({0, 0.6f, 1}));
        square.expect(square.two_sided(a, b), behind ? Color{0, 0.6f, 1} : Color{0.8f, 0.2f, 0});
    }
}

TEST(Mixture, OfGlassLetsItsShareThrough)
{
    Square square;
    Material sheet;
    sheet.kind = MaterialKind::glass;
    sheet.interior.thin = true;
    const int glass = square.material(sheet), black = square.material(diffuse({0, 0, 0}));
    // A thin glass sheet in a white environment is white.
    square.expect(square.mix(glass, black, {0.7f, -1, 0}), {0.3f, 0.3f, 0.3f});
}

/// In a white environment equal albedos look alike; in front of one light behind the camera they don't.
TEST(Mixture, ScattersAsEachOfThem)
{
    for (const std::uint32_t n : {1u, 20u}) {
        Square square(false, n);
        square.scene.environment.kind = EnvironmentKind::none;
        Material lamp = diffuse({0, 0, 0});
        lamp.emission.radiance.value = {1, 1, 1};
        const int rotate_to = square.material(lamp), black = square.material(diffuse({0, 0, 0})),
                  metal = square.material(mirror({0.5f, 0.6f, 0.7f}));
        square.add(Rectangle{{-2, -2, 6}, {0, 4, 0}, {4, 0, 0}}, rotate_to);
        square.expect(square.mix(black, metal, {0.25f, -1, 0}), {0.125f, 0.15f, 0.175f});
    }
}

/// The albedo layer of a mixture averages the albedos of the sampled parts.
TEST(Mixture, HasAnAlbedo)
{
    Square square;
    const int a = square.material(diffuse({0.8f, 0.2f, 0})), b = square.material(diffuse({0, 0.6f, 1}));
    const Film film = square.film(square.mix(a, b, {0.5f, -1, 0}), {Aov::albedo});
    const Image image = film.image(false, false);
    const auto& albedo = image.find("albedo")->pixels;
    double mean[3] = {};
    for (std::size_t i = 0; i < albedo.size(); ++i) mean[i % 3] += albedo[i] / (double(albedo.size()) / 3);
    const double expected[] = {0.4, 0.4, 0.5};
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 0.01) << c;
}

/// Emission and alpha are the mixture's own; those of its parts are ignored.
TEST(Mixture, EmitsByItself)
{
    Square square;
    Material glowing = diffuse({0, 0, 0});
    glowing.emission.radiance.value = {9, 9, 9};
    glowing.opacity.mode = AlphaMode::blend;
    glowing.opacity.alpha.value = 0;
    const int part = square.material(glowing);
    const int mixture = square.mix(part, part, {0.5f, -1, 0});
    square.scene.materials.back().emission.radiance.value = {0.25f, 0.5f, 0.75f};
    square.scene.environment.kind = EnvironmentKind::none;
    square.expect(mixture, {0.25f, 0.5f, 0.75f});
}

TEST(Mixture, OneSidedBackIsBlack)
{
    for (const bool behind : {false, true})
        for (Material m : {diffuse({0.5f, 0.5f, 0.5f}), mirror({0.5f, 0.5f, 0.5f})}) {
            Square square(behind);
            m.visibility.black_back = true;
            square.expect(square.material(m), behind ? Color{0, 0, 0} : Color{0.5f, 0.5f, 0.5f});
        }
}

TEST(Mixture, OfItselfIsRefused)
{
    Square square;
    const int a = square.material(diffuse({1, 1, 1}));
    const int first = square.mix(a, int(square.scene.materials.size()) + 1, {0.5f, -1, 0});
    square.mix(a, first, {0.5f, -1, 0});
    square.add(MeshInstance{0}, first);
    Warnings warnings;
    EXPECT_THROW(Scene::compile(square.scene, "", warnings), Error);
    square.scene.materials.back().mixture.material_b = 99;
    EXPECT_THROW(Scene::compile(square.scene, "", warnings), Error);
}

}  // namespace
}  // namespace fathom
