#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "options/image_options.h"
#include "options/sample_plan.h"
#include "options/scene_options.h"
#include "options/settings_options.h"

namespace fathom::cli {

struct OnlySample {
    int x, y;
    std::uint64_t index;
};

/// What `fathom render` is asked for.
struct RenderOptions {
    SceneOptions scene;
    PictureOptions picture;
    SettingsOptions settings;
    std::optional<std::uint64_t> samples;
    std::optional<double> time_s;
    std::optional<SampleRange> range;
    std::optional<OnlySample> only_sample;
    std::optional<Crop> crop;
    std::vector<std::uint64_t> frames;  ///< numbers of the pictures; none: one picture
    std::uint64_t turntable = 0;        ///< pictures around the scene; 0: no such
    double fps = 24, shutter = 0;
    std::vector<Aov> aovs;
    bool aov_samples = false, aov_variance = false;
    bool mergeable = false;
    std::optional<PartNumber> part;
    std::filesystem::path checkpoint;  ///< empty: none
    std::optional<double> every_s;     ///< between its states
    bool uses_mpi = true;              ///< where it was started as one of several ranks
    bool writes_pictures = true;       ///< false: another rank does
    bool quiet = false, json = false, stats = false;
};

/// How many samples a pixel; if nobody says it, default_samples.
inline constexpr std::uint64_t default_samples = 256;
void add_sample_options(Command& command, RenderOptions& options);
/// Which pixels, and what is summed for each.
void add_pixel_options(Command& command, RenderOptions& options);
/// How often samples are kept on the way.
void add_every_option(Command& command, RenderOptions& options);
/// These, and all else that says what is rendered.
void add_render_options(Command& command, RenderOptions& options);
/// What the options say together: throws UsageError where they disagree, and fills in what follows from them.
void check_options(RenderOptions& options);
/// Those of the pictures; denoised ones have the layers that help. Throws UsageError if the options mean another size.
RenderSettings settings_for(const RenderOptions& options, const LoadedScene& scene, bool denoised);

}  // namespace fathom::cli
