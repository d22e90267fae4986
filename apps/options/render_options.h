// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "options/dataset_options.h"
#include "options/image_options.h"
#include "options/sample_request.h"
#include "options/scene_options.h"
#include "options/settings_options.h"

namespace fathom::cli {

/// A pixel and a sample index, to replay one path.
struct OnlySample {
    int x, y;
    std::uint64_t index;
};

/// Contents of the film of an image, beside its settings.
struct FilmOptions {
    std::optional<Crop> crop;
    std::vector<Aov> aovs;
    bool aov_samples = false, aov_variance = false, aov_error = false;
    bool mergeable = false;  ///< EXR keeps the sums
};

/// --checkpoint and --every.
struct CheckpointOptions {
    std::filesystem::path file;     ///< empty: no checkpoint
    std::optional<double> every_s;  ///< between two of them
};

/// --reference and --tolerance.
struct ReferenceOptions {
    std::filesystem::path file;  ///< empty: the render is not compared
    double tolerance = 0;
};

/// Several images of one scene.
struct SeriesOptions {
    std::vector<std::uint64_t> frames;  ///< their numbers; empty: a single image
    std::uint64_t turntable = 0;        ///< number of images around the scene; 0: no turntable
    double fps = 24, shutter = 0;
};

/// All options of `fathom render`.
struct RenderOptions {
    SceneOptions scene;
    ImageOptions images;
    SettingsOptions settings;
    SampleOptions samples;
    FilmOptions film;
    CheckpointOptions checkpoint;
    SeriesOptions series;
    DatasetOptions dataset;
    ReferenceOptions reference;
    std::optional<OnlySample> only_sample;
    bool uses_mpi = true;       ///< under mpirun, all processes render one image
    bool writes_images = true;  ///< false: another rank writes them
    bool watches = false;       ///< renders again when a file of the scene changes
    bool quiet = false, json = false, stats = false;
};

void add_film_options(Command& command, FilmOptions& options);
void add_every_option(Command& command, CheckpointOptions& options);
/// Adds all options except those of scene, settings and images.
void add_render_options(Command& command, RenderOptions& options);
/// Adds all options of `fathom render` except those of add_scene_options().
void add_other_render_options(Command& command, RenderOptions& options);
/// Adds all options of `fathom render`.
void add_all_render_options(Command& command, RenderOptions& options);
/// Throws UsageError for options that contradict each other, and fills in what follows from them.
void check_options(RenderOptions& options);

}  // namespace fathom::cli
