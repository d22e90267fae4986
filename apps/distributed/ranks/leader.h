#pragma once
#include <memory>

#include "distributed/ranks/rank_render.h"

namespace fathom::cli {

/// A picture at rank 0: it hands samples out, renders too, gathers what all have, tells and writes.
///
/// summary  so far, which it completes
std::unique_ptr<SharedPicture> led_picture(const RenderOptions& options, const RenderPlan& plan,
                                           const PictureOptions& files, const RenderJob& job, Summary& summary,
                                           Reporter& reporter);

}  // namespace fathom::cli
