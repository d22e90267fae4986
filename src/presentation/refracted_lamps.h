// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>

#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom {

/// Statistics of delta lights (points, spots, beams and directional lights without angle) whose light is refracted.
/// Neither next event estimation nor BSDF sampling can connect such a light with a surface through a smooth refracting
/// boundary, so its light behind the boundary is missing from the image.
struct RefractedLamps {
    std::size_t lamps = 0;  ///< number of delta lights
    std::size_t hidden =
        0;  ///< number of lights enclosed by glass: hardly any of their light hits something else first
    double light_on_glass = 0;  ///< fraction of these lights' lit directions that hit glass first
};

/// Traces a few thousand rays from the position of each such light; does nothing in scenes without smooth refracting
/// materials.
///
/// bounds  bounds of the scene in world space, needed for directional lights only
RefractedLamps find_refracted_lamps(const Scene& scene, const std::function<Bounds()>& bounds);

/// LitScene::has_smooth_glass of a scene.
bool has_smooth_glass(const Scene& scene);

/// LitScene::refracted_light of a scene.
std::string describe_refracted_lamps(const Scene& scene, const SceneDescription& description);

}  // namespace fathom
