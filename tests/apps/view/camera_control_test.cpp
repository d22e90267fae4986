// SPDX-License-Identifier: Apache-2.0
#include "view/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "view/camera_text.h"

namespace fathom::view {
namespace {

constexpr double tolerance = 1e-9;

void expect_near(Vec3d a, Vec3d b, double within = tolerance)
{
    EXPECT_NEAR(a.x, b.x, within);
    EXPECT_NEAR(a.y, b.y, within);
    EXPECT_NEAR(a.z, b.z, within);
}

Camera at_distance_4()
{
    Camera c;
    c.position = {0, 1, 4};
    c.look_at = {0, 1, 0};
    return c;
}

Vec3d forward(const Camera& c)
{
    return normalize(c.look_at - c.position);
}

TEST(CameraControl, IsTheScenesCameraUntilItMoves)
{
    Camera c = at_distance_4();
    c.up = {0.1, 2, 0.3};
    c.aperture = 0.1;
    c.focus_distance = 2.5;
    CameraControl control(c);
    for (int round = 0; round < 2; ++round) {
        EXPECT_EQ(control.camera().position, c.position);
        EXPECT_EQ(control.camera().look_at, c.look_at);
        EXPECT_EQ(control.camera().up, c.up);
        EXPECT_EQ(control.camera().focus_distance, c.focus_distance);
        EXPECT_NEAR(control.distance(), 2.5, tolerance);
        control.orbit(1, 0.2);
        control.zoom(3);
        control.reset();
    }
}

TEST(CameraControl, OrbitsAboutThePivot)
{
    CameraControl control(at_distance_4());
    // The scene turns to the right, so the camera moves to the left.
    control.orbit(std::numbers::pi / 2, 0);
    expect_near(control.camera().position, {-4, 1, 0});
    expect_near(control.camera().look_at, {0, 1, 0});
    control.orbit(0, std::numbers::pi / 6);
    expect_near(control.camera().position, {-4 * std::cos(std::numbers::pi / 6), 3, 0});
    expect_near(control.pivot(), {0, 1, 0});
    control.orbit(0, -std::numbers::pi / 6);
    control.orbit(-std::numbers::pi / 2, 0);
    expect_near(control.camera().position, {0, 1, 4});
    EXPECT_NEAR(control.distance(), 4, tolerance);
}

TEST(CameraControl, StopsBeforeThePoles)
{
    for (const double down : {0.3, -0.3}) {
        CameraControl control(at_distance_4());
        for (int i = 0; i < 30; ++i) control.orbit(0.1, down);
        const double along = dot(forward(control.camera()), {0, 1, 0});
        EXPECT_NEAR(along, down > 0 ? -std::cos(std::numbers::pi / 180) : std::cos(std::numbers::pi / 180), 1e-9);
        EXPECT_NEAR(length(control.camera().position - Vec3d{0, 1, 0}), 4, 1e-9);
        for (int i = 0; i < 30; ++i) control.look(0.1, down);
        EXPECT_LT(std::abs(dot(forward(control.camera()), {0, 1, 0})), 1 - 1e-5);
    }
}

TEST(CameraControl, KeepsTheHorizonOfATiltedView)
{
    // The camera is like a framing camera: `up` is perpendicular to the view, and the image is upright.
    Camera c;
    c.position = {0, 3, 4};
    c.look_at = {0, 0, 0};
    c.up = {0, 0.8, -0.6};
    CameraControl control(c);
    control.orbit(1, 0);
    EXPECT_NEAR(control.camera().position.y, 3, tolerance);
    expect_near(control.camera().up, {0, 1, 0});
    // A tilted camera orbits about its own up direction.
    c.up = {0.5, 0.8, -0.6};
    CameraControl leaning(c);
    leaning.orbit(1, 0);
    EXPECT_GT(std::abs(leaning.camera().position.y - 3), 0.1);
    EXPECT_NEAR(length(leaning.camera().position), 5, tolerance);
}

TEST(CameraControl, PansWithTheMouse)
{
    Camera c = at_distance_4();
    CameraControl control(c);
    control.pan(0.5, 0.25);
    const double height = 2 * 4 * std::tan(c.fov_y / 2);
    expect_near(control.camera().position, {-0.5 * height, 1 + 0.25 * height, 4});
    expect_near(control.pivot(), {-0.5 * height, 1 + 0.25 * height, 0});
    expect_near(forward(control.camera()), {0, 0, -1});
    c.kind = CameraKind::orthographic;
    c.height = 10;
    CameraControl flat(c);
    flat.pan(0.1, 0);
    expect_near(flat.camera().position, {-1, 1, 4});
}

TEST(CameraControl, ZoomsWithoutReachingThePivot)
{
    CameraControl control(at_distance_4());
    control.zoom(1);
    EXPECT_LT(control.distance(), 4);
    control.zoom(-1);
    EXPECT_NEAR(control.distance(), 4, tolerance);
    control.zoom(100);
    EXPECT_GT(control.distance(), 0);
    expect_near(control.pivot(), {0, 1, 0});
    Camera c = at_distance_4();
    c.kind = CameraKind::orthographic;
    CameraControl flat(c);
    flat.zoom(2);
    EXPECT_LT(flat.camera().height, c.height);
    expect_near(flat.camera().position, c.position);
}

TEST(CameraControl, FliesAndLooksAround)
{
    CameraControl control(at_distance_4());
    control.fly(0.25, 0.5, 1);
    expect_near(control.camera().position, {1, 3, 0});
    EXPECT_NEAR(control.distance(), 4, tolerance);
    control.look(std::numbers::pi / 2, 0);
    expect_near(control.camera().position, {1, 3, 0});
    expect_near(forward(control.camera()), {1, 0, 0});
    control.look(0, std::numbers::pi / 4);
    expect_near(forward(control.camera()), {std::sqrt(0.5), std::sqrt(0.5), 0});
    EXPECT_NEAR(control.distance(), 4, tolerance);
}

TEST(CameraControl, FocusesWhereItIsTold)
{
    Camera c = at_distance_4();
    c.aperture = 0.2;
    CameraControl control(c);
    const double aspect = 4.0 / 3;
    const Camera through = control.through(0.75, 0.25, aspect, 1.0 / 600);
    // The point is a quarter of the image to the right of the center and above it.
    const double tan = std::tan(c.fov_y / 2);
    expect_near(forward(through), normalize({0.5 * tan * aspect, 0.5 * tan, -1}));
    EXPECT_EQ(through.aperture, 0);
    const double distance = 5;
    Camera shifted = c;
    shifted.shift_x = 0.25, shifted.shift_y = 0.25;
    expect_near(forward(CameraControl(shifted).through(0.5, 0.5, aspect, 1.0 / 600)), forward(through));
    EXPECT_TRUE(control.focus(0.75, 0.25, aspect, distance));
    expect_near(control.pivot(), c.position + forward(through) * distance);
    expect_near(control.camera().position, c.position);
    expect_near(forward(control.camera()), {0, 0, -1});
    EXPECT_NEAR(control.camera().focus_distance, distance * -forward(through).z, tolerance);
    // The focused point is the pivot of orbits.
    const Vec3d pivot = control.pivot();
    const double away = length(control.camera().position - pivot);
    control.orbit(0.7, 0.1);
    expect_near(control.pivot(), pivot);
    EXPECT_NEAR(length(control.camera().position - pivot), away, tolerance);

    c.aperture = 0;
    CameraControl pinhole(c);
    EXPECT_FALSE(pinhole.focus(0.75, 0.25, aspect, distance));
    c.kind = CameraKind::orthographic;
    CameraControl flat(c);
    flat.focus(0.75, 0.25, aspect, distance);
    expect_near(flat.pivot(), {0.25 * c.height * aspect, 1 + 0.25 * c.height, 4 - distance});
}

TEST(CameraControl, BearsOddCameras)
{
    Camera c;
    c.look_at = c.position;
    CameraControl here(c);
    here.orbit(0.1, 0.1);
    EXPECT_TRUE(std::isfinite(here.camera().position.x));
    EXPECT_GT(here.distance(), 0);
    c.position = {0, 5, 0};
    c.look_at = {0, 0, 0};
    CameraControl along_up(c);
    along_up.orbit(0.3, -0.2);
    along_up.pan(0.1, 0.1);
    EXPECT_TRUE(std::isfinite(along_up.camera().position.x));
    EXPECT_GT(length(cross(forward(along_up.camera()), normalize(along_up.camera().up))), 1e-3);
}

TEST(CameraText, IsPartOfASceneFile)
{
    Camera c = at_distance_4();
    c.fov_y = 40 * std::numbers::pi / 180;
    EXPECT_EQ(camera_text(c),
              "\"camera\": {\"position\": [0, 1, 4], \"look_at\": [0, 1, 0], \"up\": [0, 1, 0], \"fov_y_deg\": 40}");
    c.aperture = 0.5;
    c.focus_distance = 3;
    c.shutter_close = 1;
    EXPECT_NE(camera_text(c).find("\"aperture\": 0.5, \"focus_distance\": 3, \"shutter\": [0, 1]"), std::string::npos);
    c.shift_y = -0.25;
    EXPECT_NE(camera_text(c).find("\"shift\": [0, -0.25]"), std::string::npos);
    c.kind = CameraKind::orthographic;
    EXPECT_NE(camera_text(c).find("\"kind\": \"orthographic\""), std::string::npos);
    EXPECT_EQ(camera_text(c).find("fov"), std::string::npos);
}

}  // namespace
}  // namespace fathom::view
