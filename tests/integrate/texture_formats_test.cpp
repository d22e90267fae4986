// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <random>

#include "fathom/image.h"
#include "picture_helpers.h"

// Textures keep their values in any file format and use the smallest sufficient storage.
namespace fathom {
namespace {

constexpr int image_side = 64;

struct Kind {
    const char* file;
    WriteOptions write;
    ColorSpace space;
    double bytes_per_texel;
    float most;  ///< largest value
};

const Kind kinds[] = {
    {"8.png", {}, ColorSpace::srgb, 4, 1},
    {"8-linear.png", {}, ColorSpace::linear, 4, 1},
    {"16.png", {.display = {}, .png_bits = 16}, ColorSpace::srgb, 16, 1},
    {"16-linear.png", {.display = {}, .png_bits = 16}, ColorSpace::linear, 8, 1},
    {"half.exr", {.display = {}, .exr_half = true}, ColorSpace::srgb, 8, 1000},
    {"float.exr", {}, ColorSpace::srgb, 16, 1000},
    {"photo.hdr", {}, ColorSpace::srgb, 8, 1000},
};

Image noise(bool alpha, float most)
{
    Image image;
    image.width = image.height = image_side;
    image.layers.push_back({"", {"R", "G", "B"}, {}});
    if (alpha) image.layers[0].channels.push_back("A");
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int i = 0; i < image_side * image_side; ++i) {
        // Values are premultiplied and range down to the smallest halves.
        const float a = alpha ? uniform(random) : 1;
        for (int c = 0; c < 3; ++c)
            image.layers[0].pixels.push_back(a * most * (i % 7 == 0 ? uniform(random) * 1e-7f : uniform(random)));
        if (alpha) image.layers[0].pixels.push_back(a);
    }
    return image;
}

/// A square that shows the texture with one texel per pixel. It extends beyond the image because rays may miss the very
/// edge of a square.
SceneDescription square(const std::filesystem::path& file, ColorSpace space)
{
    test::SceneBuilder b;
    b.scene.images.push_back({"image", file, {}});
    Texture texture;
    texture.image = 0;
    texture.color_space = space;
    texture.nearest = true;
    texture.wrap_u = texture.wrap_v = Wrap::clamp;
    texture.uv_scale = {2, 2};
    texture.uv_offset = {-0.5f, -0.5f};
    b.scene.textures.push_back(texture);
    Material m;
    m.kind = MaterialKind::unlit;
    m.base_color = {{1, 1, 1}, 0};
    b.add(Rectangle{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}}, b.material(m));
    b.camera({0, 0, 5}, {0, 0, 0});
    b.scene.cameras[0].kind = CameraKind::orthographic;
    b.scene.cameras[0].height = 2;
    return b.scene;
}

class TextureFormats : public testing::TestWithParam<Kind> {
protected:
    TextureFormats()
    {
        // Tests run in parallel, so each needs its own file.
        std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        std::replace(name.begin(), name.end(), '/', '-');
        file_ = std::filesystem::temp_directory_path() / ("fathom-texture-" + name + "-" + GetParam().file);
    }
    ~TextureFormats() override { std::filesystem::remove(file_); }
    std::filesystem::path file_;
};

double linear_from_srgb(double v)
{
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

TEST_P(TextureFormats, ShowTheValuesOfTheFile)
{
    const Kind& kind = GetParam();
    write_image(file_, noise(false, kind.most), kind.write);
    const Image stored = read_image(file_);
    const SceneDescription scene = square(file_, kind.space);
    const Image shown =
        test::render_film(scene, test::small_image_settings(image_side, image_side), 1).image(false, false);
    const bool decode = kind.space == ColorSpace::srgb && !stored.is_linear;
    for (std::size_t i = 0; i < stored.layers[0].pixels.size(); ++i) {
        const double v = double(stored.layers[0].pixels[i]), expected = decode ? linear_from_srgb(v) : v;
        // A film rounds to 2^-36.
        ASSERT_NEAR(double(shown.layers[0].pixels[i]), expected, 3e-7 * expected + 0x1p-36) << i;
    }
}

TEST_P(TextureFormats, TakeNoMoreMemoryThanTheyMust)
{
    const Kind& kind = GetParam();
    write_image(file_, noise(false, kind.most), kind.write);
    SceneDescription scene = square(file_, kind.space);
    Warnings warnings;
    const std::size_t with = Scene::compile(scene, "", warnings).statistics().memory_bytes;
    scene.textures[0].kind = TextureKind::checker_uv;
    const std::size_t without = Scene::compile(scene, "", warnings).statistics().memory_bytes;
    EXPECT_EQ(double(with - without), kind.bytes_per_texel * image_side * image_side);
}

/// Filtered values between texels and beyond the edge equal those of a float file.
TEST_P(TextureFormats, MixTexelsAlike)
{
    const Kind& kind = GetParam();
    write_image(file_, noise(false, kind.most), kind.write);
    const Image stored = read_image(file_);
    Image decoded = stored;
    if (kind.space == ColorSpace::srgb && !stored.is_linear)
        for (float& v : decoded.layers[0].pixels) v = float(linear_from_srgb(double(v)));
    // This value has no exact half, so storage stays float.
    decoded.layers[0].pixels[0] = 0.1f;
    SceneDescription scene = square(file_, kind.space);
    scene.textures[0].nearest = false;
    scene.textures[0].wrap_u = Wrap::mirror;
    scene.textures[0].uv_scale = {1.7f, 2.1f};
    const Image shown =
        test::render_film(scene, test::small_image_settings(image_side, image_side), 1).image(false, false);
    const std::filesystem::path floats = file_.string() + ".exr";
    write_image(floats, decoded, {});
    scene.images[0].path = floats;
    const Image expected =
        test::render_film(scene, test::small_image_settings(image_side, image_side), 1).image(false, false);
    std::filesystem::remove(floats);
    int different = 0;
    for (std::size_t i = 0; i < shown.layers[0].pixels.size(); ++i) {
        const double a = double(shown.layers[0].pixels[i]), b = double(expected.layers[0].pixels[i]);
        different += std::abs(a - b) > 2e-6 * double(kind.most);
    }
    // The changed texel affects at most 4 x 4 pixels in each of 6 repetitions.
    EXPECT_LE(different, 3 * 6 * 16);
}

class TextureAlpha : public TextureFormats {};

TEST_P(TextureAlpha, DecidesWhatIsCutAway)
{
    const Kind& kind = GetParam();
    write_image(file_, noise(true, 1), kind.write);
    const Image stored = read_image(file_);
    SceneDescription scene = square(file_, kind.space);
    scene.materials[0].opacity.mode = AlphaMode::mask;
    scene.materials[0].opacity.alpha = {1, 0, 3};
    scene.materials[0].opacity.cutoff = 101.0f / 255;
    scene.materials[0].base_color = {{1, 1, 1}, -1};
    const Image shown =
        test::render_film(scene, test::small_image_settings(image_side, image_side), 1).image(false, false);
    for (std::size_t i = 0; i < std::size_t(image_side) * image_side; ++i)
        ASSERT_EQ(shown.layers[0].pixels[3 * i], stored.layers[0].pixels[4 * i + 3] >= 101.0f / 255 ? 1 : 0) << i;
}

const auto file_of = [](const auto& test) {
    std::string name = test.param.file;
    std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return name;
};
// The scene has no lights at all: nothing may be looked up in the empty light table.
TEST(UnlitSquare, ShowsItsColorWithoutLights)
{
    test::SceneBuilder b;
    Material m;
    m.kind = MaterialKind::unlit;
    m.base_color.value = {0.25f, 0.5f, 1};
    b.add(Rectangle{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}}, b.material(m));
    b.camera({0, 0, 5}, {0, 0, 0}, 20);
    const Image shown = test::render_film(b.scene, test::small_image_settings(8, 8), 1).image(false, false);
    for (std::size_t i = 0; i < shown.layers[0].pixels.size(); ++i)
        ASSERT_EQ(shown.layers[0].pixels[i], (std::array{0.25f, 0.5f, 1.0f}[i % 3])) << i;
}

INSTANTIATE_TEST_SUITE_P(All, TextureFormats, testing::ValuesIn(kinds), file_of);
// Formats with a separate alpha channel.
INSTANTIATE_TEST_SUITE_P(Png, TextureAlpha, testing::ValuesIn(kinds, kinds + 4), file_of);

}  // namespace
}  // namespace fathom
