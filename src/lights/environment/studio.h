#pragma once
#include "fathom/vector.h"

namespace fathom {

/// Radiance of a studio, which is EnvironmentKind::studio, from a direction of its own axes.
double studio_radiance(const Vec3d& direction);

}  // namespace fathom
