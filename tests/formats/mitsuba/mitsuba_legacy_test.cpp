// SPDX-License-Identifier: Apache-2.0
// Tests of files of Mitsuba 0.5 and 0.6.
#include <cmath>

#include "mitsuba_fixture.h"

namespace fathom::test {
namespace {

class MitsubaLegacy : public Mitsuba {
protected:
    static std::string old_scene_of(const std::string& inside)
    {
        return "<scene version=\"0.6.0\">\n" + inside + "\n</scene>";
    }
    SceneDescription read_old(const std::string& inside) { return load("a.xml", old_scene_of(inside)); }
    Material old_bsdf(const std::string& xml)
    {
        scene_ = read_old("<shape type=\"sphere\">" + xml + "</shape>");
        return material_of(scene_);
    }
    const Material& part(int index) const { return scene_.materials.at(std::size_t(index)); }

    SceneDescription scene_;
};

TEST_F(MitsubaLegacy, Names)
{
    const SceneDescription scene = read_old(R"(<sensor type="perspective"><string name="fovAxis" value="y"/>
<float name="fov" value="50"/><transform name="toWorld"><lookAt origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></sensor>)");
    EXPECT_NEAR(camera_of(scene).fov_y, 50 * degree, 1e-12);
    expect_near(camera_of(scene).position, {0, 0, 5});
    EXPECT_NEAR(
        old_bsdf(R"(<bsdf type="dielectric"><float name="intIOR" value="2"/><float name="extIOR" value="1"/></bsdf>)")
            .ior,
        2, 1e-6)
        << "adjacent capitals form one word";
    expect_color(
        old_bsdf(R"(<bsdf type="diffuse"><rgb name="diffuseReflectance" value="1 0 0"/></bsdf>)").base_color.value, 1,
        0, 0);
}

/// A default named photonCount defines `$photonCount`.
TEST_F(MitsubaLegacy, DefaultsKeepTheirNames)
{
    const SceneDescription scene = read_old(R"(<default name="maxDepth" value="7"/>
<integrator type="path"><integer name="maxDepth" value="$maxDepth"/></integrator>)");
    EXPECT_EQ(scene.hints.max_depth, 6);
}

TEST_F(MitsubaLegacy, OneNumberIsWhiteAndSrgbIsEncoded)
{
    const auto radiance = [&](const std::string& value) {
        return old_bsdf("<emitter type=\"area\">" + value + "</emitter>").emission.radiance.value;
    };
    expect_color(radiance(R"(<spectrum name="radiance" value="12"/>)"), 12, 12, 12);
    expect_color(radiance(R"(<rgb name="radiance" value="0.5, 0.5, 1"/>)"), 0.5, 0.5, 1);
    // sRGB decoding of 0.5: (0.555 / 1.055)^2.4.
    expect_color(radiance(R"(<srgb name="radiance" value="0.5, 0.5, 1"/>)"), 0.2140411, 0.2140411, 1);
}

TEST_F(MitsubaLegacy, TexturesAreScaledThenMoved)
{
    write("t.png", "");
    const auto textured = [](const std::string& more) {
        return R"(<bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="t.png"/>)" +
               more + "</texture></bsdf>";
    };
    const auto texture = [](const SceneDescription& scene) {
        return scene.textures.at(std::size_t(material_of(scene).base_color.texture));
    };
    const auto shape = [](const std::string& bsdf) { return "<shape type=\"sphere\">" + bsdf + "</shape>"; };
    const Texture now = texture(read(
        shape(textured(R"(<transform name="to_uv"><scale x="3" y="5"/><translate x="0.5" y="0.25"/></transform>)"))));
    const Texture old = texture(read_old(shape(textured(
        R"(<float name="uscale" value="3"/><float name="vscale" value="5"/><float name="uoffset" value=".5"/><float name="voffset" value=".25"/>)"))));
    EXPECT_EQ(old.uv_scale.x, 3);
    EXPECT_EQ(old.uv_scale.y, now.uv_scale.y);
    EXPECT_EQ(old.uv_offset.x, 0.5);
    EXPECT_EQ(old.uv_offset.y, now.uv_offset.y);
    EXPECT_EQ(old.color_space, ColorSpace::srgb);
    const auto space = [&](const char* gamma) {
        return texture(read_old(shape(textured(std::string("<float name=\"gamma\" value=\"") + gamma + "\"/>"))))
            .color_space;
    };
    EXPECT_EQ(space("1.0"), ColorSpace::linear);
    EXPECT_EQ(space("2.2"), ColorSpace::srgb);
}

TEST_F(MitsubaLegacy, SkiesHaveYUp)
{
    const SceneDescription scene =
        read_old(R"(<emitter type="sunsky"><vector name="sunDirection" x="0.6" y="0.8" z="0"/>
<float name="sunRadiusScale" value="3"/></emitter>)");
    const Transform& t = scene.environment.world_from_environment;
    expect_near(t.vector({0, 1, 0}), {0, 1, 0}, 1e-9);
    expect_near(t.vector(scene.environment.to_sun), {0.6, 0.8, 0}, 1e-9);
    EXPECT_NEAR(scene.lights.at(0).angle, 3 * 0.5358 * degree, 1e-12);
}

/// The sky's axes are +x east and -z north, rotated by `toWorld`.
TEST_F(MitsubaLegacy, SunByDate)
{
    const auto sun = [&](const std::string& inside) {
        const SceneDescription scene = read_old("<emitter type=\"sky\">" + inside + "</emitter>");
        return scene.environment.world_from_environment.vector(scene.environment.to_sun);
    };
    const std::string munich =
        R"(<float name="latitude" value="48.1"/><float name="longitude" value="11.6"/><float name="timezone" value="2"/>
<integer name="year" value="2024"/><integer name="month" value="3"/><integer name="day" value="20"/><float name="hour" value="9"/>)";
    // Directions are those of Mitsuba 3.9.1 in different axes, to 0.2 degrees.
    expect_near(sun(munich), {0.908132, 0.280229, 0.311075}, 4e-3);
    expect_near(sun(munich + R"(<transform name="toWorld"><rotate y="1" angle="90"/></transform>)"),
                {0.311075, 0.280229, -0.908132}, 4e-3);
    EXPECT_NE(error_of("a.xml", old_scene_of(R"(<emitter type="sky"><integer name="month" value="13"/></emitter>)"))
                  .find("a month from 1 to 12"),
              std::string::npos);
}

TEST_F(MitsubaLegacy, PhongAndWardAreTwoMaterials)
{
    const Material phong = old_bsdf(R"(<bsdf type="phong"><float name="exponent" value="20"/>
<rgb name="diffuseReflectance" value="0.4 0.2 0"/><rgb name="specularReflectance" value="0.2 0.1 0"/></bsdf>)");
    ASSERT_EQ(phong.kind, MaterialKind::mix);
    EXPECT_FLOAT_EQ(phong.mixture.factor.value, 0.2f);
    const Material &body = part(phong.mixture.material_a), &gloss = part(phong.mixture.material_b);
    expect_color(body.base_color.value, 0.5, 0.25, 0);
    expect_color(gloss.coat.color.value, 1, 0.5, 0);
    EXPECT_NEAR(std::pow(gloss.roughness.value, 4), 2.0 / 82, 1e-6);
    EXPECT_TRUE(body.visibility.black_back && gloss.visibility.black_back);
    EXPECT_TRUE(has_warning("is approximated by a mix of a diffuse material and rough metal"));
    const Material ward = old_bsdf(R"(<bsdf type="ward"><spectrum name="diffuseReflectance" value="0"/>
<rgb name="specularReflectance" value="0.6 0.4 0.3"/><float name="alpha" value="0.25"/></bsdf>)");
    EXPECT_EQ(ward.kind, MaterialKind::principled) << "nothing of it is diffuse";
    expect_color(ward.coat.color.value, 0.6, 0.4, 0.3);
    EXPECT_FLOAT_EQ(ward.roughness.value, 0.5f);
    const Material matt = old_bsdf(R"(<bsdf type="phong"><spectrum name="specularReflectance" value="0"/></bsdf>)");
    EXPECT_EQ(matt.kind, MaterialKind::diffuse);
    expect_color(matt.base_color.value, 0.5, 0.5, 0.5);
}

TEST_F(MitsubaLegacy, OtherBsdfs)
{
    const Material rough = old_bsdf(R"(<bsdf type="roughdiffuse"><float name="alpha" value="0.5"/></bsdf>)");
    EXPECT_EQ(rough.kind, MaterialKind::diffuse);
    EXPECT_NEAR(rough.roughness.value, 0.5 / std::sqrt(2.0), 1e-6);
    const Material sheet = old_bsdf(R"(<bsdf type="difftrans"><rgb name="transmittance" value="0.1 0.2 0.3"/></bsdf>)");
    EXPECT_EQ(sheet.diffuse_transmission.weight.value, 1);
    expect_color(sheet.diffuse_transmission.color.value, 0.1, 0.2, 0.3);
    EXPECT_FALSE(sheet.visibility.black_back);
    const auto diffuse = [](const char* red) {
        return std::string(R"(<bsdf type="diffuse"><rgb name="reflectance" value=")") + red + " 0 0\"/></bsdf>";
    };
    const Material three = old_bsdf(R"(<bsdf type="mixturebsdf"><string name="weights" value="0.2, 0.3, 0.5"/>)" +
                                    diffuse("0.1") + diffuse("0.2") + diffuse("0.3") + "</bsdf>");
    ASSERT_EQ(three.kind, MaterialKind::mix);
    EXPECT_FLOAT_EQ(three.mixture.factor.value, 0.8f);
    EXPECT_FLOAT_EQ(part(three.mixture.material_b).mixture.factor.value, 0.625f);
    expect_color(part(part(three.mixture.material_b).mixture.material_b).base_color.value, 0.3, 0, 0);
    EXPECT_EQ(
        error_of("a.xml",
                 old_scene_of(R"(<shape type="sphere"><bsdf type="mixturebsdf"><string name="weights" value="1, 2"/>)" +
                              diffuse("1") + "</bsdf></shape>")),
        "line 2, column 23: a 'mixturebsdf' must have as many 'weights' as bsdfs, found 2 and 1");
    const Material coated =
        old_bsdf(R"(<bsdf type="coating"><float name="intIOR" value="1.7"/>)" + diffuse("0.7") + "</bsdf>");
    expect_color(coated.base_color.value, 0.7, 0, 0);
    EXPECT_TRUE(has_warning("is not supported: its nested bsdf is used"));
}

}  // namespace
}  // namespace fathom::test
