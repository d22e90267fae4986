// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "render/render_plan.h"

namespace fathom::cli {

/// Renders an image and writes it; returns the exit code.
int render_image(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, Summary summary,
                 Reporter& reporter);

/// Renders an image by each camera, numbered from 0; returns the exit code.
int render_images(const RenderPlan& plan, const Scene& scene, const std::vector<Camera>& cameras,
                  const Summary& summary, Reporter& reporter);

}  // namespace fathom::cli
