// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera.h"
#include "kernel/lane_scene.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Pairs of random dimensions: CameraPair for group 0 (the camera), BouncePair for group bounce + 1.
enum CameraPair : std::uint32_t { pair_film, pair_lens, pair_time };
/// Pairs of group 0 of light paths.
enum EmissionPair : std::uint32_t { pair_emitter = 3, pair_emission_point, pair_emission_direction };
enum BouncePair : std::uint32_t {
    pair_light,
    pair_bsdf,
    pair_choice,
    pair_roulette,
    pair_channel,
    pair_light_tree,
    pair_guiding,
    pair_mixture,
    pair_light_chance,
    pair_shadow_chance,
    pair_connection_lens,
    pair_connection_film,
    pair_connection_roulette
};

/// Generates the camera rays of a job. Paths are numbered pixel by pixel, then sample by sample. Pixels that see only
/// the background have none, unless the job records paths.
class CameraPaths {
public:
    CameraPaths(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                const KernelJob& job)
        : scene_(scene), camera_(camera), settings_(settings), job_(job), total_(job.pixel_count * job.samples)
    {
        if (!settings.seen_pixels || job.records || job.profile) return;
        for (std::uint32_t i = 0; i < job.pixel_count; ++i) (is_seen(job.pixels[i]) ? seen_ : unseen_).push_back(i);
        if (!unseen_.empty()) total_ = std::uint32_t(seen_.size()) * job.samples;
    }

    /// The start of a path: pixel, random numbers and camera ray.
    struct Path {
        UInt pixel;  ///< position of the pixel in job.pixels
        SampleKey key;
        CameraRay ray;
    };

    /// Number of paths of the job.
    std::uint32_t total() const { return total_; }
    /// Positions in job.pixels of the pixels without paths.
    const std::vector<std::uint32_t>& unseen_pixels() const { return unseen_; }

    /// Generates `lanes` paths from number `first` on; lanes past the last path repeat path `first`.
    [[gnu::always_inline]] Path make(std::uint32_t first) const
    {
        UInt number = UInt(first) + iota();
        number = select(less(number, UInt(total_)), number, UInt(first));
        Path path;
        // Rounding cannot change this quotient because a job has at most 2^20 samples.
        path.pixel = to_uint((to_float(number) + Float(0.5f)) * Float(1.0f / float(job_.samples)));
        const UInt sample = number - path.pixel * UInt(job_.samples) + UInt(job_.first_sample);
        if (!unseen_.empty()) path.pixel = gather(seen_.data(), path.pixel);
        const UInt xy = gather(job_.pixels, path.pixel);
        const UInt y = xy >> 16, x = xy & UInt(0xffffu);
        path.key = {hash(x + hash(y + UInt(hash(settings_.seed)))), reverse_bits(sample)};
        const UInt seed = group_seed(path.key, UInt(0u));
        const Sample2 film = sample_2d(path.key, pair_seed(seed, pair_film));
        Float dx = film.x, dy = film.y;
        if (settings_.filter != 0) {
            const FilterTable& filter = scene_.filters[settings_.filter - 1];
            const Float stretch(settings_.filter_stretch);
            dx = Float(0.5f) + filter.sample(film.x) * stretch;
            dy = Float(0.5f) + filter.sample(film.y) * stretch;
        } else if (settings_.filter_stretch != 1) {
            const Float stretch(settings_.filter_stretch);
            dx = Float(0.5f) + (film.x - Float(0.5f)) * stretch;
            dy = Float(0.5f) + (film.y - Float(0.5f)) * stretch;
        }
        const Float film_x = (to_float(x) + dx) * Float(1.0f / float(settings_.width));
        const Float film_y = (to_float(y) + dy) * Float(1.0f / float(settings_.height));
        Sample2 lens{Float(0.5f), Float(0.5f)};
        if (camera_.lens_radius > 0) lens = sample_2d(path.key, pair_seed(seed, pair_lens));
        Float time(0.f);
        if (scene_.has(Feature::motion)) time = sample_2d(path.key, pair_seed(seed, pair_time)).x;
        path.ray = camera_ray(camera_, film_x, film_y, lens, time);
        return path;
    }

private:
    bool is_seen(std::uint32_t xy) const
    {
        const std::size_t bit = std::size_t(xy >> 16) * std::size_t(settings_.width) + (xy & 0xffff);
        return settings_.seen_pixels[bit / 32] >> (bit % 32) & 1;
    }

    const LaneScene& scene_;
    const CameraRecord& camera_;
    const KernelSettings& settings_;
    const KernelJob& job_;
    std::uint32_t total_;
    std::vector<std::uint32_t> seen_, unseen_;  ///< positions in job.pixels; unused if unseen_ is empty
};

}  // namespace FATHOM_LANES
}  // namespace fathom
