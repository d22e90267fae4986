#pragma once
#include <optional>

#include "options/render_options.h"
#include "report/reporter.h"

namespace fathom::cli {

class Ranks;

/// What is the same for all pictures of a run.
struct RenderPlan {
    const LoadedScene& scene;
    RenderSettings settings;
    WriteOptions write;
    std::optional<std::uint64_t> samples;
    SampleRange range;        ///< those that are wanted in the end
    std::string scene_parts;  ///< for a checkpoint
    std::optional<Denoiser> denoiser;
    Ranks* ranks = nullptr;  ///< those that render together; nullptr: this process alone
};

/// Renders a picture and writes it; returns the exit code.
int render_picture(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files,
                   const RenderJob& job, Summary summary, Reporter& reporter);

}  // namespace fathom::cli
