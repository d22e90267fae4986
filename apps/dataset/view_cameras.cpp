// SPDX-License-Identifier: Apache-2.0
#include "dataset/view_cameras.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::cli {

namespace {

/// Turn of a seed, in fractions of a full turn: multiples of the golden ratio fill the circle evenly.
double turn_of_seed(std::uint32_t seed)
{
    return std::fmod(seed * (std::numbers::phi - 1), 1.0);
}

/// Direction from the model to camera i. Sphere and hemisphere are Fibonacci lattices, whose points all stand for equal
/// solid angles (Gonzalez 2010, "Measurement of Areas on a Sphere Using Fibonacci and Latitude-Longitude Lattices").
Vec3d direction_to_camera(const CameraRing& ring, std::uint64_t i)
{
    const double count = double(ring.count), turn = turn_of_seed(ring.seed);
    double azimuth = ring.azimuth_deg / 360 + turn, height = std::sin(ring.elevation_deg * std::numbers::pi / 180);
    if (ring.placement == ViewPlacement::ring) {
        azimuth += double(i) / count;
    } else {
        azimuth += double(i) * (std::numbers::phi - 1);
        const double share = (double(i) + 0.5) / count;
        height = ring.placement == ViewPlacement::sphere ? 1 - 2 * share : 1 - share;
    }
    const double across = std::sqrt(std::max(0.0, 1 - height * height)), angle = 2 * std::numbers::pi * azimuth;
    return {across * std::sin(angle), height, across * std::cos(angle)};
}

}  // namespace

std::vector<Camera> cameras_around(const Bounds& bounds, const CameraRing& ring, const Camera& lens, double aspect)
{
    const Vec3d middle = bounds.empty ? Vec3d{} : (bounds.min + bounds.max) * 0.5;
    const double radius = bounds.empty ? 1 : std::max(0.5 * length(bounds.max - bounds.min), 1e-6);
    const double half = std::atan(std::tan(lens.fov_y / 2) * std::min(1.0, aspect));
    std::vector<Camera> cameras;
    for (std::uint64_t i = 0; i < ring.count; ++i) {
        Camera camera;
        camera.name = "view " + std::to_string(i);
        camera.fov_y = lens.fov_y;
        camera.aperture = lens.aperture;
        camera.shutter_open = lens.shutter_open, camera.shutter_close = lens.shutter_close;
        const Vec3d direction = direction_to_camera(ring, i);
        camera.look_at = middle;
        camera.position = middle + direction * (radius / std::sin(half));
        // Straight from above or below, any direction can be up.
        camera.up = std::abs(direction.y) < 1 - 1e-9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, -direction.y};
        cameras.push_back(camera);
    }
    return cameras;
}

Transform z_up_from_world()
{
    Transform t;
    t.m = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    return t;
}

}  // namespace fathom::cli
