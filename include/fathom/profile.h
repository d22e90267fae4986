// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/ground_truth.h"
#include "fathom/job.h"

/// Why an image is noisy and why it is slow: noise, light and time of its paths by light, material, object, kind of
/// path and depth.
namespace fathom {

/// The kind of cause that a row of a profile describes.
enum class ProfileCause {
    camera,       ///< The camera: light that it sees directly, and its rays.
    light,        ///< A light without a surface; index into SceneDescription::lights.
    emitter,      ///< The light of an emissive object; index into scene_objects().
    environment,  ///< The environment, its sun, or the background.
    no_light,     ///< Work that belongs to no light: all except shadow rays.
    material,     ///< A material; index into SceneDescription::materials. The next index is the default material.
    object,       ///< An object; index into scene_objects().
    medium,       ///< The inside of a medium, which has no object.
    path,         ///< A kind of path; ProfileRow::path.
    combination,  ///< A kind of path, with the light that it finds and the place where it finds it.
    depth         ///< A number of scattering events; the index.
};

/// Noise, light and work of one cause. Shares are relative to the whole image, and those of a table add up to 1.
struct ProfileRow {
    ProfileCause cause = ProfileCause::camera;  ///< What the row stands for.
    int index = -1;                             ///< Its index, as ProfileCause says; -1 if it has none.
    /// Kind of path, from the camera (E) to the light (L). Between them D, G and S are diffuse, glossy and mirror
    /// reflection, F and T glossy and specular transmission, V is scattering in a medium. Of more than four events, the
    /// first and the last two are kept: EDD...DDL.
    std::string path;
    bool is_sampled = false;  ///< path: the light was found by next event estimation, and not by a scattered ray.
    /// combination: cause and index of the light, and of the material (or camera).
    ProfileCause light_cause = ProfileCause::no_light, place_cause = ProfileCause::camera;
    int light_index = -1, place_index = -1;  ///< combination: indices of both.
    /// Share of the noise: the covariance of the row's light with that of the whole sample, divided by the variance. A
    /// share may be negative. Pixels and channels count as in the relative error (ErrorMetric::relative).
    double noise = 0;
    double noise_error = 0;         ///< Standard error of `noise`.
    double light = 0;               ///< Share of the light that reaches the image.
    double time = 0;                ///< Share of the time, which is measured and thus differs from run to run.
    std::uint64_t rays = 0;         ///< Number of rays of all kinds.
    std::uint64_t shadow_rays = 0;  ///< Number of shadow rays among them.
};

/// Where noise and time of an image come from. Tables are sorted by `noise`, the largest share first.
///
/// A path looks for light at each of its vertices, by a light sample and by the ray that leaves the vertex. What it
/// finds, and what that costs, belongs to the material and object of this vertex, to the path up to it, and to the
/// light that was found. The camera is a vertex, too. Panes and open boundaries that paths pass undeflected are none.
struct RenderProfile {
    int width = 0, height = 0;          ///< Size of the image in pixels.
    int samples_per_pixel = 0;          ///< Number of samples of all sets together.
    double error = 0;                   ///< Relative error of the image of all samples, as ErrorMetric::relative.
    double top_noise = 0;               ///< Share of the noise in the noisiest 0.1 % of the pixels.
    double seconds = 0;                 ///< Processor time of the paths, summed over all threads.
    std::uint64_t rays = 0;             ///< Number of rays of all kinds.
    std::vector<ProfileRow> lights;     ///< By light; causes light, emitter, environment, no_light.
    std::vector<ProfileRow> materials;  ///< By material; causes material, camera.
    std::vector<ProfileRow> objects;    ///< By object; causes object, medium, camera.
    std::vector<ProfileRow> paths;      ///< By kind of path; cause path.
    std::vector<ProfileRow> depths;     ///< By depth; cause depth.
    /// By kind of path, light and material together; cause combination. Work is not divided among these rows.
    std::vector<ProfileRow> combinations;
    /// Mean linear radiance (R, G, B), relative error, and time in seconds of each pixel, row by row from the top left.
    std::vector<float> image, pixel_error, pixel_seconds;
};

/// Number of independent sets of samples that a profile compares.
inline constexpr int profile_sets = 8;
/// Largest number of samples per set.
inline constexpr int max_profile_set_samples = 128;

/// Profiles an image by rendering it with path tracing alone: without path guiding and light tracing.
///
/// job          What to render. Layers, `guiding` and `light_paths` of its settings don't count.
/// objects      scene_objects() of the description that the scene was compiled from.
/// set_samples  Number of samples per pixel of each of the profile_sets sets, 1 to max_profile_set_samples. Noise is
///              that between sets, so the even distribution of samples within a set counts.
/// cancel       If not null and set to true by another thread, the profile stops soon.
///
/// Everything except times is the same for any number of threads. Returns nothing if `cancel` became true. Throws Error
/// if set_samples is out of range.
FATHOM_API std::optional<RenderProfile> profile_render(const RenderJob& job, const std::vector<SceneObject>& objects,
                                                       int set_samples, const std::atomic<bool>* cancel = nullptr);

}  // namespace fathom
