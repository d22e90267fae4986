// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// A white unlit panel is visible directly, in a mirror and through glass, but does not illuminate the floor.
TEST(Unlit, IsVisibleButDoesNotIlluminate)
{
    for (const bool quads : {true, false}) {
        const auto scene = [&](Vec3d from, Vec3d at) {
            SceneBuilder b;
            b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, b.diffuse(0.5f));
            Material panel;
            panel.kind = MaterialKind::unlit;
            panel.base_color.value = {0.75f, 0.75f, 0.75f};
            b.add(Rectangle{{-1, 0.1, -1}, {2, 0, 0}, {0, 2, 0}}, b.material(panel));
            if (!quads) {
                Material mirror, glass;
                mirror.kind = MaterialKind::metal;
                mirror.base_color.value = {1, 1, 1};
                glass.kind = MaterialKind::glass;
                glass.ior = 1;
                b.add(Rectangle{{-2, 0, 2}, {0, 3, 0}, {4, 0, 0}}, b.material(mirror));  // a mirror across the room
                b.add(Sphere{{0, 1, 0}, 0.2, {}}, b.material(glass));
            }
            b.camera(from, at, 1);
            return mean_of(render_film(b.scene, small_image_settings(8, 8), 64)).value[0];
        };
        EXPECT_NEAR(scene({0, 1, 1}, {0.5, 1, -1}), 0.75, 1e-5);
        EXPECT_EQ(scene({0, 1, 1}, {0, 0, -0.5}), 0);  // the floor is not illuminated
        if (quads) continue;
        EXPECT_NEAR(scene({0.3, 1, 1}, {0, 1, 2}), 0.75, 1e-5);  // the panel is visible in the mirror
        EXPECT_NEAR(scene({0, 1, 1}, {0, 1, 0}), 0.75, 1e-5);    // the panel is visible through the glass
    }
}

}  // namespace
}  // namespace fathom
