// SPDX-License-Identifier: Apache-2.0
/// Ray origins are offset from surfaces: far enough to avoid self-intersection, but no farther than rounding requires.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

/// More primitives than a flat scene allows, out of view, so that visible shapes are intersected through the BVH.
void add_crowd(SceneBuilder& b, Vec3d at, double size)
{
    const int black = b.diffuse(0);
    for (int i = 0; i < 100; ++i) b.add(Sphere{at + Vec3d{3 * size * i, 0, 0}, size, {}}, black);
}

/// Fraction of a square of side 6 around (1, 0) covered by a disk of radius 1 or a sphere's shadow under light at 45
/// degrees: an ellipse.
double covered_fraction()
{
    constexpr int n = 2000;
    int covered = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double x = 6 * (i + 0.5) / n - 2, y = 6 * (j + 0.5) / n - 3;
            covered += x * x + y * y < 1 || (x - 1) * (x - 1) / 2 + y * y < 1;
        }
    return double(covered) / (n * n);
}

/// A black sphere on a 10 km ground, and its shadow, have the right size next to each other.
TEST(RayOffset, ShadowsOfSmallThingsOnAHugeGround)
{
    const double share = covered_fraction();
    for (const bool in_tree : {false, true})
        for (const bool mesh : {false, true})
            for (const double radius : {1e-3, 1e-2, 1.0}) {
                // Triangle intersection adds 10 km to a millimeter, which floats can't resolve.
                if ((in_tree || mesh) && radius < 1e-2) continue;
                SceneBuilder b;
                const int gray = b.diffuse(0.5f);
                if (mesh) {
                    Mesh ground;
                    ground.positions = {{-5000, 0, -5000}, {5000, 0, -5000}, {-4000, 0, 5000}, {5000, 0, 5000}};
                    ground.indices = {0, 2, 1, 1, 2, 3};
                    b.scene.meshes.push_back(ground);
                    b.add(MeshInstance{0}, gray);
                } else {
                    b.add(Rectangle{{-5000, 0, 5000}, {10000, 0, 0}, {0, 0, -10000}}, gray);
                }
                Material black;
                black.kind = MaterialKind::none;
                b.add(Sphere{{0, radius, 0}, radius, {}}, b.material(black));
                if (in_tree) add_crowd(b, {0, -100, 0}, 1);
                Light sun;
                sun.kind = LightKind::directional;
                sun.intensity = {4, 4, 4};
                b.light(sun, Transform::rotate({0, 0, 1}, pi / 4) * Transform::rotate({1, 0, 0}, -pi / 2));
                b.camera({radius, 10 * radius, 0}, {radius, 0, 0});
                b.scene.cameras[0].kind = CameraKind::orthographic;
                b.scene.cameras[0].height = 6 * radius;
                b.scene.cameras[0].up = {0, 0, 1};
                SCOPED_TRACE(std::to_string(in_tree) + std::to_string(mesh) + " " + std::to_string(radius));
                const Mean mean = mean_of(render_film(b.scene, small_image_settings(64, 64), 16));
                const double lit = 0.5 / pi * 4 * std::sqrt(0.5);
                EXPECT_NEAR(mean.value[0] / lit, 1 - share, 0.01);
            }
}

/// A sphere of flat-shaded triangles.
Mesh ball_mesh(std::uint32_t n)
{
    return octahedron_mesh(n, [n](Vec3d sign, std::uint32_t i, std::uint32_t j) {
        return rounded(normalize(Vec3d{sign.x * i, sign.y * j, sign.z * (n - i - j)}));
    });
}

/// Convex objects never shadow themselves: with albedo 1/2 under a white sky every sample is exactly half of it.
TEST(RayOffset, ConvexSurfacesDoNotShadowThemselves)
{
    Mesh sheet;
    sheet.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
    sheet.indices = {0, 1, 2, 2, 1, 3};
    const std::vector<decltype(Shape::geometry)> shapes = {
        Sphere{{0, 0, 0}, 1, {}},
        Disk{{0, 0, 0}, {0, 0, 1}, 1},
        Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}},
        Box{{-1, -1, -1}, {1, 1, 1}},
        MeshInstance{0},
        MeshInstance{1},
        PointsInstance{0},
    };
    Points points;
    points.centers = {{0, 0, 0}};
    points.radii = {1};
    const Transform turns[] = {Transform(), Transform::rotate({1, 2, 3}, 1) * Transform::scale({1, 0.7, 1.2})};
    for (const auto& shape : shapes)
        for (const bool in_tree : {false, true})
            for (const bool moves : {false, true})
                for (const Transform& turn : turns)
                    for (const double size : {1e-3, 1.0, 1e4})
                        for (const double distance : {1.5, 100.0}) {
                            SceneBuilder b;
                            b.scene.meshes = {sheet, ball_mesh(24)};
                            b.scene.points = {points};
                            Node node;
                            node.parent_from_node = Transform::scale({size, size, size}) * turn;
                            if (moves) {
                                const Transform moved =
                                    Transform::translate({0.2 * size, 0, 0}) * Transform::rotate({0, 1, 0}, 0.3);
                                node.motion = {{0, node.parent_from_node}, {1, moved * node.parent_from_node}};
                            }
                            const int gray = b.diffuse(0.5f);
                            node.shapes.push_back({shape, gray, ""});
                            b.scene.nodes.push_back(node);
                            b.scene.roots.push_back(1);
                            if (shape.index() == 0 && std::get<MeshInstance>(shape).mesh == 1) {
                                // Two copies with more than 4096 triangles become instances.
                                b.scene.nodes.push_back({});
                                b.scene.nodes[2].children = {1};
                                b.scene.nodes[2].parent_from_node = Transform::translate({0, 0, -100 * size});
                                b.scene.roots.push_back(2);
                            }
                            if (in_tree) add_crowd(b, Vec3d{0, 0, -200} * size, 0.01 * size);
                            b.scene.environment = uniform_sky();
                            // The view is limited to the object's center, so that the sky is not visible.
                            const Vec3d front = normalize(node.parent_from_node.vector({0.3, 0.2, 1}));
                            b.camera(front * (distance * size), {0, 0, 0}, 0.5 / distance * 60);
                            b.scene.cameras[0].shutter_close = moves ? 1 : 0;
                            const Mean mean = mean_of(render_film(b.scene, small_image_settings(16, 16), 16));
                            EXPECT_NEAR(mean.value[0], 0.5, 1e-5)
                                << "shape " << &shape - shapes.data() << " in tree " << in_tree << " moves " << moves
                                << " turn " << &turn - turns << " size " << size << " distance " << distance;
                        }
}

/// No light passes the walls of a closed box of any size or rotation, in millions of paths.
TEST(RayOffset, ClosedBoxesAreDark)
{
    for (const bool in_tree : {false, true})
        for (const double size : {1e-3, 1.0, 1e4})
            for (const Transform& turn : {Transform(), Transform::rotate({1, 2, 3}, 1)}) {
                SceneBuilder b;
                Node node;
                node.parent_from_node = Transform::scale({size, size, size}) * turn;
                node.shapes.push_back({Box{{-1, -1, -1}, {1, 1, 1}}, b.diffuse(0.8f), ""});
                b.scene.nodes.push_back(node);
                b.scene.roots.push_back(1);
                if (in_tree) add_crowd(b, Vec3d{0, 0, -5} * size, 0.01 * size);
                b.scene.environment = uniform_sky();
                b.camera(Vec3d{0.1, 0.2, 0.3} * size, Vec3d{0.9, 0.8, -0.7} * size, 100);
                EXPECT_EQ(mean_of(render_film(b.scene, small_image_settings(), 256)).value[0], 0)
                    << in_tree << " " << size;
            }
}

}  // namespace
}  // namespace fathom
