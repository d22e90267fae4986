// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "fathom/ground_truth.h"
#include "options/render_options.h"
#include "render/reference.h"
#include "render/scene_setup.h"
#include "report/reporter.h"

namespace fathom::cli {

class Ranks;

/// Settings of a run, resolved from options and scene. One plan serves all images of the run.
struct RenderPlan {
    const LoadedScene& scene;
    const SceneOptions& scene_options;
    const ImageOptions& images;  ///< names of outputs may hold #### for the number of a frame
    const DatasetOptions& dataset;
    RenderSettings settings{};
    WriteOptions write{};
    SampleRequest samples{};
    FilmOptions film{};
    CheckpointOptions checkpoint{};
    std::string scene_digest{};          ///< digest of the scene, for checkpoints
    std::vector<SceneObject> objects{};  ///< objects of the scene, if ground truth is wanted
    std::optional<Denoiser> denoiser{};  ///< set at rank 0 only
    std::optional<Reference> reference{};
    Ranks* ranks = nullptr;           ///< the ranks that render together; nullptr: this process renders alone
    bool has_guiding_option = false;  ///< whether an option, and not a rule, decided settings.guiding
    bool stats = false;
};

/// Throws Error if memory is missing or an output can't be written, and UsageError if options do not fit the scene.
///
/// denoiser  of this process, which at ranks other than 0 has none
RenderPlan make_plan(const RenderOptions& options, const LoadedScene& loaded, std::optional<Denoiser> denoiser,
                     Ranks* ranks, Reporter& reporter);

/// The trial of light tracing that costs little of the render's time; none in short renders.
std::optional<TrialEffort> light_trial_effort(const RenderPlan& plan, const LitScene& lit);

/// Throws Error if the film and its images need more memory than is free.
void check_film_memory(const RenderPlan& plan);

/// The BVH quality that finishes the images soonest, if there is memory for it.
BvhQuality choose_tree_build(const RenderOptions& options, const RenderPlan& plan);

/// Reports what the user should know before a long render.
void announce_plan(const RenderPlan& plan, Reporter& reporter);

}  // namespace fathom::cli
