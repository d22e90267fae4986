// SPDX-License-Identifier: Apache-2.0
// Tests of third-party scenes against images rendered by Mitsuba 3 and pbrt-v4.
#include <filesystem>

#include "fathom/image.h"
#include "fathom/load.h"
#include "picture_helpers.h"

namespace fathom::test {
namespace {

/// Expects the mean radiance of the scene's image within 2 % beyond the noise.
void expect_mean_of(const std::filesystem::path& file, const std::filesystem::path& reference_file)
{
    Warnings warnings;
    const SceneDescription scene = load_scene(file, {}, warnings);
    const Image reference = read_image(reference_file);
    RenderSettings settings;
    settings.width = reference.width, settings.height = reference.height;
    settings.filter = Filter::box;
    settings.max_depth = scene.hints.max_depth.value_or(-1);
    const Mean ours = mean_of(render_film(scene, settings, 32));
    double theirs[3] = {};
    const Image::Layer& layer = reference.layers.at(0);
    const std::size_t channels = layer.channels.size(), pixels = layer.pixels.size() / channels;
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) theirs[c] += layer.pixels[channels * i + c] / double(pixels);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(ours.value[c], theirs[c], 0.02 * theirs[c] + 3 * ours.error[c]) << file << ' ' << c;
}

/// Scenes whose only approximations are facets and plastic.
TEST(ReferenceScenes, MeansMatchMitsuba)
{
    const std::filesystem::path folder = std::filesystem::path(FATHOM_SHARED_SCENES) / "mitsuba";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
    for (const char* name : {"veach-mis", "modern-hall"})
        expect_mean_of(folder / name / "scene.xml", folder / name / "reference.exr");
}

/// The scene is converted without approximations: it has diffuse surfaces, metal and glass.
TEST(ReferenceScenes, MeansMatchPbrt)
{
    const std::filesystem::path folder = std::filesystem::path(FATHOM_SHARED_SCENES) / "pbrt-v4/veach-ajar";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
    expect_mean_of(folder / "veach-ajar.pbrt", folder / "reference-pbrt.exr");
}

}  // namespace
}  // namespace fathom::test
