// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// Expects the mean radiance to agree with the mean of two independent renderers with billions of samples.
void expect_cornell(const char* name, const double (&expected)[3])
{
    Warnings warnings;
    const SceneDescription scene = load_scene(std::string(FATHOM_SCENES) + "/" + name, {}, warnings);
    RenderSettings settings = small_image_settings(800, 600);
    settings.max_depth = 50;
    const Mean m = mean_of(render_film(scene, settings, 64));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(m.value[c], expected[c], 4 * m.error[c]) << name << " channel " << c;
        EXPECT_NEAR(m.value[c] / expected[c], 1, 0.001) << name << " channel " << c;
    }
}

constexpr double white_wall[3] = {0.130159, 0.116655, 0.105854}, mirror_wall[3] = {0.134117, 0.119446, 0.107389};

TEST(Cornell, MeanRadiance)
{
    expect_cornell("cornell-box.json", white_wall);
}
TEST(Cornell, MeanRadianceOfTriangles)
{
    expect_cornell("cornell-box-triangles.json", white_wall);
}
TEST(Cornell, MeanRadianceWithTheMirrorWall)
{
    expect_cornell("cornell-box-mirror.json", mirror_wall);
}

}  // namespace
}  // namespace fathom
