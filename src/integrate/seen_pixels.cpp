// SPDX-License-Identifier: Apache-2.0
/// Finds the pixels whose camera rays may meet something, by the boxes of the BVH.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "fathom/job.h"
#include "geometry/bvh/layout/data.h"
#include "integrate/stages/camera_media.h"
#include "kernel/kernel.h"
#include "kernel/lane_scene.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

/// Rectangle of pixels; x1 and y1 are excluded.
struct PixelRectangle {
    int x0, y0, x1, y1;
    bool is_empty() const { return x0 >= x1 || y0 >= y1; }
    /// Whether the rectangle is too small to be worth dividing.
    bool is_small() const { return x1 - x0 <= 8 && y1 - y0 <= 8; }
};

/// The pixels that boxes cover, by cameras that see along straight rays from one point or in one direction.
class Screen {
public:
    Screen(const CameraRecord& camera, const KernelSettings& settings, float scene_radius)
        : camera_(camera), width_(settings.width), height_(settings.height), words_(words_of(width_, height_))
    {
        const double reach = double(filter_radii[settings.filter]) * double(settings.filter_stretch);
        margin_ = std::max(reach, 0.5) + 0.5;
        float largest = scene_radius;
        for (float x : camera.position) largest = std::max(largest, std::abs(x));
        rounding_ = double(bvh_slack) * 4 * double(largest);
    }

    /// Covers the pixels of a box; returns whether its parts should be covered instead.
    bool cover(const float (&low)[3], const float (&high)[3], bool is_divisible)
    {
        if (is_full_) return false;
        const std::optional<PixelRectangle> seen = pixels_of(low, high);
        if (!seen && is_divisible) return true;
        if (!seen) is_full_ = true;
        if (is_full_ || seen->is_empty()) return false;
        if (is_divisible && !seen->is_small()) return true;
        mark(*seen);
        return false;
    }

    /// The covered pixels; empty if they are nearly all.
    std::vector<std::uint32_t> take()
    {
        std::uint64_t count = 0;
        for (std::uint32_t word : words_) count += std::uint64_t(std::popcount(word));
        const bool is_worth_it = !is_full_ && double(count) < 0.95 * double(width_) * double(height_);
        return is_worth_it ? std::move(words_) : std::vector<std::uint32_t>();
    }

private:
    static std::size_t words_of(int width, int height) { return (std::size_t(width) * std::size_t(height) + 31) / 32; }

    /// Pixels whose rays may meet a box; nothing if it reaches the plane of the camera.
    std::optional<PixelRectangle> pixels_of(const float (&low)[3], const float (&high)[3]) const
    {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        double x0 = infinite, y0 = infinite, x1 = -infinite, y1 = -infinite, nearest = infinite, farthest = -infinite;
        for (int corner = 0; corner < 8; ++corner) {
            double right = 0, up = 0, along = 0;
            for (int k = 0; k < 3; ++k) {
                const double p = double(corner >> k & 1 ? high[k] : low[k]) - double(camera_.position[k]);
                right += p * double(camera_.right[k]), up += p * double(camera_.up[k]);
                along += p * double(camera_.forward[k]);
            }
            nearest = std::min(nearest, along), farthest = std::max(farthest, along);
            const double depth = camera_.orthographic ? 1 : along;
            const double x = (right / depth - double(camera_.shift_right)) / double(camera_.half_width);
            const double y = (up / depth - double(camera_.shift_up)) / double(camera_.half_height);
            x0 = std::min(x0, x), x1 = std::max(x1, x);
            y0 = std::min(y0, -y), y1 = std::max(y1, -y);
        }
        if (farthest < -rounding_) return PixelRectangle{0, 0, 0, 0};
        double slack = rounding_;
        if (!camera_.orthographic) {
            if (nearest <= 2 * rounding_) return {};
            slack = rounding_ / nearest;
        }
        const auto interval = [&](double first, double last, int size, float half, int& begin, int& end) {
            const double margin = margin_ + slack / double(half) * size;
            const auto pixel = [&](double at) { return std::clamp(at, -1., size + 1.); };
            begin = std::max(0, int(std::floor(pixel((first + 1) / 2 * size - 0.5 - margin))));
            end = std::min(size, int(std::ceil(pixel((last + 1) / 2 * size - 0.5 + margin))) + 1);
        };
        PixelRectangle r{};
        interval(x0, x1, width_, camera_.half_width, r.x0, r.x1);
        interval(y0, y1, height_, camera_.half_height, r.y0, r.y1);
        return r;
    }

    void mark(const PixelRectangle& r)
    {
        work_ += r.y1 - r.y0;
        is_full_ |= work_ > most_work;
        for (int y = r.y0; y < r.y1; ++y) {
            const std::size_t row = std::size_t(y) * std::size_t(width_);
            for (std::size_t i = row + std::size_t(r.x0), end = row + std::size_t(r.x1); i < end;) {
                const std::size_t bit = i % 32, n = std::min(32 - bit, end - i);
                words_[i / 32] |= std::uint32_t(((std::uint64_t(1) << n) - 1) << bit);
                i += n;
            }
        }
    }

    /// Limit of rows that boxes cover: many large boxes would take longer than is saved.
    static constexpr std::int64_t most_work = 1 << 22;

    const CameraRecord& camera_;
    const int width_, height_;
    std::vector<std::uint32_t> words_;
    double margin_;    ///< pixels around a pixel's center in which its rays start, and half a pixel
    double rounding_;  ///< of rays and boxes, in render space
    std::int64_t work_ = 0;
    bool is_full_ = false;
};

/// Whether rays that meet nothing bring the same to every pixel, and the camera's are straight.
bool is_simple(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings)
{
    if (scene.is_flat || camera.spherical || camera.lens_radius > 0) return false;
    if (scene.has(Feature::environment) && !settings.background.given) return false;
    // A medium around the camera may scatter rays that meet nothing.
    return !scene.has(Feature::media_stacks) ||
           none(media_at(scene, camera.position, camera.shutter_open).current() != UInt(0u));
}

}  // namespace

}  // namespace FATHOM_LANES

std::vector<std::uint32_t> pixels_with_surfaces(const KernelScene& kernel_scene, const CameraRecord& camera,
                                                const KernelSettings& settings)
{
    const auto& scene = static_cast<const LaneScene&>(kernel_scene);
    if (!is_simple(scene, camera, settings)) return {};
    Screen screen(camera, settings, scene.bvh.radius());
    const bool is_known = scene.bvh.visit_boxes([&](const float(&low)[3], const float(&high)[3], bool is_divisible) {
        return screen.cover(low, high, is_divisible);
    });
    return is_known ? screen.take() : std::vector<std::uint32_t>();
}

}  // namespace fathom
