/// Media of pbrt's files around shapes; those within are glass: pbrt_test.cpp.
#include <cmath>

#include "pbrt_fixture.h"

namespace fathom::test {
namespace {

constexpr const char* fog = R"(MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.5 0.5 0.5 ]
"rgb sigma_s" [ 1.5 1.5 1.5 ]
)";

/// What the camera is in is everywhere where nothing else is. It has its name before, its numbers perhaps after.
TEST_F(Pbrt, MediumAroundTheCamera)
{
    const SceneDescription scene =
        load("a.pbrt", std::string("Translate 0 0 8 MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin\n") +
                           fog + R"(MediumInterface "" "fog" Shape "sphere")");
    EXPECT_TRUE(warnings_.counts().empty());
    // pbrt's world is left-handed: all is below a node that mirrors.
    const Node& mirror = scene.nodes.at(std::size_t(scene.roots.at(0)));
    const Shape& around = scene.nodes.at(std::size_t(mirror.children.back())).shapes.at(0);
    const Sphere& ball = std::get<Sphere>(around.geometry);
    // From -8 to 1, and from -1 to 1.
    EXPECT_NEAR(ball.center.z, -3.5, 1e-6);
    EXPECT_NEAR(ball.radius, std::sqrt(9 * 9 + 2 * 2 + 2 * 2), 1e-6);
    const Material& m = scene.materials.at(std::size_t(around.material));
    EXPECT_EQ(m.priority, -1000);
    EXPECT_NEAR(-std::log(m.attenuation_color.r) / m.attenuation_distance, 2, 1e-4);
    EXPECT_NEAR(m.transmission_scatter.r / m.attenuation_distance, 1.5, 1e-4);
}

TEST_F(Pbrt, MediaOutsideOfShapes)
{
    const std::string shape = R"(MediumInterface "" "fog" Material "dielectric" Shape "sphere" "float radius" 0.5 )";
    world(fog + shape);
    EXPECT_TRUE(is_told("is around shapes, but neither in one nor around the camera"));
    warnings_ = {};
    world(fog + shape + R"(MediumInterface "fog" "" Material "interface" Shape "sphere")");
    EXPECT_TRUE(warnings_.counts().empty()) << "another shape has it inside";
    EXPECT_NE(error(R"(MediumInterface "" "mist" Shape "sphere")").find("there is no medium 'mist'"),
              std::string::npos);
}

/// A boundary of nothing within a medium is a solid of nothing.
TEST_F(Pbrt, HolesInMedia)
{
    const Material hole = material(std::string(fog) + R"(MediumInterface "" "fog" Material "interface")");
    EXPECT_EQ(hole.kind, MaterialKind::glass);
    EXPECT_EQ(hole.ior, 1);
    EXPECT_EQ(hole.attenuation_distance, 0);
    EXPECT_EQ(material("Material \"interface\"").kind, MaterialKind::none);
}

}  // namespace
}  // namespace fathom::test
