// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/scene.h"
#include "fathom/vector.h"

namespace fathom {

/// Pixel filter. All filters are separable and positive; they are importance sampled, so that every sample of a pixel
/// has the same weight and belongs to that pixel alone (Ernst, Stamminger and Greiner 2006, "Filter Importance
/// Sampling").
enum class Filter {
    box,              ///< Constant over the pixel.
    gaussian,         ///< Standard deviation of 0.5 pixels, lowered so that it is 0 at its radius.
    blackman_harris,  ///< Four-term Blackman-Harris window with side lobes below -92 dB (Harris 1978).
    tent              ///< Linear from the center to 0 at the radius.
};
/// Default radius of each Filter in pixels, indexed by its value.
inline constexpr double filter_radii[] = {0.5, 2, 1.65, 1};
/// Largest RenderSettings::filter_radius, in pixels.
inline constexpr double max_filter_radius = 64;

/// How next event estimation chooses the light that it samples at a surface.
enum class LightSelection : std::uint32_t {
    power,    ///< In proportion to the power of each light.
    uniform,  ///< Each light with the same probability.
    tree      ///< By the estimated contribution to the shading point, from a light tree (Conty and Kulla 2018).
};

/// Additional image layer (arbitrary output variable) that describes the first surface each camera ray hits.
/// Film::image names the layers and says what a pixel without a hit contains.
enum class Aov {
    albedo,       ///< Base color of the surface, averaged over all samples.
    normal,       ///< Shading normal in world space, facing the camera, averaged over all samples.
    depth,        ///< Distance along the view axis in meters (spherical cameras: along the ray), averaged over hits.
    position,     ///< World-space position in meters, averaged over the samples that hit a surface.
    instance_id,  ///< Number of the object, from 0, hit by the sample with the lowest index that hit one.
    material_id   ///< Number of the material, from 0, hit by the sample with the lowest index that hit one.
};

/// Rectangle of pixels x0 <= x < x1, y0 <= y < y1, counted from the top left of the image.
struct Crop {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< First column and row; one past the last column and row.
};

/// Largest value of RenderSettings::light_paths.
inline constexpr double max_light_paths = 64;
/// A value of RenderSettings::light_paths that suits most scenes with caustics.
inline constexpr double usual_light_paths = 0.25;

/// Everything that determines the bits of an image, except the scene, the camera and the range of samples, which
/// render() takes as an argument. `threads` and `measure_stages` don't change the image.
struct RenderSettings {
    int width = 800, height = 600;  ///< Size of the image in pixels, 1x1 to 65535x65535.
    std::uint32_t seed = 0;         ///< Seed of the random numbers. Images of different seeds have independent noise.
    /// Maximum number of scattering events of a path; 0 shows emitted light only, 1 adds direct lighting, -1 means no
    /// limit. A limit makes the image darker than it should be.
    int max_depth = -1;
    /// Number of scattering events after which Russian roulette may end a path. With `guiding`, learned survival
    /// probabilities also apply before that.
    int roulette_depth = 5;
    /// Next event estimation. Without it, only scattered rays find lights, which is useful for debugging.
    bool light_sampling = true;
    LightSelection light_selection = LightSelection::tree;  ///< How a light is chosen for next event estimation.
    /// Path guiding: learns from a quarter million to one million paths where light comes from, then samples directions
    /// and chooses survival probabilities accordingly. It reduces noise where light arrives through windows or doors or
    /// from bright walls. Plain path tracing is kept where a trial shows no gain.
    bool guiding = false;
    /// Light tracing: number of light paths per pixel and sample index, at most max_light_paths. They are connected to
    /// the camera, and combined with path tracing by multiple importance sampling. They find caustics, the light that
    /// lamps send through glass or over mirrors onto other surfaces. Where it helps, they are aimed at places that make
    /// caustics, as some 240,000 light paths show first. 0 is path tracing alone. Without effect if light_sampling is
    /// false.
    double light_paths = 0;
    /// Also renders caustics that are seen through smooth glass or in mirrors, from photons that the light paths leave
    /// on surfaces. Path tracing and light tracing do not find those of lamps without size. The image is biased:
    /// caustics are blurred by a radius that shrinks with the sample index, so that it converges. Without effect
    /// without light paths.
    bool merge_caustics = false;
    Filter filter = Filter::blackman_harris;  ///< Pixel filter.
    double filter_radius = 0;                 ///< Radius in pixels that `filter` is stretched to, at most
                                              ///< max_filter_radius; 0 selects its default radius.
    std::optional<Crop> crop;                 ///< Renders only these pixels. The image keeps its size.
    std::vector<Aov> aovs;                    ///< Additional layers, in this order.
    /// Linear Rec.709 radiance that camera rays see instead of the environment if they leave the scene. The environment
    /// still lights the scene.
    std::optional<Color> background;
    /// Renders one pixel in 32 a second time, with other random numbers, so that estimate_error() can tell how large
    /// the error of the image is. The image itself doesn't change. Without effect in images less than three pixels
    /// wide.
    bool error_probes = false;
    bool alpha = false;  ///< Also sums coverage, so that Film::image can return an alpha channel.
    int threads = 0;     ///< Number of threads for rendering; 0 selects available_threads().
    /// Maximum contribution of a sample's indirect light (at least two scattering events) to each channel. It removes
    /// fireflies at the price of bias. Emission seen directly and direct lighting are not clamped.
    std::optional<float> clamp_indirect;
    bool measure_stages = false;  ///< Measures the time of each stage: RenderCosts::seconds of Progress::costs.

    /// Returns whether photons are gathered.
    bool gathers_caustics() const { return merge_caustics && light_paths > 0 && light_sampling; }
    /// Returns the pixels that are rendered: the crop, or else the whole image.
    Crop rendered_pixels() const { return crop.value_or(Crop{0, 0, width, height}); }
};

/// Identifies what a film contains samples of. Films with equal keys can be merged.
struct FATHOM_API FilmKey {
    RenderSettings settings;  ///< Settings of the render; `threads` and `measure_stages` are not part of the key.
    std::string scene;        ///< Fingerprint of the compiled scene and the camera: 32 hexadecimal digits.

    /// Returns the key as text for film files: `name=value` fields, separated by semicolons.
    std::string text() const;
    /// Inverse of text(). Throws Error if the text is not a key, or its settings are impossible.
    static FilmKey parse(const std::string& text);
    /// Returns the differences as a phrase for messages, such as `seed is 1, not 0`; empty if the keys are equal.
    std::string difference(const FilmKey& other) const;
};

/// A scene, a camera and settings that were checked together and can be rendered.
///
/// A copy shares the data of its original. Several threads may use a job at once. With RenderSettings::guiding the
/// first render of the job learns the guiding distributions, and later ones reuse them.
class FATHOM_API RenderJob {
public:
    /// Creates a job for the camera that the scene was compiled for.
    ///
    /// Throws Error if the size is not 1x1 to 65535x65535, the crop is empty or not inside the image, the filter radius
    /// is out of range, or the camera has numbers that are not finite or too large for the scene.
    RenderJob(const Scene& scene, const RenderSettings& settings);
    /// Creates a job for another camera, in world space. Also throws Error if something in the scene moves and the
    /// camera's shutter times differ from those of Scene::camera(), because motion is compiled for these times.
    RenderJob(const Scene& scene, const Camera& camera, const RenderSettings& settings);

    /// Returns the scene.
    const Scene& scene() const;
    /// Returns the camera, in world space.
    const Camera& camera() const;
    /// Returns the settings.
    const RenderSettings& settings() const { return key().settings; }
    /// Returns the key of films of this job.
    const FilmKey& key() const;

    /// Internal state, defined inside the library.
    struct Data;
    /// Returns the internal state.
    const Data& data() const { return *data_; }

private:
    std::shared_ptr<const Data> data_;
};

}  // namespace fathom
