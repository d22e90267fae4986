// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/vector.h"

namespace fathom {

/// Radiance of EnvironmentKind::studio from a direction in the environment's axes.
double studio_radiance(const Vec3d& direction);

}  // namespace fathom
