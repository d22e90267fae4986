// SPDX-License-Identifier: Apache-2.0
#include "lights/compile/textured_emission.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "compile/compiled_scenes.h"
#include "kernel/kernel.h"

namespace fathom {
namespace {

class Chance {
public:
    explicit Chance(unsigned seed) : engine_(seed) {}
    double operator()(double lo, double hi) { return lo + (hi - lo) * double(engine_() >> 8) * 0x1p-24; }
    int index(int n) { return int(engine_() % unsigned(n)); }

private:
    std::mt19937 engine_;
};

/// Tables of one image texture whose texels are given by a function of column and row.
template <class Texel>
ShadingTables image_of(TexelFormat format, int width, int height, const Texel& texel)
{
    ShadingTables t;
    for (std::size_t i = 0; i < 256; ++i) t.linear_of_srgb[i] = float(std::pow(double(i) / 255, 2.2));
    TextureRecord image;
    image.kind = std::uint32_t(TextureKind::image);
    image.format = std::uint32_t(format);
    image.width = width, image.height = height;
    t.packed_images.emplace_back();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float value = texel(x, y);
            const auto code = std::uint32_t(value * 255 + 0.5f), wide = code * 257;
            // Half a unit below 1 is 0x3800; only 0 and this value are used.
            const std::uint32_t half = value > 0 ? 0x3800 : 0;
            switch (format) {
                case TexelFormat::float4:
                    t.texels.insert(t.texels.end(), {value, value, value, 1});
                    break;
                case TexelFormat::bytes:
                case TexelFormat::bytes_srgb:
                    t.packed_images[0].push_back(code * 0x010101 | 0xff000000);
                    break;
                default: {
                    const std::uint32_t c = format == TexelFormat::halves ? half : wide;
                    t.packed_images[0].insert(t.packed_images[0].end(), {c << 16 | c, 0xffff0000 | c});
                }
            }
        }
    t.textures.push_back(image);
    return t;
}

/// A triangle with these texture coordinates in both sets.
GeometryTables triangle(const Vec2f (&uv)[3])
{
    GeometryTables g;
    g.triangles = {0, 1, 2};
    g.uv0.assign(uv, uv + 3);
    g.uv1 = g.uv0;
    return g;
}

ShapeRecord with_coordinates()
{
    ShapeRecord shape;
    shape.flags = ShapeRecord::has_uv0 | ShapeRecord::has_uv1;
    return shape;
}

/// Largest luminance that shading reads at random points of a triangle, its corners and its edges.
double largest_lookup(const ShadingTables& t, const Vec2f (&uv)[3], Chance& chance)
{
    std::vector<KernelTexturePoint> points;
    for (int i = 0; i < 300; ++i) {
        double w[3] = {chance(0, 1), chance(0, 1), chance(0, 1)};
        if (i < 60) w[i % 3] = 0;
        if (i < 30) w[(i + 1) % 3] = 0;
        const double sum = w[0] + w[1] + w[2];
        KernelTexturePoint p{};
        for (int k = 0; k < 3; ++k) {
            p.uv[0].x += float(w[k] / sum) * uv[k].x, p.uv[0].y += float(w[k] / sum) * uv[k].y;
        }
        p.uv[1] = p.uv[0];
        points.push_back(p);
    }
    std::vector<float> values(points.size());
    look_up_texture(t, 0, luminance_channel, points.data(), points.size(), values.data());
    return double(*std::max_element(values.begin(), values.end()));
}

/// Where shading reads light anywhere on a triangle, the mean is not 0, for all wrap modes, formats and maps of the
/// coordinates; and most triangles away from the bright texels are known to be black.
TEST(TexturedEmission, IsZeroOnlyOnBlackTriangles)
{
    Chance chance(1);
    int black = 0, really_black = 0;
    for (int round = 0; round < 2000; ++round) {
        const int width = 1 + chance.index(90), height = 1 + chance.index(90);
        const int bright_x = chance.index(width), bright_y = chance.index(height);
        ShadingTables t = image_of(TexelFormat(round % 5), width, height,
                                   [&](int x, int y) { return x == bright_x && y == bright_y ? 0.5f : 0.f; });
        TextureRecord& image = t.textures[0];
        image.wrap_u = std::uint32_t(chance.index(3)), image.wrap_v = std::uint32_t(chance.index(3));
        image.nearest = std::uint32_t(chance.index(2)), image.uv_set = std::uint32_t(chance.index(2));
        image.uv_map = {float(chance(-2, 2)), float(chance(-1, 1)), float(chance(-1, 1)),
                        float(chance(-1, 1)), float(chance(-2, 2)), float(chance(-1, 1))};
        // In some rounds the map brings coordinates back that are far from the origin, where floats are coarse.
        const double far = round % 7 == 0 ? 1000 : 0;
        image.uv_map[2] -= float(far) * image.uv_map[0], image.uv_map[5] -= float(far) * image.uv_map[3];
        const double x = far + chance(-3, 3), y = chance(-3, 3), size = chance(0, 1) < 0.5 ? 0.05 : 1;
        const auto corner = [&] { return Vec2f{float(x + chance(-size, size)), float(y + chance(-size, size))}; };
        const Vec2f uv[3] = {corner(), corner(), corner()};
        const std::optional<double> mean =
            TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), with_coordinates(), 0);
        ASSERT_TRUE(mean) << round;
        const double largest = largest_lookup(t, uv, chance);
        if (largest > 0) EXPECT_GT(*mean, 0) << round;
        black += *mean == 0, really_black += largest == 0;
    }
    EXPECT_GT(black, really_black / 2);
    EXPECT_GT(really_black, 500);
}

/// The mean is that of the blocks around the triangle: exact for an image of one value, and that of the left half in
/// the left half.
TEST(TexturedEmission, IsTheMeanLuminance)
{
    for (int format = 0; format < 5; ++format) {
        const bool is_srgb = TexelFormat(format) == TexelFormat::bytes_srgb;
        const double half = is_srgb                                      ? std::pow(128.0 / 255, 2.2)
                            : TexelFormat(format) == TexelFormat::bytes  ? 128.0 / 255
                            : TexelFormat(format) == TexelFormat::shorts ? 128.0 * 257 / 65535
                                                                         : 0.5;
        const ShadingTables all = image_of(TexelFormat(format), 50, 30, [](int, int) { return 0.5f; });
        const Vec2f anywhere[3] = {{0.2f, 0.3f}, {1.7f, 0.4f}, {0.3f, -2.1f}};
        EXPECT_NEAR(
            *TexturedEmission(all, all.textures[0]).over(all.textures[0], triangle(anywhere), with_coordinates(), 0),
            half, 1e-5)
            << format;
        const ShadingTables left =
            image_of(TexelFormat(format), 256, 64, [](int x, int) { return x < 128 ? 0.5f : 0.f; });
        const Vec2f inside[3] = {{0.1f, 0.1f}, {0.4f, 0.2f}, {0.2f, 0.8f}};
        EXPECT_NEAR(
            *TexturedEmission(left, left.textures[0]).over(left.textures[0], triangle(inside), with_coordinates(), 0),
            half, 1e-5)
            << format;
        const Vec2f across[3] = {{0.25f, 0.1f}, {0.75f, 0.2f}, {0.4f, 0.8f}};
        EXPECT_NEAR(
            *TexturedEmission(left, left.textures[0]).over(left.textures[0], triangle(across), with_coordinates(), 0),
            half / 2, half / 20);
    }
}

/// The mean of other textures, of meshes without coordinates, and far from the origin is unknown.
TEST(TexturedEmission, IsUnknownWhereItCannotBeSummed)
{
    ShadingTables t = image_of(TexelFormat::bytes, 8, 8, [](int, int) { return 0.f; });
    const Vec2f uv[3] = {{0, 0}, {1, 0}, {0, 1}}, far[3] = {{0, 0}, {1e9f, 0}, {0, 1}},
                nan[3] = {{0, 0}, {NAN, 0}, {0, 1}};
    EXPECT_EQ(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), with_coordinates(), 0), 0.);
    EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), ShapeRecord(), 0));
    EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(far), with_coordinates(), 0));
    EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(nan), with_coordinates(), 0));
    // Terms that cancel: the sum is near the origin.
    const Vec2f away[3] = {{1e6f, 0}, {1e6f + 1, 0}, {1e6f, 1}};
    t.textures[0].uv_map[2] = -1e6f;
    EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(away), with_coordinates(), 0));
    t.textures[0].uv_map[2] = 0;
    for (Wrap wrap : {Wrap::black, Wrap::octahedral}) {
        t.textures[0].wrap_u = std::uint32_t(wrap);
        EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), with_coordinates(), 0));
    }
    t.textures[0].wrap_u = 0;
    t.textures[0].mapping = std::uint32_t(TextureMapping::planar);
    EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), with_coordinates(), 0));
    t.textures[0].kind = std::uint32_t(TextureKind::noise);
    EXPECT_FALSE(TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), with_coordinates(), 0));
}

/// A large value of a float image counts, and a negative one does not cancel it.
TEST(TexturedEmission, CountsExtremeTexels)
{
    const ShadingTables t = image_of(TexelFormat::float4, 8, 8, [](int x, int) { return x == 3 ? 1e30f : -1e30f; });
    const Vec2f uv[3] = {{0, 0}, {1, 0}, {0, 1}};
    EXPECT_NEAR(*TexturedEmission(t, t.textures[0]).over(t.textures[0], triangle(uv), with_coordinates(), 0), 0x1p16,
                1);
    const ShadingTables faint =
        image_of(TexelFormat::float4, 8, 8, [](int x, int y) { return x == 3 && y == 3 ? 1e-30f : 0.f; });
    EXPECT_GT(*TexturedEmission(faint, faint.textures[0]).over(faint.textures[0], triangle(uv), with_coordinates(), 0),
              0);
}

/// A mesh of two squares, of which a texture of two columns lights one.
SceneDescription half_lit(bool is_other_lit)
{
    SceneDescription d = empty_scene();
    std::string file = "PF\n2 1\n-1\n";
    const float texels[6] = {0, 0, 0, 0.6f, 0.6f, 0.6f};
    file.append(reinterpret_cast<const char*>(texels), sizeof texels);
    ImageFile image;
    image.name = "lit.pfm";
    for (char c : file) image.bytes.push_back(std::byte(c));
    d.images.push_back(image);
    Texture texture;
    texture.kind = TextureKind::image;
    texture.image = 0;
    texture.wrap_u = texture.wrap_v = Wrap::clamp;
    d.textures.push_back(texture);
    Mesh mesh;
    const float u[2] = {-2, is_other_lit ? 4.f : -2};
    for (int square = 0; square < 2; ++square)
        for (int corner = 0; corner < 4; ++corner) {
            mesh.positions.push_back({float(square * 2 + corner % 2), float(corner / 2), -5});
            mesh.uvs[0].push_back({u[square], 0.5f});
        }
    for (std::uint32_t square = 0; square < 2; ++square)
        for (std::uint32_t k : {0u, 1u, 2u, 1u, 3u, 2u}) mesh.indices.push_back(square * 4 + k);
    d.meshes.push_back(mesh);
    const int lamp = add_lamp(d, 3);
    d.materials[std::size_t(lamp)].emission.radiance.texture = 0;
    d.nodes[0].shapes.push_back({MeshInstance{0}, lamp, ""});
    return d;
}

/// Black triangles are neither selected nor in the light tree. If all lights are black, they are selected like others.
TEST(LightTable, BlackTrianglesAreNotSelected)
{
    const Scene scene = compiled(half_lit(true));
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 4u);
    EXPECT_EQ(t.black_lights, (std::vector<std::uint32_t>{1, 1, 0, 0}));
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_FLOAT_EQ(t.lights[i].pmf, i < 2 ? 0 : 0.5f) << i;
        EXPECT_EQ(t.lights[i].tree_place == no_index, i < 2) << i;
    }
    EXPECT_EQ(t.light_tree.size(), 1u);
    EXPECT_EQ(t.light_tree[0].count, 2u);
    const Scene black = compiled(half_lit(false));
    EXPECT_TRUE(black.data().tables->black_lights.empty());
    for (const LightRecord& light : black.data().tables->lights) EXPECT_FLOAT_EQ(light.pmf, 0.25f);
}

/// A light without area is selected: it may have one between the keys of its motion.
TEST(LightTable, LightsWithoutAreaAreNotBlack)
{
    SceneDescription d = half_lit(true);
    Mesh line;
    line.positions = {{0, 0, -4}, {1, 0, -4}, {2, 0, -4}};
    line.indices = {0, 1, 2};
    d.meshes.push_back(line);
    d.nodes[0].shapes.push_back({MeshInstance{1}, add_lamp(d, 3), ""});
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 5u);
    EXPECT_EQ(t.black_lights, (std::vector<std::uint32_t>{1, 1, 0, 0, 0}));
    EXPECT_GT(t.lights[4].pmf, 0);
}

}  // namespace
}  // namespace fathom
