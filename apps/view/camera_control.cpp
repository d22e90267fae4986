// SPDX-License-Identifier: Apache-2.0
#include "camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::view {

namespace {

/// Factor of the distance for one notch of the wheel.
constexpr double zoom_step = 0.88;
/// Smallest angle between the view direction and the rotation axis.
constexpr double min_angle = std::numbers::pi / 180;

Vec3d rotated(Vec3d v, Vec3d axis, double angle)
{
    return Transform::rotate(axis, angle).vector(v);
}

Vec3d perpendicular(Vec3d v, Vec3d axis)
{
    return v - axis * dot(v, axis);
}

/// Rotation axis of orbits: the world axis, y preferred, that is vertical in the image, else the camera's own.
Vec3d upright_axis(Vec3d forward, Vec3d up)
{
    const Vec3d own = normalize(perpendicular(up, forward));
    for (const Vec3d axis :
         {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0, -1, 0}, Vec3d{0, 0, -1}, Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}}) {
        const Vec3d shown = perpendicular(axis, forward);
        if (length(shown) > 1e-3 && dot(normalize(shown), own) > 1 - 1e-9) return axis;
    }
    return own;
}

}  // namespace

CameraControl::CameraControl(const Camera& start) : start_(start)
{
    reset();
}

void CameraControl::reset()
{
    camera_ = start_;
    const Vec3d forward = frame().forward;
    axis_ = upright_axis(forward, frame().up);
    const bool focused = camera_.kind == CameraKind::perspective && camera_.aperture > 0 && camera_.focus_distance > 0;
    pivot_ = focused ? camera_.position + forward * camera_.focus_distance : camera_.look_at;
    if (!(distance() > 0)) pivot_ = camera_.position + forward;
}

CameraControl::Frame CameraControl::frame() const
{
    Frame f;
    f.forward = normalize(camera_.look_at - camera_.position);
    if (length(f.forward) == 0) f.forward = {0, 0, -1};
    f.right = cross(f.forward, normalize(camera_.up));
    // If the view direction is `up`, any perpendicular direction is valid.
    if (length(f.right) < 1e-9)
        f.right = cross(f.forward, std::abs(f.forward.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1});
    f.right = normalize(f.right);
    f.up = cross(f.right, f.forward);
    return f;
}

double CameraControl::distance() const
{
    return dot(pivot_ - camera_.position, frame().forward);
}

void CameraControl::set_view(Vec3d position, Vec3d forward)
{
    camera_.position = position;
    camera_.up = axis_;
    const double depth = dot(pivot_ - position, forward);
    camera_.look_at = position + forward * depth;
    camera_.focus_distance = camera_.aperture > 0 ? depth : 0;
}

void CameraControl::orbit(double right, double down)
{
    const Frame f = frame();
    // Angle between the axis and the direction from the pivot to the camera; it shrinks as the camera rises.
    const double angle = std::acos(std::clamp(-dot(f.forward, axis_), -1.0, 1.0));
    const double wanted = std::clamp(angle - down, min_angle, std::numbers::pi - min_angle);
    const double rise = down == 0 ? 0 : angle - wanted;
    const auto turn = [&](Vec3d v) { return rotated(rotated(v, f.right, -rise), axis_, -right); };
    set_view(pivot_ + turn(camera_.position - pivot_), turn(f.forward));
}

void CameraControl::look(double right, double up)
{
    const Frame f = frame();
    const double angle = std::acos(std::clamp(dot(f.forward, axis_), -1.0, 1.0));
    const double wanted = std::clamp(angle - up, min_angle, std::numbers::pi - min_angle);
    const double rise = up == 0 ? 0 : angle - wanted;
    const auto turn = [&](Vec3d v) { return rotated(rotated(v, f.right, rise), axis_, -right); };
    pivot_ = camera_.position + turn(pivot_ - camera_.position);
    set_view(camera_.position, turn(f.forward));
}

void CameraControl::pan(double right, double down)
{
    const Frame f = frame();
    const double height =
        camera_.kind == CameraKind::orthographic ? camera_.height : 2 * distance() * std::tan(camera_.fov_y / 2);
    const Vec3d shift = f.right * (-right * height) + f.up * (down * height);
    pivot_ = pivot_ + shift;
    set_view(camera_.position + shift, f.forward);
}

void CameraControl::zoom(double steps)
{
    const double factor = std::pow(zoom_step, steps);
    const Vec3d forward = frame().forward;
    if (camera_.kind == CameraKind::orthographic) {
        camera_.height *= factor;
        set_view(camera_.position, forward);
        return;
    }
    set_view(camera_.position + forward * (distance() * (1 - factor)), forward);
}

void CameraControl::fly(double right, double up, double forward)
{
    const Frame f = frame();
    const Vec3d shift = (f.right * right + f.up * up + f.forward * forward) * distance();
    pivot_ = pivot_ + shift;
    set_view(camera_.position + shift, f.forward);
}

CameraControl::ImageRay CameraControl::ray(double x, double y, double aspect) const
{
    const Frame f = frame();
    const bool orthographic = camera_.kind == CameraKind::orthographic;
    const double half_height = orthographic ? camera_.height / 2 : std::tan(camera_.fov_y / 2);
    const double right = 2 * (x + camera_.shift_x) - 1, up = 1 - 2 * (y - camera_.shift_y);
    const Vec3d aside = f.right * (right * half_height * aspect) + f.up * (up * half_height);
    return orthographic ? ImageRay{aside, f.forward} : ImageRay{{0, 0, 0}, aside + f.forward};
}

Camera CameraControl::through(double x, double y, double aspect, double pixel) const
{
    const ImageRay r = ray(x, y, aspect);
    Camera camera = camera_;
    camera.position = camera_.position + r.shift;
    camera.look_at = camera.position + r.direction;
    camera.aspect = 1;
    camera.aperture = camera.focus_distance = 0;
    camera.shift_x = camera.shift_y = 0;
    camera.height = camera_.height * pixel;
    camera.fov_y = 2 * std::atan(std::tan(camera_.fov_y / 2) * pixel);
    return camera;
}

bool CameraControl::focus(double x, double y, double aspect, double depth)
{
    const ImageRay r = ray(x, y, aspect);
    const Vec3d forward = frame().forward;
    pivot_ = camera_.position + r.shift + normalize(r.direction) * depth;
    set_view(camera_.position, forward);
    return camera_.kind == CameraKind::perspective && camera_.aperture > 0;
}

}  // namespace fathom::view
