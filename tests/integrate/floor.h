// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "picture_helpers.h"

namespace fathom::test {

/// A scene with a floor y = 0, whose irradiance is measured at one point seen from above, by each rendering path: quad
/// loop, list of shapes (with a sphere), BVH, and everything instanced.
class Floor {
public:
    static constexpr float albedo = 0.5f;
    static constexpr const char* ways[] = {"quads", "list", "tree", "instances"};

    std::function<void(SceneBuilder&)> add_objects;
    std::uint64_t samples = 64;
    bool light_sampling = true;
    double shutter_close = 0;

    /// Irradiance at (x, 0, z) by channel, from the image's mean.
    Mean irradiance(double x, double z, int way) const
    {
        SceneBuilder b;
        b.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, b.diffuse(albedo));
        add_objects(b);
        // Extra spheres far from the measured point select the rendering path.
        for (int i = 0; i < (way == 0 ? 0 : way == 1 ? 1 : 100); ++i)
            b.add(Sphere{{40 - 0.1 * i, -3, 0}, 0.02, {}}, b.diffuse(0.5f));
        for (Node& node : b.scene.nodes) node.movable = way == 3;
        b.camera({x, 0.02, z}, {x, 0, z});
        b.scene.cameras[0].kind = CameraKind::orthographic;
        b.scene.cameras[0].height = 1e-3;
        b.scene.cameras[0].shutter_close = shutter_close;
        RenderSettings settings = small_image_settings(8, 8);
        settings.light_sampling = light_sampling;
        Mean m = mean_of(render_film(b.scene, settings, samples));
        for (int c = 0; c < 3; ++c) {
            m.value[c] *= std::numbers::pi / double(albedo);
            m.error[c] *= std::numbers::pi / double(albedo);
        }
        return m;
    }

    void expect(double x, double z, double expected, double relative = 1e-3) const
    {
        for (int way = 0; way < 4; ++way) {
            const Mean m = irradiance(x, z, way);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(m.value[c], expected, 4 * m.error[c] + relative * expected + 1e-6)
                    << "at " << x << ", " << z << " as " << ways[way] << ", channel " << c;
        }
    }
};

}  // namespace fathom::test
