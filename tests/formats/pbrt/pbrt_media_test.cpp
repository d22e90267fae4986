// SPDX-License-Identifier: Apache-2.0
/// Media around shapes in pbrt files; media inside shapes become glass, see pbrt_test.cpp.
#include <cmath>

#include "pbrt_fixture.h"

namespace fathom::test {
namespace {

constexpr const char* fog_medium = R"(MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.5 0.5 0.5 ]
"rgb sigma_s" [ 1.5 1.5 1.5 ]
)";

/// The camera's medium fills all space that no other medium occupies. It is named before it may be defined.
TEST_F(Pbrt, MediumAroundTheCamera)
{
    const SceneDescription scene =
        load("a.pbrt", std::string("Translate 0 0 8 MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin\n") +
                           fog_medium + R"(MediumInterface "" "fog" Shape "sphere")");
    EXPECT_TRUE(warnings_.counts().empty());
    // pbrt's world is left-handed, so everything is below a mirroring node.
    const Node& mirror = scene.nodes.at(std::size_t(scene.roots.at(0)));
    const Shape& around = scene.nodes.at(std::size_t(mirror.children.back())).shapes.at(0);
    const Sphere& ball = std::get<Sphere>(around.geometry);
    // Bounds extend from -8 to 1 along z, and from -1 to 1 along x and y.
    EXPECT_NEAR(ball.center.z, -3.5, 1e-6);
    EXPECT_NEAR(ball.radius, std::sqrt(9 * 9 + 2 * 2 + 2 * 2), 1e-6);
    const Material& m = scene.materials.at(std::size_t(around.material));
    EXPECT_EQ(m.interior.priority, -1000);
    EXPECT_NEAR(-std::log(m.interior.attenuation_color.r) / m.interior.attenuation_distance, 2, 1e-4);
    EXPECT_NEAR(m.interior.scatter.r / m.interior.attenuation_distance, 1.5, 1e-4);
}

TEST_F(Pbrt, MediaOutsideOfShapes)
{
    const std::string shape = R"(MediumInterface "" "fog" Material "dielectric" Shape "sphere" "float radius" 0.5 )";
    world(fog_medium + shape);
    EXPECT_TRUE(has_warning("surrounds shapes, but is neither inside a shape nor around the camera"));
    warnings_ = {};
    world(fog_medium + shape + R"(MediumInterface "fog" "" Material "interface" Shape "sphere")");
    EXPECT_TRUE(warnings_.counts().empty()) << "the medium is used by another shape";
    EXPECT_NE(error(R"(MediumInterface "" "mist" Shape "sphere")").find("there is no medium 'mist'"),
              std::string::npos);
}

/// An interface with vacuum inside a medium becomes a solid of vacuum.
TEST_F(Pbrt, HolesInMedia)
{
    const Material hole = material(std::string(fog_medium) + R"(MediumInterface "" "fog" Material "interface")");
    EXPECT_EQ(hole.kind, MaterialKind::glass);
    EXPECT_EQ(hole.ior, 1);
    EXPECT_EQ(hole.interior.attenuation_distance, 0);
    EXPECT_EQ(material("Material \"interface\"").kind, MaterialKind::none);
}

}  // namespace
}  // namespace fathom::test
