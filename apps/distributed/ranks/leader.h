// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "distributed/ranks/rank_render.h"

namespace fathom::cli {

/// Makes the render of rank 0, which hands out samples, renders too, gathers the films of all ranks, reports and
/// writes.
///
/// summary  is completed by RankRender::run()
std::unique_ptr<RankRender> make_leader(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job,
                                        Summary& summary, Reporter& reporter);

}  // namespace fathom::cli
