// SPDX-License-Identifier: Apache-2.0
// Tests of BSDFs, media and textures in Mitsuba files, and of complete third-party scenes.
#include <fmt/format.h>
#include <cmath>

#include "mitsuba_fixture.h"
#include "scene/conductors.h"

namespace fathom::test {
namespace {

// ------------------------------------------------------------------------------------------------------- BSDFs

TEST_F(Mitsuba, TexturesAsAlpha)
{
    const SceneDescription scene = read(R"(<shape type="sphere"><bsdf type="roughconductor">
<texture type="bitmap" name="alpha"><string name="filename" value="p.png"/></texture></bsdf></shape>)");
    const FloatInput& roughness = scene.materials.at(0).roughness;
    const Texture& curve = scene.textures.at(std::size_t(roughness.texture));
    ASSERT_EQ(curve.kind, TextureKind::ramp);
    for (const RampStop& stop : curve.stops) EXPECT_NEAR(stop.color.g, std::sqrt(double(stop.position)), 1e-6);
    EXPECT_TRUE(warnings_.empty());
}

/// Textures may differ for alpha_u and alpha_v; glass and plastic use only one of them.
TEST_F(Mitsuba, TexturesAsTwoAlphas)
{
    const auto rough = [&](const char* type) {
        return read(fmt::format(R"(<shape type="sphere"><bsdf type="{}">
<texture type="checkerboard" name="alpha_u"/><float name="alpha_v" value="0.09"/></bsdf></shape>)",
                                type))
            .materials.at(0);
    };
    const Material m = rough("roughconductor");
    EXPECT_TRUE(m.microfacets.two_roughnesses);
    EXPECT_GE(m.microfacets.anisotropy.texture, 0) << "along u, where the tangent is";
    EXPECT_NEAR(m.roughness.value, 0.3, 1e-6);
    EXPECT_EQ(m.roughness.texture, -1);
    EXPECT_TRUE(warnings_.empty());
    EXPECT_FALSE(rough("roughdielectric").microfacets.two_roughnesses);
    EXPECT_TRUE(has_warning("anisotropic roughness of glass"));
}

/// The internal diffuse reflectance agrees with values derived from Mitsuba 3.9.1's images of roughplastic with two
/// diffuse colors.
TEST_F(Mitsuba, InnerReflectanceOfRoughPlastic)
{
    const struct {
        const char* distribution;
        double ior, alpha, expected;
    } cases[] = {{"ggx", 1.49, 0.01, 0.5805},     {"ggx", 1.49, 0.4, 0.3426},     {"ggx", 1.9, 0.1, 0.7203},
                 {"beckmann", 1.49, 0.1, 0.5748}, {"beckmann", 1.9, 0.4, 0.6673}, {"beckmann", 1.9, 0.9, 0.4288}};
    for (const auto& c : cases) {
        const Material m = bsdf(fmt::format(R"(<bsdf type="roughplastic"><string name="distribution" value="{}"/>
<float name="int_ior" value="{}"/><float name="ext_ior" value="1"/><float name="alpha" value="{}"/></bsdf>)",
                                            c.distribution, c.ior, c.alpha));
        EXPECT_NEAR(m.plastic.inner_reflectance, c.expected, 0.0005)
            << c.distribution << ' ' << c.ior << ' ' << c.alpha;
        EXPECT_TRUE(m.microfacets.separable_masking);
    }
    EXPECT_LT(bsdf(R"(<bsdf type="plastic"/>)").plastic.inner_reflectance, 0);
}

TEST_F(Mitsuba, Conductors)
{
    const Material mirror = bsdf(R"(<bsdf type="conductor"/>)");
    EXPECT_EQ(mirror.metallic.value, 1);
    EXPECT_EQ(mirror.roughness.value, 0);
    expect_color(mirror.base_color.value, 1, 1, 1);
    const Material gold =
        bsdf(R"(<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.25"/>
<string name="distribution" value="ggx"/></bsdf>)");
    EXPECT_NEAR(gold.roughness.value, 0.5, 1e-6) << "alpha is the square of it";
    EXPECT_FALSE(gold.microfacets.energy_compensation);
    EXPECT_GT(gold.base_color.value.r, 2 * gold.base_color.value.b);
    EXPECT_TRUE(warnings_.empty());
    const Material given = bsdf(R"(<bsdf type="conductor"><rgb name="eta" value="1.5"/><rgb name="k" value="2"/>
<rgb name="specular_reflectance" value="0.2 0.4 0.6"/></bsdf>)");
    EXPECT_NEAR(given.base_color.value.g, conductor_reflectance(1, 1.5, 2), 1e-6);
    expect_color(given.conductor.eta, 1.5, 1.5, 1.5);
    expect_color(given.conductor.k, 2, 2, 2);
    EXPECT_GT(gold.conductor.k.r, 1);
    expect_color(mirror.conductor.k, 0, 0, 0);
    // specular_reflectance scales the reflected light at every angle.
    EXPECT_EQ(given.coat.ior, 1);
    EXPECT_EQ(given.coat.weight.value, 1);
    expect_color(given.coat.color.value, 0.2, 0.4, 0.6);
}

/// Conductor indices may exceed 1, also as spectra.
TEST_F(Mitsuba, IndicesOfConductors)
{
    const Material m = bsdf(R"(<bsdf type="conductor"><spectrum name="eta" value="0.789"/>
<spectrum name="k" value="400:6.15, 700:6.15"/></bsdf>)");
    EXPECT_NEAR(m.base_color.value.r, conductor_reflectance(1, 0.789, 6.15), 1e-2);
    EXPECT_NEAR(m.base_color.value.b, conductor_reflectance(1, 0.789, 6.15), 1e-2);
}

TEST_F(Mitsuba, AnisotropicConductors)
{
    const auto rough = [&](const char* u, const char* v) {
        return bsdf(
            fmt::format(R"(<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u"
 value="{}"/><float name="alpha_v" value="{}"/></bsdf>)",
                        u, v));
    };
    const auto check = [](const Material& m, double turned) {
        const double narrow = m.roughness.value * m.roughness.value, a = m.microfacets.anisotropy.value;
        EXPECT_NEAR(narrow, 0.04, 1e-6);
        EXPECT_NEAR(narrow + (1 - narrow) * a * a, 0.36, 1e-6);
        EXPECT_NEAR(m.microfacets.anisotropy_rotation, turned, 1e-12);
    };
    check(rough("0.36", "0.04"), 0);
    check(rough("0.04", "0.36"), std::numbers::pi / 2);
}

/// The default distribution is Beckmann.
TEST_F(Mitsuba, DistributionsOfFacets)
{
    for (const char* type : {"roughconductor", "roughdielectric", "roughplastic"}) {
        const Material m = bsdf(fmt::format(R"(<bsdf type="{}"><float name="alpha" value="0.09"/></bsdf>)", type));
        EXPECT_TRUE(m.microfacets.beckmann) << type;
        EXPECT_NEAR(m.roughness.value, 0.3, 1e-6) << type;
        EXPECT_FALSE(bsdf(fmt::format(R"(<bsdf type="{}"><string name="distribution" value="ggx"/></bsdf>)", type))
                         .microfacets.beckmann)
            << type;
    }
}

TEST_F(Mitsuba, Dielectrics)
{
    const Material glass =
        bsdf(R"(<bsdf type="dielectric"><string name="int_ior" value="water"/><float name="ext_ior" value="1"/>
<rgb name="specular_transmittance" value="0.5"/></bsdf>)");
    EXPECT_EQ(glass.kind, MaterialKind::glass);
    EXPECT_NEAR(glass.ior, 1.333, 1e-6);
    expect_color(glass.transmission.color.value, 0.25, 0.25, 0.25);
    EXPECT_NEAR(bsdf(R"(<bsdf type="dielectric"/>)").ior, 1.5046 / 1.000277, 1e-6);
    const Material thin = bsdf(R"(<bsdf type="thindielectric"/>)");
    EXPECT_TRUE(thin.interior.thin);
    EXPECT_NE(
        error(R"(<shape type="sphere"><bsdf type="dielectric"><string name="int_ior" value="watr"/></bsdf></shape>)")
            .find("did you mean 'water'?"),
        std::string::npos);
}

TEST_F(Mitsuba, Plastic)
{
    const Material m = bsdf(
        R"(<bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.1 0.2 0.3"/><float name="alpha" value="0.09"/>
<string name="distribution" value="ggx"/><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>
<boolean name="nonlinear" value="true"/></bsdf>)");
    expect_color(m.base_color.value, 0.1, 0.2, 0.3);
    EXPECT_EQ(m.kind, MaterialKind::plastic);
    EXPECT_NEAR(m.roughness.value, 0.3, 1e-6);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_TRUE(m.plastic.nonlinear);
    EXPECT_FALSE(m.microfacets.energy_compensation);
    const Material smooth = bsdf(R"(<bsdf type="plastic"/>)");
    EXPECT_EQ(smooth.roughness.value, 0);
    EXPECT_FALSE(smooth.plastic.nonlinear);
}

TEST_F(Mitsuba, Principled)
{
    const Material m = bsdf(
        R"(<bsdf type="principled"><rgb name="base_color" value="0.1 0.2 0.3"/><float name="roughness" value="0.3"/>
<float name="metallic" value="0.1"/><float name="specular" value="0.8"/><float name="anisotropic" value="0.2"/>
<float name="clearcoat" value="0.4"/><float name="clearcoat_gloss" value="0.6"/><float name="sheen" value="0.7"/>
<float name="sheen_tint" value="0.8"/><float name="flatness" value="0.9"/><float name="spec_tint" value="0.15"/>
<float name="spec_trans" value="0.25"/></bsdf>)");
    EXPECT_EQ(m.kind, MaterialKind::disney);
    expect_color(m.base_color.value, 0.1, 0.2, 0.3);
    const std::pair<float, const FloatInput*> expected[] = {
        {0.3f, &m.roughness},           {0.1f, &m.metallic},          {0.2f, &m.microfacets.anisotropy},
        {0.4f, &m.coat.weight},         {0.6f, &m.disney.coat_gloss}, {0.7f, &m.disney.sheen},
        {0.8f, &m.disney.sheen_tint},   {0.9f, &m.disney.flatness},   {0.15f, &m.disney.specular_tint},
        {0.25f, &m.transmission.weight}};
    for (const auto& [value, input] : expected) EXPECT_NEAR(input->value, value, 1e-6);
    const double normal = (double(m.ior) - 1) / (double(m.ior) + 1);
    EXPECT_NEAR(normal * normal, 0.08 * 0.8, 1e-6);
    EXPECT_FALSE(m.interior.thin);
    EXPECT_FALSE(m.visibility.black_back);

    const Material sheet = bsdf(
        R"(<bsdf type="principledthin"><float name="diff_trans" value="0.8"/><float name="eta" value="1.3"/></bsdf>)");
    EXPECT_TRUE(sheet.interior.thin);
    EXPECT_EQ(sheet.diffuse_transmission.weight.value, 0.4f);
    EXPECT_EQ(sheet.ior, 1.3f);
    // Texture values may exceed 1, because diff_trans goes up to 2.
    const SceneDescription scene = read(
        R"(<shape type="sphere"><bsdf type="principledthin"><texture name="diff_trans" type="checkerboard">
<float name="color0" value="1.5"/><float name="color1" value="0.5"/></texture></bsdf></shape>)");
    const int checks = material_of(scene).diffuse_transmission.weight.texture;
    ASSERT_GE(checks, 0);
    expect_color(scene.textures[std::size_t(checks)].color_b.value, 1.5, 1.5, 1.5);
    const Material usual = bsdf(R"(<bsdf type="principled"/>)");
    EXPECT_NEAR(usual.ior, 1.5, 1e-6);
    EXPECT_EQ(usual.roughness.value, 0.5f);
    EXPECT_TRUE(usual.visibility.black_back);
}

TEST_F(Mitsuba, Hair)
{
    const Material usual = bsdf(R"(<bsdf type="hair"/>)");
    EXPECT_EQ(usual.kind, MaterialKind::hair);
    EXPECT_EQ(usual.hair.eumelanin, 1.3f);
    EXPECT_EQ(usual.hair.pheomelanin, 0.2f);
    EXPECT_NEAR(usual.hair.ior, 1.55 / 1.000277, 1e-6);
    EXPECT_NEAR(usual.hair.scale_tilt, 2 * std::numbers::pi / 180, 1e-9);
    const Material m = bsdf(
        R"(<bsdf type="hair"><float name="longitudinal_roughness" value="0.2"/><float name="scale_tilt" value="4"/>
<float name="azimuthal_roughness" value="0.4"/><float name="int_ior" value="1.5"/><float name="ext_ior" value="1.25"/>
<rgb name="sigma_a" value="0.1 0.2 0.3"/><float name="scale" value="5"/></bsdf>)");
    EXPECT_EQ(m.hair.beta_m.value, 0.2f);
    EXPECT_EQ(m.hair.beta_n.value, 0.4f);
    EXPECT_NEAR(m.hair.scale_tilt, 4 * std::numbers::pi / 180, 1e-9);
    EXPECT_NEAR(m.hair.ior, 1.2, 1e-6);
    expect_color(m.hair.absorption.value, 0.5, 1, 1.5);
    expect_color(m.base_color.value, 1, 1, 1);
    EXPECT_EQ(m.hair.eumelanin, 0);
    EXPECT_EQ(bsdf(R"(<bsdf type="hair"><float name="eumelanin" value="0.5"/></bsdf>)").hair.pheomelanin, 0.2f);
    expect_color(bsdf(R"(<bsdf type="hair"><rgb name="sigma_a" value="3 4 5"/></bsdf>)").hair.absorption.value, 3, 4,
                 5);
}

TEST_F(Mitsuba, MasksAndNullBsdfs)
{
    const Material mask =
        bsdf(R"(<bsdf type="mask"><float name="opacity" value="0.25"/><bsdf type="diffuse"/></bsdf>)");
    EXPECT_EQ(mask.opacity.mode, AlphaMode::blend);
    EXPECT_EQ(mask.opacity.alpha.value, 0.25f);
    const Material none = bsdf(R"(<bsdf type="null"/>)");
    EXPECT_EQ(none.opacity.mode, AlphaMode::blend);
    EXPECT_EQ(none.opacity.alpha.value, 0);
}

TEST_F(Mitsuba, Blends)
{
    const char* const both =
        R"(<bsdf type="diffuse"><rgb name="reflectance" value="1 0 0"/></bsdf><bsdf type="conductor">
<string name="material" value="none"/></bsdf>)";
    const SceneDescription scene = read(fmt::format(
        R"(<shape type="sphere"><bsdf type="blendbsdf"><float name="weight" value="0.25"/>{}</bsdf></shape>)", both));
    const Material& m = material_of(scene);
    EXPECT_EQ(m.kind, MaterialKind::mix);
    EXPECT_EQ(m.mixture.factor.value, 0.25f);
    EXPECT_EQ(scene.materials.at(std::size_t(m.mixture.material_a)).kind, MaterialKind::diffuse);
    EXPECT_EQ(scene.materials.at(std::size_t(m.mixture.material_b)).metallic.value, 1);
    // A blend with `null`: the weight of the null BSDF is the transmitted share.
    const auto alpha = [&](const char* first, const char* second) {
        return bsdf(
                   fmt::format(
                       R"(<bsdf type="blendbsdf"><float name="weight" value="0.25"/><bsdf type="{}"/><bsdf type="{}"/></bsdf>)",
                       first, second))
            .opacity.alpha.value;
    };
    EXPECT_EQ(alpha("null", "diffuse"), 0.25f);
    EXPECT_EQ(alpha("diffuse", "null"), 0.75f);
}

/// Without `twosided` a reflective BSDF is black on its back.
TEST_F(Mitsuba, Sides)
{
    EXPECT_TRUE(bsdf(R"(<bsdf type="diffuse"/>)").visibility.black_back);
    EXPECT_FALSE(bsdf(R"(<bsdf type="dielectric"/>)").visibility.black_back);
    EXPECT_FALSE(bsdf(R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)").visibility.black_back);
    EXPECT_TRUE(bsdf(R"(<bsdf type="mask"><bsdf type="diffuse"/></bsdf>)").visibility.black_back);
    EXPECT_FALSE(
        bsdf(R"(<bsdf type="twosided"><bsdf type="mask"><bsdf type="diffuse"/></bsdf></bsdf>)").visibility.black_back);
    const SceneDescription scene = read(
        R"(<bsdf type="diffuse" id="a"/><shape type="sphere"><ref id="a"/></shape><shape type="sphere"><bsdf type="twosided">
<ref id="a"/><bsdf type="diffuse"><rgb name="reflectance" value="1 0 0"/></bsdf></bsdf></shape>)");
    const auto of_shape = [&](std::size_t i) -> const Material& {
        return scene.materials.at(std::size_t(scene.nodes.at(std::size_t(scene.roots.at(i))).shapes.at(0).material));
    };
    EXPECT_TRUE(of_shape(0).visibility.black_back);
    EXPECT_EQ(of_shape(1).kind, MaterialKind::two_sided);
    for (const int part : {of_shape(1).mixture.material_a, of_shape(1).mixture.material_b})
        EXPECT_FALSE(scene.materials.at(std::size_t(part)).visibility.black_back);
    expect_color(scene.materials.at(std::size_t(of_shape(1).mixture.material_b)).base_color.value, 1, 0, 0);
    // An emitter without a BSDF reflects nothing.
    expect_color(material_of(read(R"(<shape type="sphere"><emitter type="area"/></shape>)")).base_color.value, 0, 0, 0);
}

/// Texture coordinates of shapes that become meshes because of their textures, as in Mitsuba. Its poles along z also
/// orient anisotropic facets.
TEST_F(Mitsuba, AnisotropicSpheres)
{
    const auto meshes = [&](const char* u, const char* v) {
        return read(fmt::format(R"(<shape type="sphere"><bsdf type="roughconductor"><float name="alpha_u" value="{}"/>
<float name="alpha_v" value="{}"/></bsdf></shape>)",
                                u, v))
            .meshes.size();
    };
    EXPECT_EQ(meshes("0.4", "0.1"), 1u);
    EXPECT_EQ(meshes("0.2", "0.2"), 0u);
}

TEST_F(Mitsuba, PicturesOnShapes)
{
    const auto uv_at = [&](const char* shape, Vec3f place) {
        const SceneDescription scene = read(fmt::format(
            R"(<shape type="{}"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></shape>)",
            shape));
        const Mesh& mesh = scene.meshes.at(0);
        std::size_t nearest = 0;
        const auto distance = [&](std::size_t i) {
            const Vec3f p = mesh.positions[i];
            return std::hypot(p.x - place.x, p.y - place.y, p.z - place.z);
        };
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            if (distance(i) < distance(nearest)) nearest = i;
        return mesh.uvs[0][nearest];
    };
    const auto expect_uv = [](Vec2f uv, float u, float v) {
        EXPECT_NEAR(uv.x, u, 0.005);
        EXPECT_NEAR(uv.y, v, 0.005);
    };
    expect_uv(uv_at("sphere", {0.3f, 0.4f, 0.86602545f}), 0.14758f, 0.16667f);
    expect_uv(uv_at("sphere", {-0.2f, -0.5f, 0.8426151f}), 0.68944f, 0.18101f);
    expect_uv(uv_at("disk", {0, -1, 0}), 1, 0.75f);
    expect_uv(uv_at("cube", {1, -1, -1}), 0, 1);  // a point of the first face, y = -1
    expect_uv(uv_at("rectangle", {1, -1, 0}), 1, 0);
}

TEST_F(Mitsuba, Bitmaps)
{
    write("t.png", "x");
    const SceneDescription scene =
        read(R"(<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
<string name="filename" value="t.png"/><string name="wrap_mode" value="mirror"/><string name="filter_type" value="nearest"/>
<transform name="to_uv"><scale x="3" y="5"/></transform></texture></bsdf></shape>)");
    const Texture& t = scene.textures.at(std::size_t(material_of(scene).base_color.texture));
    EXPECT_EQ(t.color_space, ColorSpace::srgb);
    EXPECT_EQ(t.wrap_u, Wrap::mirror);
    EXPECT_TRUE(t.nearest);
    EXPECT_EQ(t.uv_scale.x, 3);
    EXPECT_EQ(t.uv_scale.y, 5);
}

TEST_F(Mitsuba, BumpsAreHeights)
{
    const std::string map = R"(<bsdf type="bumpmap"><texture type="checkerboard"/><float name="scale" value="0.25"/>)";
    const Material m = bsdf(map + R"(<bsdf type="diffuse"/></bsdf>)");
    EXPECT_GE(m.bump.texture, 0);
    EXPECT_EQ(m.bump.value, 0.25f);
    EXPECT_LT(m.normal_map.texture, 0);
    EXPECT_TRUE(warnings_.counts().empty());
}

// -------------------------------------------------------------------------------------------------- third-party files

TEST(SharedMitsuba, AllScenesLoad)
{
    const std::filesystem::path folder = std::filesystem::path(FATHOM_SHARED_SCENES) / "mitsuba";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
    int scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        Warnings warnings;
        const SceneDescription scene = load_scene(entry.path() / "scene.xml", {}, warnings);
        EXPECT_EQ(scene.cameras.size(), 1u) << entry.path();
        EXPECT_GT(scene.roots.size(), 5u) << entry.path();
        for (const auto& [message, times] : warnings.counts())
            EXPECT_EQ(message.find(": is not supported"), std::string::npos) << message;
        ++scenes;
    }
    EXPECT_GT(scenes, 0);
}

}  // namespace
}  // namespace fathom::test
