// SPDX-License-Identifier: Apache-2.0
#include "session/seen_photons.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace fathom {

namespace {

/// Where a straight line from the camera to a point meets the image.
struct SeenPlace {
    std::uint32_t pixel;
    double pixels_per_area;  ///< for a surface that faces the camera
};

/// Sees points through a camera without its lens; a spherical camera sees all of them in one pixel, whose brightness
/// stands for that of the image.
class PointCamera {
public:
    PointCamera(const CameraRecord& camera, const TrialImage& image)
        : camera_(camera), width_(image.settings.width), height_(image.settings.height)
    {
    }

    std::optional<SeenPlace> see(const Vec3f& p) const
    {
        const double x = along(camera_.right, p), y = along(camera_.up, p), z = along(camera_.forward, p);
        const double pixels = double(width_) * height_, distance2 = x * x + y * y + z * z;
        if (!(distance2 > 0)) return {};
        if (camera_.spherical) return SeenPlace{0, pixels / (4 * std::numbers::pi * distance2)};
        const double depth = camera_.orthographic ? 1 : z;
        if (!(z > 0)) return {};
        const double u = (x / depth - double(camera_.shift_right)) / double(camera_.half_width),
                     v = (y / depth - double(camera_.shift_up)) / double(camera_.half_height);
        if (!(std::fabs(u) < 1 && std::fabs(v) < 1)) return {};
        const auto pixel = [](double at, int size) { return std::uint32_t(std::min(int(at * size), size - 1)); };
        const double area = 4 * double(camera_.half_width) * double(camera_.half_height) * depth * depth;
        return SeenPlace{pixel((1 - v) / 2, height_) << 16 | pixel((u + 1) / 2, width_), pixels / area};
    }

private:
    double along(const float (&axis)[3], const Vec3f& p) const
    {
        const float at[3] = {p.x, p.y, p.z};
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += double(axis[k]) * (double(at[k]) - double(camera_.position[k]));
        return sum;
    }

    const CameraRecord& camera_;
    const int width_, height_;
};

}  // namespace

void add_seen_photons(LightSamples& samples, const CameraRecord& camera, const TrialImage& image)
{
    const PointCamera view(camera, image);
    for (LightPathResults& job : samples.jobs)
        for (const CausticPhoton& photon : job.photons) {
            const std::optional<SeenPlace> place = view.see(photon.position);
            if (!place) continue;
            // Of a white diffuse surface.
            const auto scale = float(place->pixels_per_area / std::numbers::pi);
            job.splats.push_back({place->pixel,
                                  {photon.power.x * scale, photon.power.y * scale, photon.power.z * scale},
                                  0,
                                  photon.path});
        }
}

}  // namespace fathom
