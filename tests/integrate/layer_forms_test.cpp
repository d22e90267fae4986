// SPDX-License-Identifier: Apache-2.0
#include <complex>
#include <functional>
#include <span>

#include "picture_helpers.h"
#include "scene/parameters.h"

// Tests of textures, normal maps and tangents on layered materials: a square under one directional light.
namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

/// Radiance of a square in the plane z = 0 with tangent +x and normal +z.
struct Shown {
    Vec3d to_eye = normalize(Vec3d{0.5, -0.3, 1});
    Vec3d to_light = normalize(Vec3d{-0.2, 0.6, 0.8});

    /// Returns f cos, which is the reflected radiance of a directional light of illuminance 1.
    Color of(const std::function<void(Material&, SceneBuilder&)>& add_objects) const
    {
        SceneBuilder b;
        b.camera(to_eye * 4, {0, 0, 0});
        b.scene.cameras[0].kind = CameraKind::orthographic;
        b.scene.cameras[0].height = 0.1;
        Material m;
        m.kind = MaterialKind::principled;
        m.roughness = {0.5f, -1, 1};
        add_objects(m, b);
        b.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, b.material(m));
        Light sun;
        sun.kind = LightKind::directional;
        sun.intensity = {1, 1, 1};
        b.light(sun, rotate_to(to_light * -1));
        const Image image = render_film(b.scene, small_image_settings(1, 1), 1).image(false, false);
        const auto& p = image.layers[0].pixels;
        return {p[0], p[1], p[2]};
    }
};

int constant(SceneBuilder& b, Color c)
{
    Texture t;
    t.kind = TextureKind::checker_uv;
    t.color_a.value = t.color_b.value = c;
    b.scene.textures.push_back(t);
    return int(b.scene.textures.size()) - 1;
}

void expect_equal(const Color& a, const Color& b, const std::string& what)
{
    EXPECT_NEAR(a.r, b.r, 1e-4 * b.r + 1e-7) << what;
    EXPECT_NEAR(a.g, b.g, 1e-4 * b.g + 1e-7) << what;
    EXPECT_NEAR(a.b, b.b, 1e-4 * b.b + 1e-7) << what;
}

/// Enables every layer, so that each parameter matters.
void enable_all_layers(Material& m)
{
    m.base_color.value = {0.6f, 0.5f, 0.4f};
    m.metallic.value = 0.4f;
    m.specular.weight.value = 0.8f, m.specular.color.value = {0.9f, 0.8f, 0.7f},
    m.conductor.edge_color.value = {0.8f, 0.7f, 0.9f};
    m.microfacets.anisotropy.value = 0.6f;
    m.diffuse_roughness.value = 0.5f;
    m.transmission.weight.value = 0.3f, m.transmission.color.value = {0.9f, 0.6f, 0.8f};
    m.diffuse_transmission.weight.value = 0.6f, m.diffuse_transmission.color.value = {0.7f, 0.9f, 0.5f};
    m.interior.thin = true;
    m.coat.weight.value = 0.7f, m.coat.roughness.value = 0.4f, m.coat.color.value = {0.9f, 0.8f, 0.6f};
    m.sheen.color.value = {0.3f, 0.5f, 0.4f}, m.sheen.roughness.value = 0.6f;
    m.thin_film.weight.value = 0.5f, m.thin_film.thickness.value = 350;
}

/// Enables every lobe of the Disney closure, solid or thin.
void enable_all_disney_lobes(Material& m, bool thin)
{
    m.kind = MaterialKind::disney;
    m.base_color.value = {0.6f, 0.2f, 0.4f};
    m.metallic.value = 0.4f, m.roughness.value = 0.6f;
    m.microfacets.anisotropy.value = 0.6f, m.disney.flatness.value = 0.5f, m.disney.specular_tint.value = 0.4f;
    m.disney.sheen.value = 0.5f, m.disney.sheen_tint.value = 0.6f;
    m.coat.weight.value = 0.7f, m.disney.coat_gloss.value = 0.3f;
    m.transmission.weight.value = 0.3f, m.diffuse_transmission.weight.value = 0.6f;
    m.interior.thin = thin;
}

using Number = std::pair<const char*, Field<Material, FloatInput>>;

/// A number times a texture channel equals the plain product, and changes the result.
void expect_textured_numbers(const Shown& shown, void (*add_objects)(Material&), std::span<const Number> numbers)
{
    for (const auto& [name, member] : numbers)
        for (int channel = 0; channel < 3; ++channel) {
            const float factors[] = {0.5f, 0.75f, 0.625f};
            const auto render = [&](float times, bool textured) {
                return shown.of([&](Material& m, SceneBuilder& b) {
                    add_objects(m);
                    FloatInput& input = member(m);
                    input.value *= times;
                    input.channel = channel;
                    if (textured) input.texture = constant(b, {0.5f, 0.75f, 0.625f});
                });
            };
            const Color textured = render(1, true), plain = render(factors[channel], false), whole = render(1, false);
            expect_equal(textured, plain, name);
            EXPECT_GT(std::abs(whole.g - plain.g), 1e-4 * plain.g) << name << " changes nothing";
        }
}
TEST(LayerForms, NumbersHaveTextures)
{
    const Number numbers[] = {
        {"specular", field<&Material::specular, &Material::Specular::weight>},
        {"anisotropy", field<&Material::microfacets, &Material::Microfacets::anisotropy>},
        {"transmission", field<&Material::transmission, &Material::Transmission::weight>},
        {"diffuse_transmission", field<&Material::diffuse_transmission, &Material::DiffuseTransmission::weight>},
        {"diffuse_roughness", field<&Material::diffuse_roughness>},
        {"coat", field<&Material::coat, &Material::Coat::weight>},
        {"coat_roughness", field<&Material::coat, &Material::Coat::roughness>},
        {"sheen_roughness", field<&Material::sheen, &Material::Sheen::roughness>},
        {"thin_film", field<&Material::thin_film, &Material::ThinFilm::weight>},
        {"thin_film_thickness", field<&Material::thin_film, &Material::ThinFilm::thickness>}};
    expect_textured_numbers({}, enable_all_layers, numbers);
}
TEST(LayerForms, DisneysNumbersHaveTextures)
{
    const Number solid[] = {{"anisotropy", field<&Material::microfacets, &Material::Microfacets::anisotropy>},
                            {"flatness", field<&Material::disney, &Material::Disney::flatness>},
                            {"sheen", field<&Material::disney, &Material::Disney::sheen>},
                            {"sheen_tint", field<&Material::disney, &Material::Disney::sheen_tint>},
                            {"coat", field<&Material::coat, &Material::Coat::weight>},
                            {"coat_gloss", field<&Material::disney, &Material::Disney::coat_gloss>},
                            {"metallic", field<&Material::metallic>},
                            {"specular_tint", field<&Material::disney, &Material::Disney::specular_tint>},
                            {"roughness", field<&Material::roughness>},
                            {"transmission", field<&Material::transmission, &Material::Transmission::weight>}};
    const Number sheet[] = {
        {"diffuse_transmission", field<&Material::diffuse_transmission, &Material::DiffuseTransmission::weight>}};
    // Sheen is visible at these grazing directions.
    const Shown shown{normalize(Vec3d{1.5, -0.3, 0.5}), normalize(Vec3d{-1.2, 0.6, 0.4})};
    expect_textured_numbers(shown, [](Material& m) { enable_all_disney_lobes(m, false); }, solid);
    expect_textured_numbers(shown, [](Material& m) { enable_all_disney_lobes(m, true); }, sheet);
}
TEST(LayerForms, ColorsHaveTextures)
{
    struct Named {
        std::string name;
        Field<Material, ColorInput> member;
    };
    const Named colors[] = {
        {"specular_color", field<&Material::specular, &Material::Specular::color>},
        {"edge_color", field<&Material::conductor, &Material::Conductor::edge_color>},
        {"transmission_color", field<&Material::transmission, &Material::Transmission::color>},
        {"diffuse_transmission_color", field<&Material::diffuse_transmission, &Material::DiffuseTransmission::color>},
        {"coat_color", field<&Material::coat, &Material::Coat::color>},
        {"sheen_color", field<&Material::sheen, &Material::Sheen::color>}};
    for (const auto& [name, member] : colors) {
        Shown shown;
        const bool is_beyond = name.find("transmission") != std::string::npos;
        // The edge color of a metal shows at grazing directions.
        if (name == "edge_color")
            shown.to_eye = normalize(Vec3d{3, 0, 1}), shown.to_light = normalize(Vec3d{-3, 0.2, 1});
        if (is_beyond) shown.to_light = normalize(Vec3d{-0.4, 0.3, -0.8});
        const auto render = [&](Color times, bool textured) {
            return shown.of([&](Material& m, SceneBuilder& b) {
                enable_all_layers(m);
                ColorInput& input = member(m);
                input.value = {input.value.r * times.r, input.value.g * times.g, input.value.b * times.b};
                if (textured) input.texture = constant(b, {0.5f, 0.75f, 0.25f});
            });
        };
        const Color textured = render({1, 1, 1}, true), plain = render({0.5f, 0.75f, 0.25f}, false),
                    whole = render({1, 1, 1}, false);
        expect_equal(textured, plain, name);
        EXPECT_GT(std::abs(whole.r - plain.r), 1e-4 * plain.r) << name << " changes nothing";
    }
}

/// Diffuse transmission of light from behind follows Lambert's law, times the transmitted fraction.
TEST(LayerForms, DiffuseTransmissionOfLightFromBehind)
{
    Shown shown;
    shown.to_light = normalize(Vec3d{-0.3, 0.4, -0.9});
    const Color c = shown.of([&](Material& m, SceneBuilder&) {
        m.specular.weight.value = 0;
        m.diffuse_transmission.weight.value = 0.4f, m.diffuse_transmission.color.value = {0.9f, 0.5f, 0.2f};
    });
    const double lambert = 0.4 * -shown.to_light.z / pi;
    expect_equal(c, {float(0.9 * lambert), float(0.5 * lambert), float(0.2 * lambert)}, "from behind");
}

/// Returns f cos of GGX with height-correlated masking (alphas along t and b) and Schlick's Fresnel term with f0.
double ggx(Vec3d n, Vec3d t, Vec3d b, double along, double across, double f0, Vec3d o, Vec3d l)
{
    const Vec3d h = normalize(o + l);
    const double x = dot(t, h) / along, y = dot(b, h) / across, z = dot(n, h);
    const double d = 1 / (pi * along * across * std::pow(x * x + y * y + z * z, 2));
    const auto lambda = [&](Vec3d w) {
        const double s = std::pow(along * dot(t, w), 2) + std::pow(across * dot(b, w), 2);
        return 0.5 * (std::sqrt(1 + s / std::pow(dot(n, w), 2)) - 1);
    };
    const double f = f0 + (1 - f0) * std::pow(1 - dot(o, h), 5);
    return f * d / (1 + lambda(o) + lambda(l)) / (4 * dot(n, o));
}

/// The coat's normal map does not bend the base, and the base's normal map does not bend the coat.
TEST(LayerForms, CoatHasItsOwnNormal)
{
    const Vec3d n = normalize(Vec3d{0.3, 0.2, 1});
    for (const bool base_is_bent : {false, true}) {
        const Shown shown;
        const Color c = shown.of([&](Material& m, SceneBuilder& b) {
            m.base_color.value = {0, 0, 0};
            m.specular.weight.value = 0;
            m.coat.weight.value = 0.75f, m.coat.roughness.value = 0.5f;
            m.coat.normal_texture = constant(b, {float(0.5 + n.x / 2), float(0.5 + n.y / 2), float(0.5 + n.z / 2)});
            if (base_is_bent) m.normal_map.texture = constant(b, {0.4f, 0.6f, 0.9f});
        });
        const Vec3d t = normalize(cross({0, 1, 0}, n)), b = cross(n, t);
        const double f = 0.75 * ggx(n, t, b, 0.25, 0.25, 0.04, shown.to_eye, shown.to_light);
        EXPECT_NEAR(c.g, f, 2e-3 * f) << "base bent: " << base_is_bent;
    }
}
/// Radiance of a surface with anisotropic facets stretched at this angle to its tangent. mapped: part of the angle that
/// comes from a map; n: normal from a map.
void expect_anisotropic(double angle, double mapped, Vec3d n)
{
    const Shown shown;
    const Color c = shown.of([&](Material& m, SceneBuilder& b) {
        m.base_color.value = {0.3f, 0.3f, 0.3f};
        m.metallic.value = 1;
        m.microfacets.energy_compensation = false;
        m.microfacets.anisotropy.value = 0.8f;
        m.microfacets.anisotropy_rotation = angle - mapped;
        if (mapped != 0)
            m.microfacets.anisotropy_texture =
                constant(b, {float(0.5 + std::cos(mapped) / 2), float(0.5 + std::sin(mapped) / 2), 1});
        m.normal_map.texture = constant(b, {float(0.5 + n.x / 2), float(0.5 + n.y / 2), float(0.5 + n.z / 2)});
    });
    const Vec3d direction{std::cos(angle), std::sin(angle), 0};
    const Vec3d t = normalize(direction - n * dot(n, direction)), b = cross(n, t);
    const double f = ggx(n, t, b, 0.25 + 0.75 * 0.64, 0.25, 0.3, shown.to_eye, shown.to_light);
    EXPECT_NEAR(c.g, f, 2e-3 * f) << "angle " << angle << ", mapped " << mapped << ", normal " << n.x;
}
/// Anisotropy is rotated from the tangent towards the bitangent; a map's direction adds to it.
TEST(LayerForms, AnisotropyHasADirection)
{
    for (const double angle : {0.0, 0.6, -1.1})
        for (const double mapped : {0.0, 0.8}) {
            expect_anisotropic(angle + mapped, mapped, {0, 0, 1});
            expect_anisotropic(angle + mapped, mapped, normalize(Vec3d{0.3, 0.2, 1}));
        }
}

/// If a metal has an index of refraction, its color is ignored, also in a mixture with a dielectric.
TEST(LayerForms, MetalsReflectByTheirIndex)
{
    const auto seen = [](float metallic, bool by_index) {
        return Shown().of([&](Material& m, SceneBuilder&) {
            m.metallic.value = metallic;
            m.microfacets.energy_compensation = false;
            m.base_color.value = by_index ? Color{0.4f, 0.5f, 0.6f} : Color{1, 1, 1};
            if (by_index) m.conductor.eta = {2.5f, 0.2f, 0}, m.conductor.k = {1, 3.4f, 0};
        });
    };
    const auto fresnel = [](std::complex<double> index) {
        const Shown shown;
        const double c = dot(shown.to_eye, normalize(shown.to_eye + shown.to_light)), s2 = 1 - c * c;
        const std::complex<double> square = index * index, t = std::sqrt(square - s2);
        return (std::norm((c - t) / (c + t)) + std::norm((square * c - t) / (square * c + t))) / 2;
    };
    const Color white = seen(1, false), metal = seen(1, true);
    EXPECT_NEAR(metal.r / white.r, fresnel({2.5, 1}), 1e-3);
    EXPECT_NEAR(metal.g / white.g, fresnel({0.2, 3.4}), 1e-3);
    EXPECT_LT(metal.b / white.b, 0.7);
}

/// Facets are oriented by the shape's tangent: a square, disk or sphere rotated about the normal together with viewer
/// and light looks unchanged.
TEST(LayerForms, TangentsTurnWithTheShape)
{
    const auto seen = [](MaterialKind kind, int shape, double turn) {
        const Transform turned = Transform::rotate({0, 0, 1}, turn);
        const Shown shown{turned.vector(normalize(Vec3d{0.5, -0.3, 1})),
                          turned.vector(normalize(Vec3d{-0.2, 0.6, 0.8}))};
        return shown.of([&](Material& m, SceneBuilder& b) {
            m.kind = kind;
            m.metallic.value = 1, m.microfacets.anisotropy.value = 0.9f;
            const int material = b.material(m);
            // The shape lies above the existing one, which it hides.
            const Vec3d along = turned.vector({1, 0, 0}), across = turned.vector({0, 1, 0}), up{0, 0, 0.01};
            if (shape == 0) b.add(Rectangle{up - along - across, along * 2, across * 2}, material);
            Node node;
            node.parent_from_node = turned;
            if (shape == 1) node.shapes = {{Disk{up, {0, 0, 1}, 1}, material, ""}};
            if (shape == 2) node.shapes = {{Sphere{{0, 0, -399.99}, 400, {}}, material, ""}};
            b.scene.roots.push_back(int(b.scene.nodes.size()));
            b.scene.nodes.push_back(node);
        });
    };
    for (const MaterialKind kind : {MaterialKind::principled, MaterialKind::disney})
        for (int shape = 0; shape < 3; ++shape) {
            const Color straight = seen(kind, shape, 0);
            for (const double turn : {0.5, 1.3})
                EXPECT_NEAR(seen(kind, shape, turn).r, straight.r, 2e-3 * straight.r) << shape << " " << turn;
        }
}

/// A white solid keeps all light, also if part of it, or each color separately, is refracted.
TEST(LayerForms, FurnaceOfSolids)
{
    for (const float share : {0.5f, 1.0f})
        for (const float dispersion : {0.0f, 5.0f}) {
            SceneBuilder b;
            b.camera({0, 0, 4}, {0, 0, 0}, 20);
            Material m;
            m.kind = MaterialKind::principled;
            m.base_color.value = {1, 1, 1};
            m.roughness.value = 0.05f;
            m.transmission.weight.value = share;
            m.transmission.dispersion = dispersion;
            m.specular.weight.value =
                share == 1 ? 0.999f : 1;  // slightly below 1, so that the closure is not plain glass
            b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(m));
            b.scene.environment.kind = EnvironmentKind::constant;
            b.scene.environment.color = {1, 1, 1};
            RenderSettings settings = small_image_settings(16, 16);
            settings.max_depth = 2000;
            expect_mean(render_film(b.scene, settings, 256), 1, 0.006);
        }
}

}  // namespace
}  // namespace fathom
