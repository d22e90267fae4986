// SPDX-License-Identifier: Apache-2.0
// Tests of materials in pbrt files.
#include <fmt/format.h>
#include <cmath>

#include "pbrt_fixture.h"
#include "scene/conductors.h"

namespace fathom::test {
namespace {

// ---------------------------------------------------------------------------------------------------- materials

TEST_F(Pbrt, Diffuse)
{
    expect_color(material("").base_color.value, 0.5, 0.5, 0.5);
    expect_color(material("Material \"diffuse\" \"rgb reflectance\" [ 0.1 0.2 3 ]").base_color.value, 0.1, 0.2, 1);
    expect_color(material(R"(MakeNamedMaterial "m" "string type" "diffuse" "spectrum reflectance" [ 300 0.25 900 0.25 ]
NamedMaterial "m")")
                     .base_color.value,
                 0.25, 0.25, 0.25, 1e-4);
}

TEST_F(Pbrt, RoughnessIsRemapped)
{
    // alpha is the square of Fathom's roughness, 0.25^2; with remapping the roughness is the square root.
    EXPECT_NEAR(
        material("Material \"conductor\" \"float roughness\" 0.0625 \"bool remaproughness\" false").roughness.value,
        0.25, 1e-6);
    EXPECT_NEAR(material("Material \"conductor\" \"float roughness\" 0.0625").roughness.value, 0.5, 1e-6);
    const Material m = material("Material \"conductor\" \"float uroughness\" 0.01 \"float vroughness\" 0.16");
    EXPECT_NEAR(m.roughness.value, std::sqrt(0.1), 1e-6);
    EXPECT_GT(m.microfacets.anisotropy.value, 0.5f);
    EXPECT_NEAR(m.microfacets.anisotropy_rotation, 90 * degree, 1e-9);
}

TEST_F(Pbrt, TexturesAsRoughnessAreRemapped)
{
    for (const double power : {0.25, 0.5}) {
        const SceneDescription scene = world(fmt::format(R"(Texture "t" "float" "imagemap" "string filename" "a.png"
Material "conductor" "texture roughness" "t" "bool remaproughness" {} Shape "sphere")",
                                                         power < 0.5));
        const FloatInput& roughness = material_of(scene).roughness;
        const Texture& curve = scene.textures.at(std::size_t(roughness.texture));
        ASSERT_EQ(curve.kind, TextureKind::ramp);
        EXPECT_EQ(scene.textures.at(std::size_t(curve.factor.texture)).kind, TextureKind::image);
        for (const RampStop& stop : curve.stops)
            EXPECT_NEAR(stop.color.g, std::pow(double(stop.position), power), 1e-6);
    }
}

/// Textures for both roughness directions; isotropic materials use one of them.
TEST_F(Pbrt, TexturesAsTwoRoughnesses)
{
    const auto rough = [&](const char* kind) {
        return material(fmt::format(R"(Texture "t" "float" "imagemap" "string filename" "a.png"
Material "{}" "texture uroughness" "t" "float vroughness" 0.25 "bool remaproughness" false)",
                                    kind));
    };
    const Material m = rough("conductor");
    EXPECT_TRUE(m.microfacets.two_roughnesses);
    EXPECT_GE(m.microfacets.anisotropy.texture, 0) << "along u, where the tangent is";
    EXPECT_EQ(m.roughness.value, 0.5f);
    EXPECT_FALSE(has_warning("rough"));
    EXPECT_FALSE(rough("dielectric").microfacets.two_roughnesses);
    EXPECT_TRUE(has_warning("anisotropic roughness of glass is not supported: isotropic roughness is used"));
    EXPECT_FALSE(rough("coateddiffuse").microfacets.two_roughnesses);
    EXPECT_TRUE(has_warning("anisotropic roughness of the coat is not supported: isotropic roughness is used"));
}

TEST_F(Pbrt, Metals)
{
    // Colors are those of pbrt's own spectra in daylight.
    expect_color(material("Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\"")
                     .base_color.value,
                 0.9715, 0.9599, 0.9153, 1e-3);
    const Material copper = material("Material \"conductor\"");
    expect_color(copper.base_color.value, 0.9553, 0.6376, 0.5382, 2e-3);
    const auto at_82 = [](float base, float edge) { return edge * (base + (1 - base) * std::pow(6.0 / 7, 5)); };
    EXPECT_NEAR(at_82(copper.base_color.value.g, copper.conductor.edge_color.value.g), 0.7669, 1e-3);
    expect_color(
        material("Material \"coatedconductor\" \"spectrum conductor.eta\" \"metal-CuZn-eta\"").base_color.value, 0.8717,
        0.7191, 0.3346, 3e-3);
    const double f = conductor_reflectance(1, 1.5, 3);
    expect_color(material("Material \"conductor\" \"rgb eta\" [ 1.5 1.5 1.5 ] \"rgb k\" [ 3 3 3 ]").base_color.value, f,
                 f, f);
    expect_color(material("Material \"conductor\" \"spectrum eta\" [ 300 1.5 900 1.5 ] \"spectrum k\" [ 300 3 900 3 ]")
                     .base_color.value,
                 f, f, f, 1e-3);
    write("n.spd", "# a comment\n300 1.5\n900 1.5\n");
    write("k.spd", "300 3\n900 3\n");
    const char* const files = "Material \"conductor\" \"spectrum eta\" \"n.spd\" \"spectrum k\" \"k.spd\"";
    expect_color(material(files).base_color.value, f, f, f, 1e-3);
    const Material plain = material("Material \"conductor\" \"rgb reflectance\" [ 0.7 0.6 0.5 ]");
    expect_color(plain.base_color.value, 0.7, 0.6, 0.5);
    const double k = 2 * std::sqrt(0.7 / 0.3);
    EXPECT_NEAR(at_82(plain.base_color.value.r, plain.conductor.edge_color.value.r),
                conductor_reflectance(1.0 / 7, 1, k), 1e-4);
    expect_color(plain.conductor.eta, 1, 1, 1);
    EXPECT_NEAR(plain.conductor.k.r, k, 1e-4);
    const char* const coated = "Material \"coatedconductor\" \"rgb reflectance\" [ 0.7 0.6 0.5 ]";
    EXPECT_NEAR(material(coated).base_color.value.r, conductor_reflectance(1, 1 / 1.5, k / 1.5), 1e-4)
        << "the reflectance is that in air";
    expect_color(material(coated).conductor.k, 0, 0, 0);
}

TEST_F(Pbrt, Coats)
{
    const Material m = material(
        "Material \"coateddiffuse\" \"rgb reflectance\" [ 1 0 0 ] \"float roughness\" 0.0001 \"float eta\" 1.4");
    EXPECT_EQ(m.kind, MaterialKind::plastic);
    EXPECT_FALSE(m.microfacets.energy_compensation);
    EXPECT_EQ(m.ior, 1.4f);
    EXPECT_EQ(m.plastic.optical_thickness, 0.01f) << "pbrt's layers absorb";
    EXPECT_EQ(material("Material \"coateddiffuse\" \"float thickness\" 0.5").plastic.optical_thickness, 0.5f);
    EXPECT_NEAR(m.roughness.value, 0.1, 1e-6);
    const Material metal = material("Material \"coatedconductor\" \"float conductor.roughness\" 0.0001");
    EXPECT_EQ(metal.metallic.value, 1);
    EXPECT_EQ(metal.coat.weight.value, 1);
    EXPECT_NEAR(metal.coat.color.value.g, std::exp(-0.02 / std::sqrt(1 - 0.5 / 2.25)), 1e-6);
    // Refraction widens the lobe of a rough metal; grazing angles outside are not grazing below the coat.
    EXPECT_NEAR(metal.roughness.value, std::sqrt(1.5 * 0.01), 1e-5);
    EXPECT_NEAR(metal.conductor.edge_color.value.g, 0.677, 2e-3);
    EXPECT_TRUE(has_warning("interreflection below the coat is not simulated"));
}

TEST_F(Pbrt, Glass)
{
    EXPECT_EQ(material("Material \"dielectric\"").ior, 1.5f);
    EXPECT_NEAR(material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior, 1.5168, 1e-6);
    EXPECT_TRUE(material("Material \"thindielectric\"").interior.thin);
    const Material green = material(R"(MakeNamedMedium "g" "string type" "homogeneous" "rgb sigma_a" [ 1 2 4 ]
"rgb sigma_s" [ 0 0 0 ] "float scale" 2 MediumInterface "g" "" Material "dielectric")");
    const auto left = [&](float c) { return std::pow(double(c), 1 / green.interior.attenuation_distance); };
    EXPECT_NEAR(left(green.interior.attenuation_color.r), std::exp(-2), 1e-6);
    EXPECT_NEAR(left(green.interior.attenuation_color.b), std::exp(-8), 1e-6);
    EXPECT_EQ(material("Material \"interface\"").opacity.alpha.value, 0);
    world(R"(MakeNamedMedium "c" "string type" "cloud" MediumInterface "c" "" Material "interface" Shape "sphere")");
    EXPECT_TRUE(has_warning("Medium 'cloud': is not supported"));
}

/// Dispersion comes from named, tabulated and file spectra: 20 over the Abbe number, (n(587.6 nm) - 1) / (n(486.1 nm) -
/// n(656.3 nm)).
TEST_F(Pbrt, DispersiveGlass)
{
    const Material crown = material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"");
    EXPECT_EQ(crown.kind, MaterialKind::principled);
    EXPECT_EQ(crown.transmission.weight.value, 1);
    EXPECT_EQ(crown.metallic.value, 0);
    EXPECT_EQ(crown.roughness.value, 0);
    expect_color(crown.base_color.value, 1, 1, 1);
    EXPECT_NEAR(crown.transmission.dispersion, 20 / 64.17, 1e-5);
    EXPECT_NEAR(material("Material \"dielectric\" \"spectrum eta\" \"glass-F11\"").transmission.dispersion, 20 / 25.76,
                1e-5);
    const Material pairs = material(
        R"(Material "dielectric" "spectrum eta" [ 400 1.7 486.1 1.63 587.6 1.6 656.3 1.59 800 1.58 ] "float roughness" 0.25)");
    EXPECT_NEAR(pairs.ior, 1.6, 1e-6);
    EXPECT_NEAR(pairs.transmission.dispersion, 20 * 0.04 / 0.6, 1e-4);
    EXPECT_GT(pairs.roughness.value, 0.3f);
    write("glass.spd", "400 1.5\n# the same everywhere\n700 1.5\n");
    const Material flat = material("Material \"dielectric\" \"spectrum eta\" \"glass.spd\"");
    EXPECT_EQ(flat.kind, MaterialKind::glass);
    EXPECT_EQ(flat.ior, 1.5f);
    // The interior medium of dispersive glass is kept.
    EXPECT_GT(material(R"(MakeNamedMedium "g" "string type" "homogeneous" MediumInterface "g" ""
Material "dielectric" "spectrum eta" "glass-SF10")")
                  .interior.attenuation_distance,
              0);
    EXPECT_FALSE(has_warning("dispersion"));
    EXPECT_NEAR(material("Material \"hair\" \"spectrum eta\" \"glass-BK7\"").hair.ior, 1.5168, 1e-6);
    EXPECT_TRUE(has_warning("only glass supports dispersion"));
}

TEST_F(Pbrt, DiffuseTransmission)
{
    const char* const text = R"(Material "diffusetransmission" "rgb reflectance" [ 0.9 0.6 0.1 ]
"rgb transmittance" [ 0.1 0.2 0.8 ] "float scale" {})";
    const Material m = material(fmt::format(fmt::runtime(text), 1));
    EXPECT_TRUE(m.diffuse_transmission.added) << "neither is taken from the other";
    EXPECT_EQ(m.diffuse_transmission.weight.value, 1);
    expect_color(m.base_color.value, 0.9, 0.6, 0.1);
    expect_color(m.diffuse_transmission.color.value, 0.1, 0.2, 0.8);
    expect_color(material(fmt::format(fmt::runtime(text), 0.5)).diffuse_transmission.color.value, 0.05, 0.1, 0.4);
    EXPECT_FALSE(has_warning("more light than it receives"));
    expect_color(material(fmt::format(fmt::runtime(text), 2)).base_color.value, 1, 1, 0.2);
    EXPECT_TRUE(has_warning("more light than it receives"));
}

TEST_F(Pbrt, Hair)
{
    const Material usual = material("Material \"hair\"");
    EXPECT_EQ(usual.kind, MaterialKind::hair);
    EXPECT_EQ(usual.hair.eumelanin, 1.3f);
    EXPECT_EQ(usual.hair.pheomelanin, 0);
    EXPECT_EQ(usual.hair.ior, 1.55f);
    EXPECT_EQ(usual.hair.beta_m.value, 0.3f);
    EXPECT_EQ(usual.hair.beta_n.value, 0.3f);
    EXPECT_NEAR(usual.hair.scale_tilt, 2 * std::numbers::pi / 180, 1e-9);
    const Material red = material(
        R"(Material "hair" "float pheomelanin" 0.7 "float beta_m" 0.2 "float beta_n" 0.4 "float alpha" 3 "float eta" 1.4)");
    EXPECT_EQ(red.hair.eumelanin, 0);
    EXPECT_EQ(red.hair.pheomelanin, 0.7f);
    EXPECT_EQ(red.hair.beta_m.value, 0.2f);
    EXPECT_EQ(red.hair.beta_n.value, 0.4f);
    EXPECT_NEAR(red.hair.scale_tilt, 3 * std::numbers::pi / 180, 1e-9);
    EXPECT_EQ(red.hair.ior, 1.4f);
    const Material colored = material(R"(Material "hair" "rgb reflectance" [ 0.1 0.2 0.3 ] "float eumelanin" 2)");
    expect_color(colored.base_color.value, 0.1, 0.2, 0.3);
    EXPECT_EQ(colored.hair.eumelanin, 0);
    const Material absorbing = material(R"(Material "hair" "rgb sigma_a" [ 0.5 1.5 2.5 ] "rgb color" [ 0.1 0.2 0.3 ])");
    expect_color(absorbing.hair.absorption.value, 0.5, 1.5, 2.5);
    expect_color(absorbing.base_color.value, 1, 1, 1);
    EXPECT_FALSE(has_warning("hair"));
}

/// The coefficients are those of Jensen et al. 2001, table 1, and of Narasimhan et al. 2006.
TEST_F(Pbrt, MeasuredMedia)
{
    const auto expect_medium = [](const Material& m, Color scattering, Color absorption) {
        const double d = m.interior.attenuation_distance;
        expect_color(m.interior.scatter, scattering.r * d, scattering.g * d, scattering.b * d);
        const auto extinction = [&](float left) { return -std::log(double(left)) / d; };
        EXPECT_NEAR(extinction(m.interior.attenuation_color.r), scattering.r + absorption.r, 1e-4 * scattering.r);
        EXPECT_NEAR(extinction(m.interior.attenuation_color.b), scattering.b + absorption.b, 1e-4 * scattering.b);
    };
    const Material skin = material(
        R"(Material "subsurface" "string name" "Skin1" "float scale" 2 "float g" 0.5 "rgb sigma_a" [ 9 9 9 ])");
    expect_medium(skin, {1.48f, 1.76f, 2.02f}, {0.064f, 0.34f, 0.96f});
    EXPECT_EQ(skin.interior.scatter_anisotropy, 0);
    // A subsurface material's walk, which replaces a diffusion profile, doesn't count as bounces.
    EXPECT_FALSE(skin.interior.scatter_bounces);
    const Material coffee = material(
        R"(MakeNamedMedium "m" "string type" "homogeneous" "string preset" "Espresso" "float g" 0.3 MediumInterface "m" ""
Material "dielectric")");
    expect_medium(coffee, {0.72378f, 0.84557f, 1.0247f}, {4.7984f, 6.5751f, 8.8493f});
    EXPECT_EQ(coffee.interior.scatter_anisotropy, 0.3f);
    EXPECT_TRUE(coffee.interior.scatter_bounces);
    const Material usual = material(
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MediumInterface \"m\" \"\" Material \"dielectric\"");
    expect_medium(usual, {1, 1, 1}, {1, 1, 1});
    EXPECT_NE(error_of("a.pbrt", "WorldBegin Material \"subsurface\" \"string name\" \"Skin3\" Shape \"sphere\"")
                  .find("there is no medium 'Skin3'; did you mean 'Skin1'?"),
              std::string::npos);
}

/// An interface in a mixture makes holes with the mixture's probability.
TEST_F(Pbrt, InterfacesInMixtures)
{
    const char* const text =
        R"(MakeNamedMaterial "a" "string type" "conductor" MakeNamedMaterial "b" "string type" "interface"
Material "mix" "string materials" [ "{}" "{}" ] "float amount" 0.25)";
    const Material first = material(fmt::format(fmt::runtime(text), "a", "b")),
                   second = material(fmt::format(fmt::runtime(text), "b", "a"));
    for (const Material& m : {first, second}) {
        EXPECT_EQ(m.metallic.value, 1);
        EXPECT_EQ(m.opacity.mode, AlphaMode::blend);
    }
    EXPECT_EQ(first.opacity.alpha.value, 0.75f);
    EXPECT_EQ(second.opacity.alpha.value, 0.25f);
}

TEST_F(Pbrt, ReportsApproximations)
{
    const std::pair<const char*, const char*> approximated[] = {
        {"Texture \"t\" \"float\" \"checkerboard\" Material \"hair\" \"texture eumelanin\" \"t\"",
         "textures of melanin concentrations"},
        {"Material \"velvet\"", "is not supported: gray diffuse is used"}};
    for (const auto& [text, words] : approximated) {
        material(text);
        EXPECT_TRUE(has_warning(words)) << text;
    }
    EXPECT_GT(material("Material \"subsurface\"").interior.scatter.r, 0);
    EXPECT_EQ(material("Material \"subsurface\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]").subsurface.weight.value, 1);
    const char* const two = R"(MakeNamedMaterial "a" "string type" "diffuse" "rgb reflectance" [ 1 1 1 ]
MakeNamedMaterial "b" "string type" "diffuse" "rgb reflectance" [ 0 0 0 ] Material "mix" "string materials" [ "a" "b" ] "float amount" 0.25)";
    expect_color(material(two).base_color.value, 0.75, 0.75, 0.75);
    const SceneDescription mixed = world(R"(MakeNamedMaterial "a" "string type" "diffuse"
MakeNamedMaterial "b" "string type" "conductor" Material "mix" "string materials" [ "a" "b" ] "float amount" 0.25 Shape "sphere")");
    const Material& mixture = material_of(mixed);
    EXPECT_EQ(mixture.kind, MaterialKind::mix);
    EXPECT_EQ(mixture.mixture.factor.value, 0.25f);
    EXPECT_EQ(mixed.materials.at(std::size_t(mixture.mixture.material_a)).kind, MaterialKind::diffuse);
    EXPECT_EQ(mixed.materials.at(std::size_t(mixture.mixture.material_b)).metallic.value, 1);
}

}  // namespace
}  // namespace fathom::test
