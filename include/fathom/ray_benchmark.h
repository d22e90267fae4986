#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fathom/export.h"
#include "fathom/render.h"

namespace fathom {

struct RayBenchmarkSettings {
    int width = 1920, height = 1080;  ///< of the picture whose rays they are
    std::size_t rays = 1 << 18;       ///< about so many primary rays, in runs of 1024 neighbours; at most one a pixel
    int runs = 5;                     ///< the median counts
    int threads = 0;                  ///< 0: all cores
};

/// How fast one kind of rays is cast.
struct RayRate {
    std::string kind;  ///< primary, shadow, bounce-1, bounce-3, occlusion
    std::size_t rays = 0;
    double million_rays_per_s = 0;
    double nodes_per_ray = 0, primitives_per_ray = 0;  ///< visited; nodes have 16 children
};

struct RayBenchmark {
    std::vector<RayRate> rates;  ///< without kinds of which there are no rays
    std::size_t primitives = 0;  ///< in the tree, mostly triangles; those of instanced shapes count once
    std::size_t tree_bytes = 0, peak_bytes = 0;  ///< of the tree, and at most while it was built
    double build_s = 0;
};

/// Casts rays of a picture from the scene's camera at its tree, kind by kind: camera rays, shadow rays towards a lamp
/// above the camera, diffuse bounces, and short rays all around as for ambient occlusion. The rays, but not the times,
/// are the same in each call.
FATHOM_API RayBenchmark benchmark_rays(const Scene& scene, const RayBenchmarkSettings& settings);

}  // namespace fathom
