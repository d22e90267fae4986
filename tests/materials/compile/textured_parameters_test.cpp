// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "compile/compiled_scenes.h"
#include "scene/material_table.h"

// For every textured parameter of every kind of material, a constant texture equals the plain value.
namespace fathom {
namespace {

constexpr float texture_value = 0.5f;

/// A sphere in a gradient environment, with every layer of its material enabled.
SceneDescription ball_of(MaterialKind kind)
{
    SceneDescription d = empty_scene();
    d.cameras[0].position = {0, 0, 4};
    d.cameras[0].look_at = {0, 0, 0};
    d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, 1, {}}, 0, ""});
    d.environment.kind = EnvironmentKind::gradient;
    d.environment.bottom = {0.2f, 0.1f, 0}, d.environment.top = {1, 2, 3};
    Texture even;
    even.kind = TextureKind::checker_uv;
    even.color_a.value = even.color_b.value = {texture_value, texture_value, texture_value};
    d.textures.push_back(even);
    Material m;
    m.kind = kind;
    m.base_color.value = {0.6f, 0.5f, 0.4f};
    m.roughness.value = 0.5f, m.metallic.value = 0.3f;
    m.transmission.weight.value = 0.3f, m.diffuse_transmission.weight.value = 0.3f, m.diffuse_roughness.value = 0.5f;
    m.coat.weight.value = 0.5f, m.coat.roughness.value = 0.3f;
    m.sheen.color.value = {0.3f, 0.3f, 0.3f};
    m.thin_film.weight.value = 0.5f, m.thin_film.thickness.value = 300;
    m.microfacets.anisotropy.value = 0.5f;
    m.disney.sheen.value = 0.3f, m.disney.sheen_tint.value = 0.5f, m.disney.flatness.value = 0.5f,
    m.disney.specular_tint.value = 0.5f;
    m.disney.coat_gloss.value = 0.5f;
    m.opacity.mode = AlphaMode::blend;
    d.materials.push_back(m);
    return d;
}

std::vector<float> pixels_of(const SceneDescription& d, std::uint64_t samples)
{
    RenderSettings settings;
    settings.width = settings.height = 16;
    settings.filter = Filter::box;
    const RenderJob job(compiled(d), settings);
    Film film(job);
    EXPECT_TRUE(render(job, {0, samples}, film));
    return film.image(false, false).layers[0].pixels;
}

double difference(const std::vector<float>& a, const std::vector<float>& b)
{
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::abs(double(a[i]) - double(b[i])), all += double(a[i]) + double(b[i]);
    return sum / all;
}
double difference_of_means(const std::vector<float>& a, const std::vector<float>& b)
{
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += double(a[i]) - double(b[i]), all += double(a[i]) + double(b[i]);
    return std::abs(sum) / all;
}

/// Sets an input to a value, either directly or as 2 * value times the texture.
void set(ColorInput& input, float value, bool textured)
{
    const float v = textured ? value / texture_value : value;
    input.value = {v, v, v};
    input.texture = textured ? 0 : -1;
}
void set(FloatInput& input, float value, bool textured)
{
    input.value = textured ? value / texture_value : value;
    input.texture = textured ? 0 : -1, input.channel = 0;
}

TEST(TexturedParameters, AnEvenTextureIsItsValue)
{
    // Some parameters are not compared: a constant bump has no slope, textured emission is sampled differently, and
    // parameters of the interior choose at random, so only means agree.
    const std::set<std::string> not_compared = {"bump", "emission", "factor"};
    const std::set<std::string> by_mean = {"subsurface", "subsurface_color", "subsurface_radius",
                                           "subsurface_radius_scale"};
    int compared = 0;
    for (const Parameter<Material>& p : material_parameters()) {
        if (not_compared.contains(p.key)) continue;
        std::visit(
            [&](auto member) {
                using Member = decltype(member);
                if constexpr (std::is_same_v<Member, Field<Material, ColorInput>> ||
                              std::is_same_v<Member, Field<Material, FloatInput>>)
                    for (const KindName<MaterialKind>& kind : material_kinds()) {
                        if (!p.is_of(std::uint32_t(kind.kind)) || kind.kind == MaterialKind::mix ||
                            kind.kind == MaterialKind::two_sided || kind.kind == MaterialKind::measured)
                            continue;
                        SCOPED_TRACE(std::string(kind.name) + " " + p.key);
                        SceneDescription d = ball_of(kind.kind);
                        const bool by_chance = by_mean.contains(p.key);
                        if (by_chance)
                            d.materials[0].subsurface.weight.value = 1, d.materials[0].transmission.weight.value = 0;
                        const float value = std::string(p.key) == "thin_film_thickness" ? 300 : 0.4f;
                        const std::uint64_t samples = by_chance ? 256 : 16;
                        std::vector<float> images[2];
                        for (const bool textured : {false, true}) {
                            set(member(d.materials[0]), value, textured);
                            images[int(textured)] = pixels_of(d, samples);
                        }
                        if (by_chance)
                            EXPECT_LT(difference_of_means(images[0], images[1]), 0.02);
                        else
                            EXPECT_LT(difference(images[0], images[1]), 1e-3);
                        ++compared;
                    }
            },
            p.member);
    }
    EXPECT_GT(compared, 60);
}

}  // namespace
}  // namespace fathom
