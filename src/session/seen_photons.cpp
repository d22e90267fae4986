// SPDX-License-Identifier: Apache-2.0
#include "session/seen_photons.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "session/image_place.h"

namespace fathom {

namespace {

/// Where a straight line from the camera to a point meets the image.
struct SeenPlace {
    std::uint32_t pixel;
    double pixels_per_area;  ///< for a surface that faces the camera
};

/// Place of a point within the image; none outside of it. A spherical camera sees all points in one pixel, whose
/// brightness stands for that of the image.
std::optional<SeenPlace> see(const CameraRecord& camera, int width, int height, const Vec3d& p)
{
    const Vec3d to = p - Vec3d{camera.position[0], camera.position[1], camera.position[2]};
    const double pixels = double(width) * height, distance2 = dot(to, to);
    if (!(distance2 > 0)) return {};
    if (camera.spherical) return SeenPlace{0, pixels / (4 * std::numbers::pi * distance2)};
    const auto [x, y] = image_place(camera, width, height, p);
    if (!(x > 0 && x < width && y > 0 && y < height)) return {};
    const double depth = camera.orthographic ? 1 : dot(to, {camera.forward[0], camera.forward[1], camera.forward[2]});
    const double area = 4 * double(camera.half_width) * double(camera.half_height) * depth * depth;
    return SeenPlace{std::uint32_t(y) << 16 | std::uint32_t(x), pixels / area};
}

}  // namespace

void add_seen_photons(LightSamples& samples, const CameraRecord& camera, const TrialImage& image)
{
    for (LightPathResults& job : samples.jobs)
        for (const CausticPhoton& photon : job.photons) {
            const Vec3f& p = photon.position;
            const std::optional<SeenPlace> place =
                see(camera, image.settings.width, image.settings.height, {p.x, p.y, p.z});
            if (!place) continue;
            // The BRDF of a white diffuse surface is 1 / pi.
            const auto scale = float(place->pixels_per_area / std::numbers::pi);
            job.splats.push_back({place->pixel,
                                  {photon.power.x * scale, photon.power.y * scale, photon.power.z * scale},
                                  0,
                                  photon.path});
        }
}

}  // namespace fathom
