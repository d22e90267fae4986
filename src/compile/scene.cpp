// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compile/fingerprint.h"
#include "compile/scene_compiler.h"

namespace fathom {

namespace {

void store(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}

/// Length of the side (or diagonal) that a field of view refers to, in units of the image's height.
double side_of(FovAxis axis, double aspect)
{
    switch (axis) {
        case FovAxis::width:
            return aspect;
        case FovAxis::diagonal:
            return std::hypot(1, aspect);
        case FovAxis::smaller:
            return std::min(1.0, aspect);
        case FovAxis::larger:
            return std::max(1.0, aspect);
        case FovAxis::height:
            break;
    }
    return 1;
}

/// Ratio of heights if the image's aspect ratio differs from that of the camera.
double height_factor(const Camera& camera, double aspect)
{
    if (!(camera.fov_aspect > 0)) return 1;
    return side_of(camera.fov_axis, camera.fov_aspect) / side_of(camera.fov_axis, aspect);
}

}  // namespace

Scene Scene::compile(const SceneDescription& description, const std::string& camera, Warnings& warnings,
                     BvhQuality build)
{
    Scene scene;
    scene.data_ = SceneCompiler(description, camera, build).compile(warnings);
    return scene;
}

const CompileStatistics& Scene::statistics() const
{
    return data_->statistics;
}
const Camera& Scene::camera() const
{
    return data_->camera;
}
std::uint64_t Scene::fingerprint() const
{
    return data_->fingerprint;
}

CameraRecord Scene::Data::camera_record(const Camera& seen_by, int width, int height) const
{
    const double scale = tables->render_scale;
    CameraRecord t;
    const Vec3d forward = normalize(seen_by.look_at - seen_by.position);
    Vec3d right = cross(forward, seen_by.up);
    // A camera that looks along `up` may use any perpendicular direction.
    if (length(right) < 1e-9 * length(seen_by.up))
        right = cross(forward, std::abs(forward.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1});
    right = normalize(right);
    store(t.position, (seen_by.position - tables->origin) * scale);
    store(t.right, right), store(t.up, cross(right, forward)), store(t.forward, forward);
    t.orthographic = seen_by.kind == CameraKind::orthographic;
    t.equal_area = seen_by.kind == CameraKind::equal_area;
    t.spherical = t.equal_area || seen_by.kind == CameraKind::spherical;
    const double own_half_height = t.orthographic ? seen_by.height / 2 * scale : std::tan(seen_by.fov_y / 2);
    const double half_height = own_half_height * height_factor(seen_by, double(width) / height);
    t.half_height = float(half_height);
    t.half_width = float(half_height * width / height);
    t.shift_right = float(2 * seen_by.shift_x * half_height * width / height);
    t.shift_up = float(2 * seen_by.shift_y * half_height);
    t.lens_radius = t.spherical ? 0 : float(seen_by.aperture / 2 * scale);
    const double focus =
        seen_by.focus_distance > 0 ? seen_by.focus_distance : length(seen_by.look_at - seen_by.position);
    t.focus_distance = float(focus * scale);
    t.shutter_open = float(seen_by.shutter_open);
    t.shutter_close = float(seen_by.shutter_close);
    return t;
}

std::string Scene::Data::key(const CameraRecord& seen_by) const
{
    Fingerprint f;
    f.add(&seen_by, sizeof seen_by);
    return fmt::format("{:016x}{:016x}", fingerprint, f.value());
}

}  // namespace fathom
