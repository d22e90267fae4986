#pragma once
#include <cstddef>
#include <functional>

#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom {

/// Lamps without size (points, spots, beams and directions of one angle) whose light meets glass. Neither light
/// sampling nor scattered paths connect such a lamp with a surface through a smooth refracting boundary, so what passes
/// it is missing from the image.
struct RefractedLamps {
    std::size_t lamps = 0;      ///< without size
    std::size_t hidden = 0;     ///< of these, enclosed by glass: hardly any of their light meets something else first
    double light_on_glass = 0;  ///< share of the directions in which these lamps light anything that meet glass first
};

/// Looks at the scene from the place of each such lamp, a few thousand rays each; nothing is done in scenes without
/// smooth refracting materials.
///
/// bounds  of the scene in world space, asked for where a light has a direction only
RefractedLamps find_refracted_lamps(const Scene& scene, const std::function<Bounds()>& bounds);

/// Adds a warning, named after `file`, where a noticeable share of the light of lamps without size is missing.
void warn_of_refracted_lamps(const Scene& scene, const SceneDescription& description, Warnings& warnings);

}  // namespace fathom
