// SPDX-License-Identifier: Apache-2.0
// Third-party scenes compared with images rendered by Mitsuba 3.
#include <filesystem>

#include "fathom/image.h"
#include "fathom/load.h"
#include "picture_helpers.h"

namespace fathom::test {
namespace {

/// Mean radiance of scenes whose only approximations are facets and plastic: within 2 % beyond the noise.
TEST(MitsubaScenes, MeansAsMitsubaHasThem)
{
    const std::filesystem::path folder = std::filesystem::path(FATHOM_SHARED_SCENES) / "mitsuba";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
    for (const char* name : {"veach-mis", "modern-hall"}) {
        Warnings warnings;
        const SceneDescription scene = load_scene(folder / name / "scene.xml", {}, warnings);
        const Image reference = read_image(folder / name / "reference.exr");
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
            EXPECT_NEAR(ours.value[c], theirs[c], 0.02 * theirs[c] + 3 * ours.error[c]) << name << ' ' << c;
    }
}

}  // namespace
}  // namespace fathom::test
