#pragma once
/// The rays of a picture of a mesh, made once by our tracer, for all to cast.
#include <vector>

#include "meshes.h"
#include "picture_rays.h"

namespace fathom::bench {

/// Seconds on the wall; of the process's own time if it has but one thread at work, since other programs may be
/// running.
double now(int threads);

/// Of a picture of 1920x1080. Meshes stand still, by instances or without.
std::vector<RaySet> make_ray_sets(const Mesh& mesh, const Bvh& bvh, std::size_t parts);

}  // namespace fathom::bench
