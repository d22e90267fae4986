// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>

#include "picture_helpers.h"

namespace fathom::test {

inline Material conductor(float roughness, float albedo = 1)
{
    Material m;
    m.kind = MaterialKind::metal;
    m.base_color.value = {albedo, albedo, albedo};
    m.roughness.value = roughness;
    return m;
}
inline Material dielectric(float roughness = 0)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = 1.5f;
    m.roughness.value = roughness;
    return m;
}

/// A material that only emits.
inline Material lamp_of(float radiance)
{
    Material m;
    m.kind = MaterialKind::none;
    m.emission.radiance.value = {radiance, radiance, radiance};
    return m;
}

inline RenderSettings traced(int width = 8, int height = 8)
{
    RenderSettings s = small_image_settings(width, height);
    s.light_paths = 1;
    return s;
}

/// A floor of reflectance 1/2 of which an orthographic camera sees the square |x|, |z| < 1/2 from above.
struct SeenFloor : SceneBuilder {
    explicit SeenFloor(int spheres = 0, double half = 4)
    {
        add(Rectangle{{-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}}, diffuse(0.5f));
        // Spheres below the floor select how rays are traced: by a list, or by a BVH.
        for (int i = 0; i < spheres; ++i) add(Sphere{{half * (1 - 0.02 * i), -half, 0}, 0.02, {}}, diffuse(0.5f));
        camera({0, 0.4, 0}, {0, 0, 0});
        scene.cameras[0].kind = CameraKind::orthographic;
        scene.cameras[0].height = 1;
    }
};

/// A closed room with a lamp, as path tracing and light tracing see it.
struct Room : SceneBuilder {
    Room()
    {
        const int white = diffuse(0.7f), red = diffuse(0.4f);
        add(Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, white);
        add(Rectangle{{-1, 2, -1}, {2, 0, 0}, {0, 0, 2}}, white);
        add(Rectangle{{-1, 0, -1}, {2, 0, 0}, {0, 2, 0}}, white);
        add(Rectangle{{-1, 0, 1}, {0, 0, -2}, {0, 2, 0}}, red);
        add(Rectangle{{1, 0, -1}, {0, 0, 2}, {0, 2, 0}}, red);
        camera({0, 1, 3.5}, {0, 1, 0}, 40);
    }
    /// Objects whose scattering light samples can follow.
    Room& with_rough_objects()
    {
        add(Sphere{{-0.45, 0.35, -0.3}, 0.35, {}}, material(conductor(0.4f, 0.8f)));
        add(Sphere{{0.45, 0.35, 0.2}, 0.35, {}}, material(dielectric(0.5f)));
        return *this;
    }
    Room& with_smooth_objects()
    {
        add(Sphere{{-0.45, 0.35, -0.3}, 0.35, {}}, material(conductor(0)));
        add(Sphere{{0.45, 0.35, 0.2}, 0.35, {}}, material(dielectric()));
        return *this;
    }
    Room& with_lamp(float radiance = 10)
    {
        add(Rectangle{{-0.4, 1.99, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}}, material(lamp_of(radiance)));
        return *this;
    }
    Room& with(const Light& l, Vec3d p = {0.1, 1.7, 0.1}, Vec3d d = {0.1, -1, -0.1})
    {
        light(l, Transform::translate(p) * rotate_to(d));
        return *this;
    }
    Room& as_tree()
    {
        for (int i = 0; i < 100; ++i) add(Sphere{{3 - 0.1 * i, -3, 0}, 0.02, {}}, 0);
        return *this;
    }
};

/// Means of the image's blocks of pixels and their variances, for one channel.
struct Block {
    double mean = 0, variance = 0;
};
inline std::vector<Block> blocks_of(const Film& film, int across)
{
    const Image image = film.image(false, true);
    const auto &pixels = image.layers[0].pixels, &variance = image.find("variance")->pixels;
    std::vector<Block> blocks(std::size_t(across * across));
    const double scale = double(across * across) / (image.width * image.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            Block& b = blocks[std::size_t(y * across / image.height * across + x * across / image.width)];
            const std::size_t i = 3 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) + 1;
            b.mean += double(pixels[i]) * scale;
            b.variance += double(variance[i]) * scale * scale;
        }
    return blocks;
}

inline std::vector<std::pair<const char*, Light>> lamps()
{
    std::vector<std::pair<const char*, Light>> all;
    const auto lamp = [&](const char* name, LightKind kind, float intensity) -> Light& {
        all.push_back({name, {}});
        all.back().second.kind = kind;
        all.back().second.intensity = {intensity, intensity, intensity};
        return all.back().second;
    };
    lamp("point", LightKind::point, 1);
    lamp("spot", LightKind::spot, 3);
    lamp("wide spot", LightKind::spot, 3).outer_angle = 1.3;
    lamp("linear spot", LightKind::spot, 3).falloff = SpotFalloff::linear;
    lamp("beam", LightKind::beam, 4);
    lamp("round beam", LightKind::beam, 4).round = true;
    lamp("tube", LightKind::tube, 4).radius = 0.1;
    return all;
}

}  // namespace fathom::test
