// SPDX-License-Identifier: Apache-2.0
/// Tests of the records that training paths make on a floor under a white sky.
#include <gtest/gtest.h>

#include <numbers>

#include "compile/scene_data.h"
#include "film/film_data.h"
#include "integrate/light_tracing_scenes.h"
#include "session/job.h"

namespace fathom {
namespace {

using namespace test;

Material diffuse_of(float albedo)
{
    Material m;
    m.base_color.value = {albedo, albedo, albedo};
    return m;
}

/// Records of paths through one pixel that shows a floor of the material. Lights are found by scattered rays only.
GuidingRecords records_on(const Material& material)
{
    SceneBuilder b;
    b.add(Rectangle{{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}}, b.material(material));
    // Scenes of rectangles alone are not guided, and record nothing.
    b.add(Sphere{{0, -3, 0}, 0.02, {}}, b.diffuse(0.5f));
    b.camera({0, 1, 0.5}, {0, 0, 0});
    b.scene.environment = uniform_sky();
    Warnings warnings;
    const RenderJob job(Scene::compile(b.scene, "", warnings), small_image_settings(1, 1));
    KernelSettings settings;
    settings.width = settings.height = 1;
    settings.light_sampling = false;
    settings.film_words = std::size_t(FilmLayout({}, false).words);
    settings.aovs = FilmLayout({}, false);
    const std::uint32_t pixel = 0;
    GuidingRecords records;
    TileSums sums;
    sums.reset(1, settings.film_words);
    KernelCounters counters;
    render_job(*job.scene().data().kernel, job.data().camera_record, settings, {&pixel, 1, 0, 64, &records}, sums,
               counters);
    return records;
}

/// A diffuse surface of color c reflects c, so a path that is sampled by the cosine brings c, with a density of
/// cosine / pi.
TEST(GuidingRecords, HoldWhatDirectionsOfDiffuseSurfacesBring)
{
    const GuidingRecords records = records_on(diffuse_of(0.6f));
    ASSERT_EQ(records.surfaces.size(), 64u);
    for (const GuidingRecord& r : records.surfaces) {
        EXPECT_NEAR(r.contribution, 0.6, 1e-5);
        EXPECT_NEAR(r.value, std::numbers::pi, 1e-4);
        EXPECT_NEAR(r.throughput, 0.65, 1e-5);
        EXPECT_EQ(r.guidable, GuidingRecord::fully_guidable);
        EXPECT_GT(r.bsdf_pdf, 0);
        EXPECT_LE(r.bsdf_pdf, float(1 / std::numbers::pi) * 1.0001f);
    }
}

/// A smooth metal has a narrow lobe: a path brings as much as from a diffuse surface, while incident radiance over
/// density is small for most directions.
TEST(GuidingRecords, HoldWhatNarrowLobesBring)
{
    const GuidingRecords records = records_on(conductor(0.1f, 0.9f));
    ASSERT_GT(records.surfaces.size(), 32u);
    std::size_t small = 0;
    for (const GuidingRecord& r : records.surfaces) {
        EXPECT_GT(r.contribution, 0.7);
        small += r.value < 1;
        EXPECT_NEAR(r.guidable / 255.0, 0.2, 0.01);
        EXPECT_NEAR(r.throughput, 0.95, 1e-3);
    }
    EXPECT_GT(small, records.surfaces.size() * 3 / 4);
}

}  // namespace
}  // namespace fathom
