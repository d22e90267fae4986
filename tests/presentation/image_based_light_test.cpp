// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "fathom/image.h"
#include "fathom/lighting.h"
#include "fathom/render.h"
#include "fathom/scene_file.h"
#include "formats/import_test_helpers.h"

// Tests of EXT_lights_image_based of glTF: the environment as the camera sees it.
namespace fathom::test {
namespace {

/// Linear colors of the faces +x, -x, +y, -y, +z, -z. Each channel is at an end of the sRGB range, so that files keep
/// it exactly.
constexpr Color colors[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};
constexpr Vec3d axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

class ImageBasedLight : public ImportTest {
protected:
    /// A file with an image-based light; `members` are the light's JSON members besides the faces.
    std::filesystem::path file_with(const std::string& members)
    {
        std::string images;
        for (int i = 0; i < 6; ++i) {
            Image face;
            face.width = face.height = 4;
            face.layers.push_back({"", {"R", "G", "B"}, {}});
            for (int k = 0; k < 16; ++k)
                face.layers[0].pixels.insert(face.layers[0].pixels.end(), {colors[i].r, colors[i].g, colors[i].b});
            write_image(folder_ / fmt::format("{}.png", i), face, {});
            images += fmt::format(R"({}{{"uri": "{}.png"}})", i > 0 ? ", " : "", i);
        }
        return write("a.gltf",
                     fmt::format(R"({{"asset": {{"version": "2.0"}}, "extensionsUsed": ["EXT_lights_image_based"],
            "extensionsRequired": ["EXT_lights_image_based"], "images": [{}],
            "extensions": {{"EXT_lights_image_based": {{"lights": [{{"specularImageSize": 4,
                "specularImages": [[0, 1, 2, 3, 4, 5]]{}}}]}}}},
            "scene": 0, "scenes": [{{"nodes": [0], "extensions": {{"EXT_lights_image_based": {{"light": 0}}}}}}],
            "nodes": [{{"camera": 0}}], "cameras": [{{"type": "perspective", "perspective": {{"yfov": 0.1, "znear": 1}}}}]}})",
                                 images, members));
    }
    /// Color that a narrow camera sees in a direction.
    Color seen(const SceneDescription& scene, Vec3d direction)
    {
        SceneDescription posed = scene;
        Camera& camera = posed.cameras.at(0);
        camera.look_at = direction;
        camera.up = direction.y == 0 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
        RenderSettings settings;
        settings.width = settings.height = 2;
        const RenderJob job(Scene::compile(posed, "", warnings_), settings);
        Film film(job);
        render(job, {0, 1}, film);
        const std::vector<float> pixels = film.image(false, false).layers[0].pixels;
        return {pixels.at(0), pixels.at(1), pixels.at(2)};
    }
    void expect_seen(const SceneDescription& scene, Vec3d direction, Color expected)
    {
        const Color c = seen(scene, direction);
        EXPECT_NEAR(c.r, expected.r, 1e-5f);
        EXPECT_NEAR(c.g, expected.g, 1e-5f);
        EXPECT_NEAR(c.b, expected.b, 1e-5f);
    }
};

TEST_F(ImageBasedLight, EachAxisShowsItsFace)
{
    const SceneDescription scene = load_scene(file_with(""), {}, warnings_);
    for (int i = 0; i < 6; ++i) expect_seen(scene, axes[i], colors[i]);
    EXPECT_TRUE(warnings_.empty());
}

/// The rotation is by 90 degrees about y, which maps z to x.
TEST_F(ImageBasedLight, IsTurnedByItsRotation)
{
    const std::string rotation = R"(, "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476])";
    const SceneDescription scene = load_scene(file_with(rotation), {}, warnings_);
    expect_seen(scene, {1, 0, 0}, colors[4]);
    expect_seen(scene, {0, 0, 1}, colors[1]);
    expect_seen(scene, {-1, 0, 0}, colors[5]);
    expect_seen(scene, {0, 0, -1}, colors[0]);
    expect_seen(scene, {0, 1, 0}, colors[2]);
}

TEST_F(ImageBasedLight, IsMultipliedByItsIntensity)
{
    const SceneDescription scene = load_scene(file_with(R"(, "intensity": 2.5)"), {}, warnings_);
    expect_seen(scene, {1, 0, 0}, {2.5f, 0, 0});
    expect_seen(scene, {0, -1, 0}, {2.5f, 2.5f, 0});
}

TEST_F(ImageBasedLight, IsTheFilesOwnLight)
{
    SceneDescription scene = load_scene(file_with(""), {}, warnings_);
    scene.nodes[0].shapes.push_back({Sphere{{0, 0, -5}, 1, {}}, -1, ""});
    const LitScene lit = compile_lit(scene, "", LightingMode::automatic, 1, warnings_);
    EXPECT_FALSE(lit.studio);
    EXPECT_TRUE(lit.added.empty());
}

TEST_F(ImageBasedLight, AWrongOneIsNamed)
{
    const auto error = [&](const std::string& from, const std::string& to) {
        std::ifstream in(file_with(""));
        std::string text{std::istreambuf_iterator<char>(in), {}};
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos);
        return error_of("a.gltf", text.replace(at, from.size(), to));
    };
    EXPECT_EQ(error(R"({"light": 0})", R"({"light": 1})"),
              "scenes[0].extensions.EXT_lights_image_based.light: there is no image-based light 1");
    EXPECT_EQ(error(R"({"light": 0})", "{}"), "scenes[0].extensions.EXT_lights_image_based: key 'light' is missing");
    EXPECT_EQ(error("4, 5]", "4]").rfind("extensions.EXT_lights_image_based.lights[0].specularImages[0]: ", 0), 0u);
    EXPECT_EQ(error("[[0, 1, 2, 3, 4, 5]]", "[]"),
              "extensions.EXT_lights_image_based.lights[0]: key 'specularImages' is missing, or empty");
    EXPECT_EQ(error("[[0,", "[[6,").rfind("extensions.EXT_lights_image_based.lights[0].specularImages[0][0]: ", 0), 0u);
}

}  // namespace
}  // namespace fathom::test
