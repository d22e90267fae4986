// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/job.h"
#include "film/film_data.h"
#include "kernel/kernel.h"

namespace fathom {

/// The settings in the kernel's terms, without what is learned: guiding tables and targets of light paths.
KernelSettings kernel_settings(const RenderSettings& settings, const FilmLayout& layout);

}  // namespace fathom
