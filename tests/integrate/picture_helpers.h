// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
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
};

/// Rotates -z, along which lights emit, to a direction.
inline Transform shining(Vec3d along)
{
    const Vec3d d = normalize(along), axis = cross({0, 0, -1}, d);
    return Transform::rotate(length(axis) > 1e-9 ? axis : Vec3d{0, 1, 0}, std::acos(std::clamp(-d.z, -1.0, 1.0)));
}

inline RenderSettings small_picture(int width = 32, int height = 24)
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

/// The image's mean is `expected` within four standard errors plus the relative tolerance.
inline void expect_mean(const Film& film, double expected, double relative = 0.002)
{
    const Mean m = mean_of(film);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(m.value[c], expected, 4 * m.error[c] + relative * expected) << "channel " << c;
}

}  // namespace fathom::test
