// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <filesystem>
#include <fstream>
#include <random>

#include "fathom/error.h"
#include "fathom/image.h"
#include "picture_helpers.h"

// Tests that image files are decoded in parallel without any effect on the result.
namespace fathom {
namespace {

constexpr int squares = 5, pixels_per_square = 5, side = squares * pixels_per_square;

class TextureDecoding : public testing::Test {
protected:
    TextureDecoding()
    {
        // Tests run in parallel, so each needs its own folder.
        folder_ = std::filesystem::temp_directory_path() /
                  (std::string("fathom-decoding-") + testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    ~TextureDecoding() override { std::filesystem::remove_all(folder_); }

    /// A noise image for each number; formats and sizes vary so that files finish decoding in a different order than
    /// they start.
    std::filesystem::path picture(int number)
    {
        static const char* const extensions[] = {"png", "exr", "hdr", "png"};
        const std::filesystem::path file = folder_ / (std::to_string(number) + "." + extensions[number % 4]);
        Image image;
        image.width = image.height = number % 3 == 0 ? 512 : 8;
        image.layers.push_back({"", {"R", "G", "B"}, {}});
        std::mt19937 random(static_cast<unsigned>(number));
        for (int i = 0; i < image.width * image.height * 3; ++i)
            image.layers[0].pixels.push_back(std::uniform_real_distribution<float>(0, 1)(random));
        // 16-bit sRGB images and float EXR files are stored as floats.
        write_image(file, image, {.display = {}, .png_bits = number % 4 == 0 ? 8 : 16});
        return file;
    }

    /// Unlit squares, each of which shows one texture, under an image environment.
    SceneDescription scene()
    {
        test::SceneBuilder b;
        for (int i = 0; i < squares * squares; ++i) {
            b.scene.images.push_back({"image", picture(i), {}});
            Texture texture;
            // Some images are used twice, some in both color spaces.
            texture.image = i % 7 == 6 ? i - 3 : i;
            texture.color_space = i % 7 == 6 ? ColorSpace::linear : ColorSpace::srgb;
            b.scene.textures.push_back(texture);
            Material m;
            m.kind = MaterialKind::unlit;
            m.base_color = {{1, 1, 1}, i};
            b.add(Rectangle{{double(i % squares), double(i / squares), 0}, {1, 0, 0}, {0, 1, 0}}, b.material(m));
        }
        b.scene.environment.kind = EnvironmentKind::image;
        b.scene.environment.image = 5;
        b.camera({squares / 2.0, squares / 2.0, 5}, {squares / 2.0, squares / 2.0, 0});
        b.scene.cameras[0].kind = CameraKind::orthographic;
        b.scene.cameras[0].height = squares;
        return b.scene;
    }

    std::filesystem::path folder_;
};

struct Outcome {
    std::vector<float> pixels;
    std::map<std::string, std::size_t> warnings;
    std::size_t memory_bytes = 0;
};

Outcome compile_with(int threads, const SceneDescription& description)
{
    const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 8);
    Outcome outcome;
    Warnings warnings;
    tbb::task_arena(threads).execute([&] {
        const Scene scene = Scene::compile(description, "", warnings);
        const RenderJob job(scene, test::small_image_settings(side, side));
        Film film(job);
        render(job, {0, 4}, film);
        outcome.pixels = film.image(false, false).layers[0].pixels;
        outcome.memory_bytes = scene.statistics().memory_bytes;
    });
    outcome.warnings = warnings.counts();
    return outcome;
}

TEST_F(TextureDecoding, IsTheSameForAnyNumberOfThreads)
{
    SceneDescription description = scene();
    // One file is missing, one is truncated, and one is not an image.
    std::filesystem::remove(description.images[2].path);
    std::filesystem::resize_file(description.images[12].path, 300);
    std::ofstream(description.images[19].path) << "no picture";
    const Outcome one = compile_with(1, description);
    EXPECT_EQ(one.warnings.size(), 3u);
    for (const int threads : {2, 3, 8}) {
        const Outcome many = compile_with(threads, description);
        EXPECT_EQ(many.pixels, one.pixels) << threads;
        EXPECT_EQ(many.warnings, one.warnings) << threads;
        EXPECT_EQ(many.memory_bytes, one.memory_bytes) << threads;
    }
}

TEST_F(TextureDecoding, GivesEachTextureItsOwnPicture)
{
    SceneDescription description = scene();
    const auto value = [](int i) { return float(i + 1) / 51; };  // an 8-bit code, but not exact as a half
    for (int i = 0; i < squares * squares; ++i) {
        Image image;
        image.width = image.height = i % 3 == 0 ? 512 : 8;
        image.layers.push_back({"", {"R", "G", "B"}, {}});
        image.layers[0].pixels.assign(std::size_t(image.width) * std::size_t(image.height) * 3, value(i));
        description.images[std::size_t(i)].path = folder_ / (std::to_string(i) + ".exr");
        write_image(description.images[std::size_t(i)].path, image, {});
    }
    const Outcome outcome = compile_with(8, description);
    for (int i = 0; i < squares * squares; ++i) {
        // This is the square's center; rows of the image go down, squares go up.
        const int x = i % squares * pixels_per_square + 2, y = side - 1 - i / squares * pixels_per_square - 2;
        const float shown = outcome.pixels[std::size_t(3 * (y * side + x))];
        EXPECT_NEAR(shown, value(description.textures[std::size_t(i)].image), 1e-6f) << i;
    }
}

TEST_F(TextureDecoding, ObeysALimitOfMemory)
{
    const std::filesystem::path file = picture(0);
    // The limit allows three floats for each texel, converted to four bytes.
    EXPECT_NO_THROW(read_image(file, 512 * 512 * 16));
    EXPECT_THROW(read_image(file, 512 * 512 * 16 - 1), Error);
}

}  // namespace
}  // namespace fathom
