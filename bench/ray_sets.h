#pragma once
/// The rays of a picture, made once by our tracer, for both to cast.
#include <string>
#include <vector>

#include "geometry/bvh.h"
#include "meshes.h"

namespace fathom::bench {

/// Seconds on the wall; of the process's own time if it has but one thread at work, since other programs may be
/// running.
double now(int threads);

struct RaySet {
    std::string kind;
    bool shadow = false, coherent = false;
    std::vector<float> o[3], d[3], t_max;

    std::size_t count() const { return t_max.size() - padding; }
    RayArrays arrays(std::size_t first, std::size_t n) const;
    static constexpr std::size_t padding = 64;
};

/// primary, shadow, bounce-1, bounce-3, occlusion: at 1920x1080 in Morton order of the pixels. With `parts` > 1 only
/// every so many runs of 1024 pixels.
std::vector<RaySet> make_ray_sets(const Mesh& mesh, const Bvh& bvh, std::size_t parts);

}  // namespace fathom::bench
