// SPDX-License-Identifier: Apache-2.0
// Tests of Mitsuba's opacity masks, blends, emission with opacity, two-sided BSDFs, and textures for numbers.
#include <fmt/format.h>

#include "mitsuba_fixture.h"
#include "scene/parameters.h"

namespace fathom::test {
namespace {

constexpr const char* red = R"(<bsdf type="diffuse"><rgb name="reflectance" value="1 0 0"/></bsdf>)";
constexpr const char* lamp = R"(<emitter type="area"><rgb name="radiance" value="2 1 0.5"/></emitter>)";

std::string masked(const std::string& opacity, const std::string& bsdf)
{
    return fmt::format(R"(<bsdf type="mask"><float name="opacity" value="{}"/>{}</bsdf>)", opacity, bsdf);
}
std::string picture(const std::string& name, const std::string& more = "")
{
    return fmt::format(R"(<texture type="bitmap" name="{}"><string name="filename" value="p.png"/>{}</texture>)", name,
                       more);
}
constexpr const char* raw = R"(<boolean name="raw" value="true"/>)";

class MitsubaOpacity : public Mitsuba {
protected:
    SceneDescription plate(const std::string& inside)
    {
        return read("<shape type=\"rectangle\">" + inside + "</shape>");
    }
    const Material& part(const SceneDescription& scene, int index) { return scene.materials.at(std::size_t(index)); }
};

/// Mitsuba adds the full emitted radiance at each hit; opacity scales only scattering.
TEST_F(MitsubaOpacity, EmissionIsNotScaled)
{
    const auto shown = [](const Material& m) {
        return m.opacity.mode == AlphaMode::opaque ? m.emission.radiance.value.r
                                                   : m.emission.radiance.value.r * m.opacity.alpha.value;
    };
    for (const char* opacity : {"0.5", "0.25", "1"}) {
        const Material m = material_of(plate(masked(opacity, red) + lamp));
        EXPECT_NEAR(shown(m), 2, 1e-6) << opacity;
        EXPECT_FALSE(m.emission.two_sided);
    }
    // The emission of a nearly or fully transparent surface becomes a thin emissive sheet that transmits all light.
    const Material nothing = material_of(plate(std::string(R"(<bsdf type="null"/>)") + lamp));
    EXPECT_EQ(nothing.kind, MaterialKind::glass);
    EXPECT_TRUE(nothing.interior.thin);
    EXPECT_EQ(nothing.ior, 1);
    EXPECT_EQ(nothing.opacity.mode, AlphaMode::opaque);
    expect_color(nothing.emission.radiance.value, 2, 1, 0.5);
    for (const std::string& bsdf :
         {masked("0.01", red), masked("0", red), "<bsdf type=\"mask\">" + picture("opacity") + red + "</bsdf>"}) {
        const SceneDescription scene = plate(bsdf + lamp);
        const Material& m = material_of(scene);
        ASSERT_EQ(m.kind, MaterialKind::mix) << bsdf;
        EXPECT_EQ(m.opacity.mode, AlphaMode::opaque);
        expect_color(m.emission.radiance.value, 2, 1, 0.5);
        EXPECT_EQ(part(scene, m.mixture.material_a).ior, 1);
        EXPECT_EQ(part(scene, m.mixture.material_b).kind, MaterialKind::diffuse);
        EXPECT_EQ(part(scene, m.mixture.material_b).opacity.mode, AlphaMode::opaque);
    }
}

TEST_F(MitsubaOpacity, MasksMultiply)
{
    EXPECT_NEAR(bsdf(masked("0.5", masked("0.6", red))).opacity.alpha.value, 0.3, 1e-6);
    EXPECT_EQ(bsdf(masked("0.5", R"(<bsdf type="null"/>)")).opacity.alpha.value, 0)
        << "a masked null bsdf is fully transparent";
    const SceneDescription scene = plate("<bsdf type=\"mask\">" + picture("opacity") + "<bsdf type=\"mask\">" +
                                         picture("opacity", raw) + red + "</bsdf></bsdf>");
    const FloatInput& alpha = material_of(scene).opacity.alpha;
    ASSERT_GE(alpha.texture, 0);
    EXPECT_EQ(scene.textures.at(std::size_t(alpha.texture)).kind, TextureKind::scale);
    EXPECT_NEAR(
        bsdf(fmt::format(R"(<bsdf type="blendbsdf"><float name="weight" value="0.25"/>{}<bsdf type="null"/></bsdf>)",
                         masked("0.4", red)))
            .opacity.alpha.value,
        0.3, 1e-6);
}

/// Weights 0.4 and 0.6 with opacities 0.5 and 1 give a total opacity of 0.8, of which the second BSDF has three
/// quarters.
TEST_F(MitsubaOpacity, BlendsOfMasks)
{
    const std::string open = R"(<bsdf type="blendbsdf"><float name="weight" value="0.6"/>)";
    const Material m = bsdf(open + masked("0.5", red) + "<bsdf type=\"conductor\"/></bsdf>");
    EXPECT_NEAR(m.opacity.alpha.value, 0.8, 1e-6);
    EXPECT_NEAR(m.mixture.factor.value, 0.75, 1e-6);
    const Material alike = bsdf(open + masked("0.5", red) + masked("0.5", R"(<bsdf type="plastic"/>)") + "</bsdf>");
    EXPECT_EQ(alike.opacity.alpha.value, 0.5f);
    EXPECT_EQ(alike.mixture.factor.value, 0.6f);
    const SceneDescription scene =
        plate(open + "<bsdf type=\"mask\">" + picture("opacity") + red + "</bsdf><bsdf type=\"conductor\"/></bsdf>");
    const Material& textured = material_of(scene);
    EXPECT_EQ(textured.opacity.mode, AlphaMode::opaque);
    const Material& first = part(scene, textured.mixture.material_a);
    ASSERT_EQ(first.kind, MaterialKind::mix);
    EXPECT_EQ(part(scene, first.mixture.material_a).ior, 1) << "light goes straight on";
    EXPECT_TRUE(warnings_.empty());
}

/// A blend of two plain BSDFs becomes one material unless only one of them reflects on its back.
TEST_F(MitsubaOpacity, BlendsOfSides)
{
    const auto blend = [&](const char* second) {
        return bsdf(
            fmt::format(R"(<bsdf type="blendbsdf"><float name="weight" value="0.3"/>{}{}</bsdf>)", red, second));
    };
    EXPECT_EQ(blend(R"(<bsdf type="diffuse"/>)").kind, MaterialKind::diffuse);
    EXPECT_EQ(blend(R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)").kind, MaterialKind::mix);
}

/// A bump map around a blend bends copies of both BSDFs, which other shapes may use without it.
TEST_F(MitsubaOpacity, BumpsOfMixtures)
{
    const std::string map = R"(<bsdf type="bumpmap"><texture type="checkerboard"/>)";
    for (const std::string& two :
         {fmt::format(R"(<bsdf type="blendbsdf"><float name="weight" value="0.5"/>{}{}</bsdf>)", red,
                      R"(<bsdf type="conductor"/>)"),
          fmt::format(R"(<bsdf type="twosided">{}<bsdf type="plastic"/></bsdf>)", red)}) {
        const SceneDescription scene = plate(map + two + "</bsdf>");
        const Material& m = material_of(scene);
        for (const int index : {m.mixture.material_a, m.mixture.material_b})
            EXPECT_GE(part(scene, index).bump.texture, 0) << two;
        const auto plain = std::count_if(scene.materials.begin(), scene.materials.end(), [](const Material& other) {
            return other.kind != MaterialKind::mix && other.kind != MaterialKind::two_sided && other.bump.texture < 0;
        });
        EXPECT_EQ(plain, 2);
    }
    EXPECT_TRUE(warnings_.empty());
}

/// Mitsuba 3.9.1 decodes 8- and 16-bit images unless `raw` is set; color textures of numbers give their luminance.
TEST_F(MitsubaOpacity, PicturesForNumbers)
{
    const auto input = [&](const std::string& bsdf, Field<Material, FloatInput> member, ColorSpace space) {
        const SceneDescription scene = plate(bsdf);
        const Material& m = material_of(scene);
        FloatInput found = member(m);
        ASSERT_GE(found.texture, 0) << bsdf;
        if (scene.textures[std::size_t(found.texture)].kind == TextureKind::ramp)
            found = scene.textures[std::size_t(found.texture)].factor;
        EXPECT_EQ(found.channel, luminance_channel) << bsdf;
        EXPECT_EQ(scene.textures.at(std::size_t(found.texture)).color_space, space) << bsdf;
    };
    for (const bool is_raw : {false, true}) {
        const ColorSpace space = is_raw ? ColorSpace::linear : ColorSpace::srgb;
        const auto with = [&](const char* type, const char* name, const char* inside = "") {
            return fmt::format(R"(<bsdf type="{}">{}{}</bsdf>)", type, picture(name, is_raw ? raw : ""), inside);
        };
        input(with("roughconductor", "alpha"), field<&Material::roughness>, space);
        input(with("roughplastic", "alpha"), field<&Material::roughness>, space);
        input(with("mask", "opacity", red), field<&Material::opacity, &Material::Opacity::alpha>, space);
        input(with("bumpmap", "map", red), field<&Material::bump>, space);
        const std::pair<const char*, Field<Material, FloatInput>> principled[] = {
            {"roughness", field<&Material::roughness>},
            {"metallic", field<&Material::metallic>},
            {"anisotropic", field<&Material::microfacets, &Material::Microfacets::anisotropy>},
            {"spec_trans", field<&Material::transmission, &Material::Transmission::weight>},
            {"clearcoat", field<&Material::coat, &Material::Coat::weight>},
            {"clearcoat_gloss", field<&Material::disney, &Material::Disney::coat_gloss>},
            {"sheen", field<&Material::disney, &Material::Disney::sheen>},
            {"sheen_tint", field<&Material::disney, &Material::Disney::sheen_tint>},
            {"flatness", field<&Material::disney, &Material::Disney::flatness>},
            {"spec_tint", field<&Material::disney, &Material::Disney::specular_tint>}};
        for (const auto& [name, member] : principled) input(with("principled", name), member, space);
        input(with("principledthin", "diff_trans"),
              field<&Material::diffuse_transmission, &Material::DiffuseTransmission::weight>, space);
        input(with("blendbsdf", "weight", R"(<bsdf type="conductor"/><bsdf type="plastic"/>)"),
              field<&Material::mixture, &Material::Mixture::factor>, space);
    }
    EXPECT_TRUE(warnings_.empty());
    // A constant color for a number gives the mean of its channels instead.
    EXPECT_NEAR(bsdf(R"(<bsdf type="principled"><rgb name="roughness" value="0.2 0.5 0.8"/></bsdf>)").roughness.value,
                0.5, 1e-6);
}

/// Mitsuba decodes normal maps that are not `raw`, which is rarely intended.
TEST_F(MitsubaOpacity, NormalMapsAreDecoded)
{
    const auto space = [&](const std::string& more) {
        const SceneDescription scene =
            plate("<bsdf type=\"normalmap\">" + picture("normalmap", more) + red + "</bsdf>");
        // Normals of a map are relative to the surface's own tangents, whatever the map's coordinates are.
        EXPECT_FALSE(material_of(scene).map_tangents);
        return scene.textures.at(std::size_t(material_of(scene).normal_map.texture)).color_space;
    };
    EXPECT_EQ(space(raw), ColorSpace::linear);
    EXPECT_TRUE(warnings_.empty());
    EXPECT_EQ(space(""), ColorSpace::srgb);
    EXPECT_TRUE(has_warning("most normal maps need 'raw' to be true"));
}

/// A bump map inside `twosided` changes its sign on the back; one around it applies to both sides alike.
TEST_F(MitsubaOpacity, BumpsBehindSurfaces)
{
    const std::string map = R"(<bsdf type="bumpmap"><texture type="checkerboard"/><float name="scale" value="0.25"/>)",
                      two = "<bsdf type=\"twosided\">", end = "</bsdf>";
    const SceneDescription within = plate(two + map + red + end + end);
    const Material& m = material_of(within);
    ASSERT_EQ(m.kind, MaterialKind::two_sided);
    EXPECT_EQ(part(within, m.mixture.material_a).bump.value, 0.25f);
    EXPECT_EQ(part(within, m.mixture.material_b).bump.value, -0.25f);
    const SceneDescription around = plate(map + two + red + end + end);
    EXPECT_EQ(material_of(around).bump.value, 0.25f);
    EXPECT_NE(material_of(around).kind, MaterialKind::two_sided);
    const SceneDescription other =
        plate(two + red + "<bsdf type=\"normalmap\">" + picture("normalmap", raw) + red + end + end);
    EXPECT_EQ(part(other, material_of(other).mixture.material_b).normal_map.scale, -1);
    EXPECT_EQ(part(other, material_of(other).mixture.material_a).normal_map.texture, -1);
    const SceneDescription masked_one = plate(two + "<bsdf type=\"mask\">" + map + red + end + end + end);
    EXPECT_EQ(material_of(masked_one).opacity.alpha.value, 0.5f);
    EXPECT_EQ(part(masked_one, material_of(masked_one).mixture.material_a).opacity.mode, AlphaMode::opaque);
}

/// Mitsuba's frame of a normal map is built from dp/du and the normal, although its rectangles show images upside down.
TEST_F(MitsubaOpacity, FramesOfNormalMaps)
{
    const std::string map = "<bsdf type=\"normalmap\">" + picture("normalmap", raw) + red + "</bsdf>";
    for (const char* said : {"", R"(<boolean name="flip_normals" value="true"/>)"}) {
        const Mesh mesh = plate(said + map).meshes.at(0);
        ASSERT_EQ(mesh.tangents.size(), 4u);
        for (const Vec4f& t : mesh.tangents) {
            EXPECT_NEAR(t.x, 1, 1e-6);
            EXPECT_EQ(t.w, 1);
        }
    }
    const std::string two = "<bsdf type=\"twosided\">" + map + red + "</bsdf>";
    EXPECT_FALSE(plate(two).meshes.at(0).tangents.empty());
    EXPECT_TRUE(plate("<bsdf type=\"diffuse\">" + picture("reflectance") + "</bsdf>").meshes.at(0).tangents.empty());
    // On a sphere's equator, u runs around z from +x to +y.
    const Mesh ball = read("<shape type=\"sphere\">" + map + "</shape>").meshes.at(0);
    for (std::size_t i = 0; i < ball.positions.size(); ++i)
        if (std::abs(ball.positions[i].z) < 1e-3f) {
            EXPECT_NEAR(ball.tangents[i].x, -ball.positions[i].y, 0.02);
            EXPECT_NEAR(ball.tangents[i].y, ball.positions[i].x, 0.02);
        }
}

/// specular_reflectance and specular_transmittance scale the boundary; they may be textures.
TEST_F(MitsubaOpacity, SpecularColors)
{
    const std::string colors =
        R"(<rgb name="specular_reflectance" value="0.8 0.4 0.1"/><rgb name="specular_transmittance" value="0.2 0.5 1"/>)";
    for (const char* type : {"dielectric", "roughdielectric", "thindielectric"}) {
        const Material m = bsdf(fmt::format(R"(<bsdf type="{}">{}</bsdf>)", type, colors));
        expect_color(m.specular.color.value, 0.8, 0.4, 0.1);
        if (m.interior.thin)
            expect_color(m.transmission.color.value, 0.2, 0.5, 1);
        else
            expect_color(m.transmission.color.value, 0.04, 0.25, 1);
    }
    for (const char* type : {"plastic", "roughplastic"})
        expect_color(
            bsdf(fmt::format(R"(<bsdf type="{}"><rgb name="specular_reflectance" value="0.8 0.4 0.1"/></bsdf>)", type))
                .specular.color.value,
            0.8, 0.4, 0.1);
    const SceneDescription scene = plate("<bsdf type=\"dielectric\">" + picture("specular_transmittance") +
                                         picture("specular_reflectance") + "</bsdf>");
    const Material& m = material_of(scene);
    EXPECT_GE(m.specular.color.texture, 0);
    const Texture& square = scene.textures.at(std::size_t(m.transmission.color.texture));
    EXPECT_EQ(square.kind, TextureKind::scale);
    EXPECT_EQ(square.color_a.texture, square.color_b.texture);
    EXPECT_TRUE(warnings_.empty());
}

/// hide_emitters hides area lights and the environment from the camera, before or after the shapes in the file.
TEST_F(MitsubaOpacity, HiddenEmitters)
{
    const std::string shapes = std::string("<emitter type=\"constant\"/><shape type=\"sphere\">") + lamp +
                               "</shape><shape type=\"sphere\">" + red + "</shape>";
    const std::string integrator =
        R"(<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>)";
    for (const std::string& text : {integrator + shapes, shapes + integrator}) {
        const SceneDescription scene = read(text);
        ASSERT_TRUE(scene.hints.background);
        expect_color(*scene.hints.background, 0, 0, 0);
        for (const Material& m : scene.materials)
            EXPECT_EQ(m.visibility.hidden_from_camera, m.emission.radiance.value.r > 0);
    }
    EXPECT_TRUE(warnings_.empty());
    EXPECT_FALSE(read(shapes).hints.background);
}

}  // namespace
}  // namespace fathom::test
