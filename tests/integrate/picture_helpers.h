// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fathom/render.h"
#include "support/placed_light.h"

namespace fathom::test {

inline Vec3f rounded(Vec3d v)
{
    return {float(v.x), float(v.y), float(v.z)};
}

/// A scene with one node that holds everything in world space.
struct SceneBuilder {
    SceneDescription scene;

    SceneBuilder()
    {
        scene.file = "test";
        scene.nodes.emplace_back();
        scene.roots.push_back(0);
    }
    int material(const Material& m)
    {
        scene.materials.push_back(m);
        return int(scene.materials.size()) - 1;
    }
    int diffuse(float albedo, Color emission = {0, 0, 0}, bool two_sided = false)
    {
        Material m;
        m.base_color.value = {albedo, albedo, albedo};
        m.emission.radiance.value = emission;
        m.emission.two_sided = two_sided;
        return material(m);
    }
    template <class Geometry>
    void add(const Geometry& geometry, int index)
    {
        scene.nodes[0].shapes.push_back({geometry, index, ""});
    }
    void camera(Vec3d from, Vec3d to, double fov_y_deg = 40)
    {
        Camera c;
        c.position = from;
        c.look_at = to;
        c.up = std::abs(normalize(to - from).y) > 0.99 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
        c.fov_y = fov_y_deg * std::numbers::pi / 180;
        scene.cameras.push_back(c);
        scene.nodes[0].camera = int(scene.cameras.size()) - 1;
    }
    void light(const Light& l, const Transform& place) { add_light(scene, l, place); }
    void point_light(Color intensity, Vec3d position)
    {
        Light l;
        l.intensity = intensity;
        light(l, Transform::translate(position));
    }
};

/// An environment of the same radiance in all directions.
inline Environment uniform_sky(Color color = {1, 1, 1})
{
    Environment e;
    e.kind = EnvironmentKind::constant;
    e.color = color;
    return e;
}

/// A diffuse floor seen from above through a narrow lens, without lights.
inline SceneBuilder floor_scene(float albedo, double fov_y_deg)
{
    SceneBuilder b;
    b.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, b.diffuse(albedo));
    b.camera({0, 1, 0}, {0, 0, 0}, fov_y_deg);
    return b;
}

/// A mesh of eight triangles, one in each octant, each split into n^2. point(sign, i, j), with the octant's signs, is
/// the position of a vertex in one of n + 1 rows.
template <class Point>
Mesh octahedron_mesh(std::uint32_t n, const Point& point)
{
    Mesh mesh;
    for (int face = 0; face < 8; ++face) {
        const Vec3d sign{face & 1 ? -1. : 1., face & 2 ? -1. : 1., face & 4 ? -1. : 1.};
        const auto base = std::uint32_t(mesh.positions.size());
        for (std::uint32_t i = 0; i <= n; ++i)
            for (std::uint32_t j = 0; j <= n - i; ++j) mesh.positions.push_back(point(sign, i, j));
        const auto at = [&](std::uint32_t i, std::uint32_t j) { return base + i * (n + 1) - i * (i - 1) / 2 + j; };
        for (std::uint32_t i = 0; i < n; ++i)
            for (std::uint32_t j = 0; j < n - i; ++j) {
                mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
                if (i + j + 1 < n)
                    mesh.indices.insert(mesh.indices.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    }
    return mesh;
}

/// Rotates -z, along which lights emit, to a direction.
inline Transform rotate_to(Vec3d along)
{
    const Vec3d d = normalize(along), axis = cross({0, 0, -1}, d);
    return Transform::rotate(length(axis) > 1e-9 ? axis : Vec3d{0, 1, 0}, std::acos(std::clamp(-d.z, -1.0, 1.0)));
}

inline RenderSettings small_image_settings(int width = 32, int height = 24)
{
    RenderSettings s;
    s.width = width;
    s.height = height;
    s.filter = Filter::box;
    return s;
}

inline Film render_film(const SceneDescription& description, const RenderSettings& settings, std::uint64_t samples)
{
    Warnings warnings;
    const Scene scene = Scene::compile(description, "", warnings);
    const RenderJob job(scene, settings);
    Film film(job);
    EXPECT_TRUE(render(job, {0, samples}, film));
    EXPECT_EQ(film.invalid_samples(), 0u);
    return film;
}

/// Mean of the normal layer of an image of one pixel.
inline Vec3d shown_normal(const SceneDescription& scene, std::uint64_t samples)
{
    RenderSettings settings = small_image_settings(1, 1);
    settings.aovs = {Aov::normal};
    const Image image = render_film(scene, settings, samples).image(false, false);
    const auto& n = image.find("normal")->pixels;
    return {n[0], n[1], n[2]};
}

struct Mean {
    double value[3] = {}, error[3] = {};  ///< image mean and its standard error
};

inline Mean mean_of(const Film& film)
{
    const Image image = film.image(false, true);
    const auto& pixels = image.layers[0].pixels;
    const auto& variance = image.find("variance")->pixels;
    Mean m;
    const double n = double(pixels.size()) / 3;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        m.value[i % 3] += pixels[i] / n;
        m.error[i % 3] += variance[i] / (n * n);
    }
    for (double& e : m.error) e = std::sqrt(e);
    return m;
}

/// Image means by light selection, each with its own seed.
inline std::array<Mean, 3> means_by_selection(const SceneDescription& scene, RenderSettings settings,
                                              std::uint64_t samples)
{
    std::array<Mean, 3> means;
    for (const LightSelection selection : {LightSelection::tree, LightSelection::power, LightSelection::uniform}) {
        settings.light_selection = selection;
        ++settings.seed;
        means[std::size_t(selection)] = mean_of(render_film(scene, settings, samples));
    }
    return means;
}

/// The image's mean is `expected` within four standard errors plus the relative tolerance.
inline void expect_mean(const Film& film, double expected, double relative = 0.002)
{
    const Mean m = mean_of(film);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(m.value[c], expected, 4 * m.error[c] + relative * expected) << "channel " << c;
}

}  // namespace fathom::test
