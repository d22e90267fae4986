// SPDX-License-Identifier: Apache-2.0
/// Tests of media in Mitsuba files: inside shapes and around them.
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "mitsuba_fixture.h"

namespace fathom::test {
namespace {

/// Absorption and scattering both attenuate a straight ray: exp(-sigma_t * distance) remains.
TEST_F(Mitsuba, Interiors)
{
    const SceneDescription scene =
        read(R"(<shape type="sphere"><bsdf type="dielectric"/><medium type="homogeneous" name="interior">
<rgb name="sigma_t" value="1 2 4"/><rgb name="albedo" value="0 0.5 0"/><float name="scale" value="3"/></medium></shape>)");
    const Material& m = material_of(scene);
    const auto sigma = [&](float left) { return -std::log(left) / m.interior.attenuation_distance; };
    EXPECT_NEAR(sigma(m.interior.attenuation_color.r), 3, 1e-4);
    EXPECT_NEAR(sigma(m.interior.attenuation_color.g), 6, 1e-4);
    EXPECT_NEAR(sigma(m.interior.attenuation_color.b), 12, 1e-4);
    EXPECT_NEAR(m.interior.scatter.g / m.interior.attenuation_distance, 3, 1e-4);
    EXPECT_TRUE(m.interior.scatter_bounces);
}

/// A null interface keeps the medium of its shape.
TEST_F(Mitsuba, InteriorsBehindNull)
{
    constexpr const char* medium =
        R"(<medium type="homogeneous" name="interior"><float name="sigma_t" value="2"/></medium></shape>)";
    const SceneDescription scene = read(fmt::format(R"(<shape type="sphere"><bsdf type="null"/>{})", medium));
    const Material& m = material_of(scene);
    EXPECT_EQ(m.kind, MaterialKind::glass);
    EXPECT_EQ(m.ior, 1);
    EXPECT_NEAR(m.interior.scatter.r / m.interior.attenuation_distance, 2 * 0.75, 1e-4);
    EXPECT_FALSE(has_warning("solid of index 1"));
    const Material sheet =
        material_of(read(fmt::format(R"(<shape type="sphere"><bsdf type="thindielectric"/>{})", medium)));
    EXPECT_TRUE(sheet.interior.thin);
    EXPECT_NEAR(sheet.interior.scatter.r / sheet.interior.attenuation_distance, 2 * 0.75, 1e-4);
    read(fmt::format(R"(<shape type="sphere"><bsdf type="diffuse"/>{})", medium));
    EXPECT_TRUE(has_warning("is supported inside glass only"));
}

/// The phase function belongs to the medium, whatever its boundary is.
TEST_F(Mitsuba, PhaseFunctions)
{
    for (const char* boundary : {"null", "dielectric"})
        for (const auto& [phase, mean_cosine] :
             {std::pair{R"(<phase type="hg"><float name="g" value="0.3"/></phase>)", 0.3f},
              std::pair{R"(<phase type="hg"/>)", 0.8f}, std::pair{R"(<phase type="isotropic"/>)", 0.f},
              std::pair{"", 0.f}}) {
            const SceneDescription scene = read(fmt::format(
                R"(<shape type="sphere"><bsdf type="{}"/><medium type="homogeneous" name="interior">{}</medium></shape>)",
                boundary, phase));
            EXPECT_EQ(material_of(scene).interior.scatter_anisotropy, mean_cosine) << boundary << phase;
        }
}

constexpr const char* fog = R"(<medium type="homogeneous" id="fog"><float name="sigma_t" value="2"/></medium>)";
constexpr const char* camera_in_fog =
    R"(<sensor type="perspective"><transform name="to_world"><translate x="9"/></transform><ref name="medium" id="fog"/></sensor>)";

/// The camera's medium fills all space that no other medium occupies.
TEST_F(Mitsuba, MediumAroundTheCamera)
{
    const SceneDescription scene =
        read(std::string(fog) + camera_in_fog +
             R"(<shape type="sphere"><bsdf type="diffuse"/><ref name="exterior" id="fog"/></shape>
<emitter type="point"><ref name="medium" id="fog"/></emitter>)");
    EXPECT_TRUE(warnings_.counts().empty());
    const Shape& around = scene.nodes.at(std::size_t(scene.roots.back())).shapes.at(0);
    const Sphere& ball = std::get<Sphere>(around.geometry);
    // Bounds extend from -1 to 9 along x, and from -1 to 1 along y and z.
    EXPECT_NEAR(ball.center.x, 4, 1e-6);
    EXPECT_NEAR(ball.radius, std::sqrt(10 * 10 + 2 * 2 + 2 * 2), 1e-6);
    const Material& m = scene.materials.at(std::size_t(around.material));
    EXPECT_EQ(m.interior.priority, -1000);
    EXPECT_EQ(m.ior, 1);
    EXPECT_NEAR(-std::log(m.interior.attenuation_color.r) / m.interior.attenuation_distance, 2, 1e-4);
    EXPECT_NEAR(m.interior.scatter.r / m.interior.attenuation_distance, 2 * 0.75, 1e-4);
    read(std::string(fog) + camera_in_fog + R"(<emitter type="constant"/>)");
    EXPECT_TRUE(has_warning("the environment is outside"));
}

TEST_F(Mitsuba, MediaOutsideOfShapes)
{
    const std::string shape =
        R"(<shape type="sphere"><bsdf type="dielectric"/><ref name="exterior" id="fog"/></shape>)";
    EXPECT_EQ(read(fog + shape).nodes.size(), 1u);
    EXPECT_TRUE(has_warning("surrounds shapes, but is neither inside a shape nor around the camera"));
    warnings_ = {};
    read(fog + shape + R"(<shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>)");
    EXPECT_TRUE(warnings_.counts().empty()) << "the medium is used by another shape";
}

}  // namespace
}  // namespace fathom::test
