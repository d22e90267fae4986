// SPDX-License-Identifier: Apache-2.0
#include "textures/textures.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

/// A distinct value for each texel and channel, as an 8-bit code that each format represents.
int code_of(int x, int y, int channel)
{
    return 3 + x * 17 + y * 40 + channel * 60;
}

constexpr int width = 4, height = 3;

ShadingTables picture(TexelFormat format, TextureRecord& t)
{
    ShadingTables tables;
    t.format = std::uint32_t(format);
    t.width = width, t.height = height;
    std::vector<std::uint32_t> words;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::uint32_t word = 0;
            for (int c = 0; c < 4; ++c) {
                tables.texels.push_back(float(code_of(x, y, c)) / 255);
                word |= std::uint32_t(code_of(x, y, c) & 0xff) << (8 * c);
            }
            words.push_back(word);
        }
    if (format != TexelFormat::float4) tables.packed_images = {{}, words}, t.texels = 1;
    return tables;
}

double value(int x, int y, int channel)
{
    return (code_of(x, y, channel) & 0xff) / 255.0;
}

int wrapped(int i, int size, Wrap mode)
{
    if (mode == Wrap::clamp) return std::clamp(i, 0, size - 1);
    if (mode == Wrap::repeat) return (i % size + size) % size;
    // Texels repeat as 0 1 2 2 1 0 0 1 2 ...
    const int r = (i % (2 * size) + 2 * size) % (2 * size);
    return r < size ? r : 2 * size - 1 - r;
}

/// Lookups at texel centers return the texel in each channel, also beyond the edges; halfway between two texels they
/// return the mean, or the nearest one.
TEST(ImageTexture, TexelsInEachWrapMode)
{
    for (const bool packed : {false, true})
        for (const Wrap wrap_u : {Wrap::repeat, Wrap::clamp, Wrap::mirror})
            for (const Wrap wrap_v : {Wrap::repeat, Wrap::clamp, Wrap::mirror})
                for (const bool nearest : {false, true}) {
                    TextureRecord t;
                    ShadingTables tables = picture(packed ? TexelFormat::bytes : TexelFormat::float4, t);
                    // Both storage formats hold equal values of 8 bits.
                    for (int i = 0; !packed && i < int(tables.texels.size()); ++i)
                        tables.texels[std::size_t(i)] = float(value(i / 4 % width, i / 4 / width, i % 4));
                    t.wrap_u = std::uint32_t(wrap_u), t.wrap_v = std::uint32_t(wrap_v);
                    t.nearest = nearest;
                    for (int x = -9; x < 10; ++x)
                        for (int y = -7; y < 8; ++y) {
                            const int tx = wrapped(x, width, wrap_u), ty = wrapped(y, height, wrap_v);
                            const Float u((float(x) + 0.5f) / width), v((float(y) + 0.5f) / height);
                            const Texel at = lookup_image(tables, t, u, v, Mask(true));
                            const int next = wrapped(x + 1, width, wrap_u);
                            const Texel right = lookup_image(tables, t, u + Float(0.25f / width), v, Mask(true));
                            const Texel below = lookup_image(tables, t, u, v + Float(0.25f / height), Mask(true));
                            const int under = wrapped(y + 1, height, wrap_v);
                            for (int c = 0; c < 4; ++c) {
                                ASSERT_NEAR(first(at.c[c]), value(tx, ty, c), 3e-6) << x << " " << y << " " << c;
                                ASSERT_NEAR(
                                    first(right.c[c]),
                                    nearest ? value(tx, ty, c) : 0.75 * value(tx, ty, c) + 0.25 * value(next, ty, c),
                                    3e-6)
                                    << x << " " << y << " " << c;
                                ASSERT_NEAR(
                                    first(below.c[c]),
                                    nearest ? value(tx, ty, c) : 0.75 * value(tx, ty, c) + 0.25 * value(tx, under, c),
                                    3e-6)
                                    << x << " " << y << " " << c;
                            }
                        }
                }
}

TEST(ImageTexture, BytesInSrgbAreDecodedBeforeTheyAreMixedButNotAlpha)
{
    TextureRecord t;
    ShadingTables tables = picture(TexelFormat::bytes_srgb, t);
    for (std::size_t i = 0; i < 256; ++i) tables.linear_of_srgb[i] = float(i * i) / (255.f * 255);
    const Texel at =
        lookup_image(tables, t, Float(0.25f), Float(0.5f), Mask(true));  // the point is between texels 0 and 1 of row 1
    for (int c = 0; c < 4; ++c) {
        const double a = value(0, 1, c), b = value(1, 1, c);
        EXPECT_NEAR(first(at.c[c]), c < 3 ? (a * a + b * b) / 2 : (a + b) / 2, 1e-6);
    }
}

TEST(ImageTexture, HalvesAndShorts)
{
    for (std::uint32_t half = 0; half < 0x10000; ++half) {
        if ((half & 0x7c00) == 0x7c00) continue;
        const double magnitude = half & 0x7c00 ? std::ldexp(1024 + (half & 0x3ff), int(half >> 10 & 31) - 25)
                                               : std::ldexp(half & 0x3ff, -24);
        ASSERT_EQ(first(detail::float_of_half(UInt(half))), half & 0x8000 ? -magnitude : magnitude) << half;
    }
    ShadingTables tables;
    TextureRecord t;
    t.width = t.height = 1;
    tables.packed_images = {{0x3c00u | 0x4000u << 16, 0x4200u | 0x4400u << 16}};  // the halves 1, 2, 3, 4
    t.format = std::uint32_t(TexelFormat::halves);
    for (int c = 0; c < 4; ++c)
        EXPECT_EQ(first(lookup_image(tables, t, Float(0.2f), Float(0.7f), Mask(true)).c[c]), c + 1);
    t.format = std::uint32_t(TexelFormat::shorts);
    tables.packed_images = {{65535u | 0u << 16, 13107u | 52428u << 16}};
    const double shorts[] = {1, 0, 0.2, 0.8};
    for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(first(lookup_image(tables, t, Float(0.2f), Float(0.7f), Mask(true)).c[c]), shorts[c], 1e-7);
}

TexturePoint point(double u0, double v0, double u1, double v1, Vec3d p = {})
{
    return {{Float(float(u0)), Float(float(u1))},
            {Float(float(v0)), Float(float(v1))},
            Vec3(Vec3f{float(p.x), float(p.y), float(p.z)}),
            Vec3(Vec3f{0, 0, 1}),
            {Float(1), Float(1), Float(1), Float(1)}};
}

/// A texture that mixes two colors, so that the weight of the second can be recovered; alpha likewise.
TextureRecord mixed(TextureKind kind)
{
    TextureRecord t;
    t.kind = std::uint32_t(kind);
    t.color_a = {0, 1, 0.5f, 1};
    t.color_b = {1, 0, 0.75f, 1};
    return t;
}

double share(const TextureRecord& t, const TexturePoint& at)
{
    const ShadingTables tables;
    const Texel texel = TextureGraph(tables).evaluate(t, at, Mask(true));
    const double s = first(texel.c[0]);
    EXPECT_NEAR(first(texel.c[1]), 1 - s, 2e-6);
    EXPECT_NEAR(first(texel.c[2]), 0.5 + 0.25 * s, 2e-6);
    EXPECT_EQ(first(texel.c[3]), 1);
    return s;
}

TEST(Textures, UvSetAndMap)
{
    TextureRecord t;
    ShadingTables tables = picture(TexelFormat::float4, t);
    // The map is (u, v) -> (0.5 u + 0.25 v + 0.1, -0.125 u + v + 0.3).
    t.uv_map = {0.5f, 0.25f, 0.1f, -0.125f, 1, 0.3f};
    t.nearest = 1;
    for (const bool second : {false, true}) {
        t.uv_set = second;
        for (const auto& [u, v] : {std::pair{0.1, 0.2}, {0.9, 0.1}, {0.4, 0.6}}) {
            const TexturePoint at = second ? point(7, 8, u, v) : point(u, v, 7, 8);
            const Texel texel = TextureGraph(tables).evaluate(t, at, Mask(true));
            const int x = wrapped(int(std::floor((0.5 * u + 0.25 * v + 0.1) * width)), width, Wrap::repeat);
            const int y = wrapped(int(std::floor((-0.125 * u + v + 0.3) * height)), height, Wrap::repeat);
            for (int c = 0; c < 4; ++c) EXPECT_NEAR(first(texel.c[c]), code_of(x, y, c) / 255.0, 1e-6);
        }
    }
}

TEST(Textures, Checkers)
{
    TextureRecord uv = mixed(TextureKind::checker_uv);
    uv.scale = 3;
    TextureRecord space = mixed(TextureKind::checker_space);
    space.scale = 2;
    test::Random random;
    for (int i = 0; i < 500; ++i) {
        const double a = first(random.next()) * 8 - 4, b = first(random.next()) * 8 - 4,
                     c = first(random.next()) * 8 - 4;
        const int cells = int(std::floor(float(a) * 3)) + int(std::floor(float(b) * 3));
        EXPECT_EQ(share(uv, point(a, b, 0, 0)), std::abs(cells) % 2);
        const double product = std::sin(2 * a) * std::sin(2 * b) * std::sin(2 * c);
        if (std::abs(product) < 1e-4) continue;
        EXPECT_EQ(share(space, point(0, 0, 0, 0, {a, b, c})), product < 0);
    }
}

// Noise is reimplemented from the paper in double precision.

std::uint32_t mix_bits(std::uint32_t x)
{
    x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu, x ^= x >> 16;
    return x;
}

/// Noise by Perlin 2002: dot products with the twelve edges of a cube, four of them twice.
double perlin(double x, double y, double z)
{
    static const double edges[16][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                                        {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
                                        {1, 1, 0},  {0, -1, 1},  {-1, 1, 0}, {0, -1, -1}};
    const double p[3] = {x, y, z};
    int cell[3];
    double f[3], fade[3];
    for (int i = 0; i < 3; ++i) {
        cell[i] = int(std::floor(p[i]));
        f[i] = p[i] - cell[i];
        fade[i] = f[i] * f[i] * f[i] * (f[i] * (f[i] * 6 - 15) + 10);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int d[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        const auto number = [&](int i) { return std::uint32_t(cell[i] + d[i]); };
        const double* edge = edges[mix_bits(number(0) + mix_bits(number(1) + mix_bits(number(2)))) & 15];
        double weight = 1, slope = 0;
        for (int i = 0; i < 3; ++i) {
            weight *= d[i] ? fade[i] : 1 - fade[i];
            slope += edge[i] * (f[i] - d[i]);
        }
        sum += weight * slope;
    }
    return sum;
}

double turbulence(Vec3d p, int octaves)
{
    double sum = 0;
    for (int i = 0; i < octaves; ++i, p = p * 2) sum += std::abs(perlin(p.x, p.y, p.z)) / (1 << i);
    return sum;
}

TEST(Textures, NoiseOfThePaper)
{
    TextureRecord t = mixed(TextureKind::noise);
    // Noise is zero at lattice points.
    for (const Vec3d& p : {Vec3d{0, 0, 0}, {3, -2, 7}, {-100, 5, 1}})
        EXPECT_NEAR(share(t, point(0, 0, 0, 0, p)), 0.5, 1e-6);
    TextureRecord turbulent = mixed(TextureKind::turbulence), marble = mixed(TextureKind::marble);
    t.scale = 1.5f, turbulent.scale = 0.75f, marble.scale = 2.5f;
    turbulent.octaves = 3, marble.octaves = 4;
    marble.turbulence_weight = 6;
    test::Random random;
    double largest = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3d p{float(first(random.next()) * 8 - 4), float(first(random.next()) * 8 - 4),
                      float(first(random.next()) * 8 - 4)};
        const TexturePoint at = point(0, 0, 0, 0, p);
        const double noise = perlin(1.5 * p.x, 1.5 * p.y, 1.5 * p.z);
        largest = std::max(largest, std::abs(noise));
        EXPECT_NEAR(share(t, at), 0.5 + 0.5 * noise, 1e-5);
        EXPECT_NEAR(share(turbulent, at), turbulence(p * 0.75, 3), 2e-5);
        // The scale applies to the stripes, not to the turbulence.
        EXPECT_NEAR(share(marble, at), 0.5 + 0.5 * std::sin(2.5 * p.z + 6 * turbulence(p, 4)), 2e-4);
    }
    EXPECT_GT(largest, 0.5);
}

TEST(Textures, EachLaneHasItsOwn)
{
    ShadingTables tables;
    for (int i = 0; i < 3; ++i) {
        TextureRecord t = mixed(TextureKind::checker_uv);
        for (float& c : t.color_a) c = float(i + 2);
        tables.textures.push_back(t);
    }
    std::uint32_t ids[lanes];
    for (int i = 0; i < lanes; ++i) ids[i] = i % 4 == 0 ? no_index : std::uint32_t(3 - i % 4);
    const Texel t = evaluate_textures(tables, load(ids), point(0.5, 0.5, 0, 0), Mask(true));
    float values[lanes];
    store(values, t.c[1]);
    for (int i = 0; i < lanes; ++i) EXPECT_EQ(values[i], i % 4 == 0 ? 1 : float(3 - i % 4 + 2));
}

}  // namespace
}  // namespace fathom
