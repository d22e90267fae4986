// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ray sets of a view of a mesh, traced once by Fathom, for all measurements.
#include <vector>

#include "meshes.h"
#include "picture_rays.h"

namespace fathom::bench {

/// Seconds of wall clock time; of processor time if there is only one thread, since other programs may be running.
double now(int threads);

/// Ray sets of a view of 1920x1080 pixels. The mesh is static, instanced or not.
std::vector<RaySet> make_ray_sets(const Mesh& mesh, const Bvh& bvh, std::size_t parts);

}  // namespace fathom::bench
