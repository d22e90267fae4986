// SPDX-License-Identifier: Apache-2.0
#include "session/caustic_map.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace fathom {

namespace {

constexpr std::size_t neighbor = 12;
constexpr std::uint32_t photon_paths_per_job = 1u << 14;

/// Order of photons that does not depend on how they were traced.
auto order_of(const CausticPhoton& p)
{
    return std::tuple(p.sample, p.path, p.bounces);
}

std::uint32_t bucket_of(const CausticPhoton& p, float radius)
{
    const float inverse_cell = 0.5f / radius;
    // CausticGathering finds cells by the same operations. Adding 0 turns -0 into +0, which has other bits.
    const auto cell = [&](float x) { return std::bit_cast<std::uint32_t>(std::floor(x * inverse_cell) + 0.f); };
    return caustic_cell_hash(cell(p.position.x), cell(p.position.y), cell(p.position.z), p.sample);
}

}  // namespace

std::vector<CausticPhoton> trace_photons(const KernelScene& scene, const CameraRecord& camera,
                                         const KernelSettings& settings, std::uint32_t sample)
{
    const std::uint32_t jobs = (settings.light_paths + photon_paths_per_job - 1) / photon_paths_per_job;
    std::vector<LightPathResults> results(jobs);
    tbb::parallel_for(0u, jobs, [&](std::uint32_t i) {
        const std::uint32_t first = i * photon_paths_per_job;
        KernelCounters counters;
        results[i].records_photons = true;
        trace_light_paths(scene, camera, settings,
                          {sample, first, std::min(photon_paths_per_job, settings.light_paths - first)}, results[i],
                          counters);
    });
    std::vector<CausticPhoton> photons;
    for (const LightPathResults& r : results) photons.insert(photons.end(), r.photons.begin(), r.photons.end());
    return photons;
}

float first_caustic_radius(std::vector<CausticPhoton> photons, std::uint32_t samples, float fallback)
{
    if (photons.size() <= 4 * neighbor) return fallback;
    std::sort(photons.begin(), photons.end(), [](const auto& a, const auto& b) { return order_of(a) < order_of(b); });
    // Enough distances for a median, and not more than take some hundredths of a second.
    const std::size_t queries = std::clamp<std::size_t>(20'000'000 / photons.size(), 31, 511);
    std::vector<float> radii(std::min(queries, photons.size()));
    tbb::parallel_for(std::size_t(0), radii.size(), [&](std::size_t q) {
        const Vec3f at = photons[q * photons.size() / radii.size()].position;
        std::vector<float> distances(photons.size());
        for (std::size_t i = 0; i < photons.size(); ++i) {
            const Vec3f p = photons[i].position;
            const float x = p.x - at.x, y = p.y - at.y, z = p.z - at.z;
            distances[i] = x * x + y * y + z * z;
        }
        std::nth_element(distances.begin(), distances.begin() + neighbor, distances.end());
        radii[q] = std::sqrt(distances[neighbor]);
    });
    std::nth_element(radii.begin(), radii.begin() + std::ptrdiff_t(radii.size() / 2), radii.end());
    const float median = radii[radii.size() / 2];
    // Photons of one sample lie farther apart than those of all, on surfaces by the root of the number of samples.
    return median > 0 ? median * std::sqrt(float(samples)) : fallback;
}

float first_caustic_radius(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                           float ball_radius)
{
    constexpr std::uint32_t most_samples = 64;
    constexpr std::size_t enough_photons = 2000;
    std::vector<CausticPhoton> photons;
    std::uint32_t samples = 0;
    while (samples < most_samples && photons.size() < enough_photons) {
        const std::vector<CausticPhoton> more = trace_photons(scene, camera, settings, samples++);
        photons.insert(photons.end(), more.begin(), more.end());
    }
    return first_caustic_radius(std::move(photons), samples, 0.01f * ball_radius);
}

CausticMap make_caustic_map(std::vector<CausticPhoton> photons, std::uint32_t first, std::uint32_t samples,
                            float first_radius)
{
    CausticMap map;
    map.first_sample = first;
    for (std::uint32_t i = 0; i < samples; ++i)
        map.radii.push_back(first_radius * float(std::pow(double(first) + i + 1, -1. / 6)));
    map.bucket_mask = std::uint32_t(std::bit_ceil(std::max<std::size_t>(photons.size(), 2)) - 1);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> order(photons.size());  // bucket, number of the photon
    tbb::parallel_for(std::size_t(0), photons.size(), [&](std::size_t i) {
        const float radius = map.radii[photons[i].sample - first];
        order[i] = {bucket_of(photons[i], radius) & map.bucket_mask, std::uint32_t(i)};
    });
    tbb::parallel_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : order_of(photons[a.second]) < order_of(photons[b.second]);
    });
    map.buckets.assign(std::size_t(map.bucket_mask) + 2, 0);
    map.photons.reserve(photons.size());
    for (const auto& [bucket, number] : order) {
        ++map.buckets[bucket + 1];
        map.photons.push_back(photons[number]);
    }
    for (std::size_t i = 1; i < map.buckets.size(); ++i) map.buckets[i] += map.buckets[i - 1];
    return map;
}

}  // namespace fathom
