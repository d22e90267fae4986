// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "compile/scene_data.h"
#include "fathom/image.h"
#include "fathom/render.h"

// Color images with declared primaries are converted to Rec.709; data images are not.
namespace fathom {
namespace {

constexpr float color[3] = {0.8f, 0.05f, 1.5f};

/// A single pixel written with these primaries.
ImageFile picture(Primaries primaries)
{
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("fathom_primaries_" + std::to_string(getpid()) + ".exr");
    Image image;
    image.width = image.height = 1;
    image.layers.push_back({"", {"R", "G", "B"}, {color, color + 3}});
    WriteOptions options;
    options.exr_primaries = primaries;
    write_image(file, image, options);
    return {"picture", file, {}};
}

TEST(Chromaticities, ColorsAreConvertedNumbersAreNot)
{
    SceneDescription d;
    d.cameras.emplace_back();
    d.nodes.emplace_back();
    d.nodes[0].camera = 0;
    d.roots = {0};
    d.images = {picture(Primaries::acescg)};
    d.environment.kind = EnvironmentKind::image;
    d.environment.image = 0;
    d.textures.resize(2);
    d.textures[0].image = d.textures[1].image = 0;
    d.textures[0].color_space = ColorSpace::srgb;
    d.textures[1].color_space = ColorSpace::linear;
    d.materials.resize(1);
    d.materials[0].base_color.texture = 0;
    d.materials[0].roughness.texture = 1;
    Warnings warnings;
    const Scene scene = Scene::compile(d, "", warnings);
    std::filesystem::remove(d.images[0].path);
    EXPECT_TRUE(warnings.empty());
    const SceneTables& tables = *scene.data().tables;
    ASSERT_EQ(tables.environment.texels.size(), 4u);
    ASSERT_EQ(tables.texels.size(), 8u);
    // The rows are those of the matrix in the ACES configurations.
    constexpr double acescg[3][3] = {
        {0.6130974, 0.3395231, 0.0473795}, {0.0701937, 0.9163539, 0.0134524}, {0.0206156, 0.1095698, 0.8698146}};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(tables.environment.texels[i], color[i], 1e-6);
        EXPECT_NEAR(tables.texels[i], color[i], 1e-6);
        double as_stored = 0;
        for (std::size_t k = 0; k < 3; ++k) as_stored += acescg[i][k] * double(color[k]);
        EXPECT_NEAR(tables.texels[4 + i], as_stored, 1e-6);
    }
}

}  // namespace
}  // namespace fathom
