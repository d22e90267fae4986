// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "options/render_options.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Applies what --dataset implies, and throws UsageError for options that contradict it. Without --dataset it checks
/// --views, --cameras and --ground-truth.
void check_dataset(RenderOptions& options);

/// Renders the data set of --dataset: that of one model, or of all models of --models; returns the exit code.
int render_dataset(const RenderOptions& options, Reporter& reporter);

}  // namespace fathom::cli
