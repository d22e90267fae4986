// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// An index-matched boundary: it neither reflects nor refracts, and only separates media.
inline Material index_matched_boundary()
{
    Material m;
    m.kind = MaterialKind::glass;
    m.base_color = {{1, 1, 1}, -1};
    m.roughness = {0, -1, 0};
    m.ior = 1;
    return m;
}

/// Fills a solid with a homogeneous medium: absorption and scattering coefficients per unit of length, and the mean
/// cosine of the phase function.
inline void fill_solid(Material& solid, Color absorption, Color scattering, float mean_cosine)
{
    const double most = std::max({double(absorption.r) + scattering.r, double(absorption.g) + scattering.g,
                                  double(absorption.b) + scattering.b});
    if (!(most > 0)) return;
    // The distance at which the densest channel's transmittance is 1/2 keeps the attenuation color well scaled.
    const double distance = 0.6931471805599453 / most;
    // Transmittance of the reference distance; both coefficients attenuate.
    const auto left = [&](float a, float s) { return float(std::exp(-(double(a) + double(s)) * distance)); };
    const auto scattered = [&](float s) { return float(double(s) * distance); };
    solid.interior.attenuation_distance = distance;
    solid.interior.attenuation_color = {left(absorption.r, scattering.r), left(absorption.g, scattering.g),
                                        left(absorption.b, scattering.b)};
    solid.interior.scatter = {scattered(scattering.r), scattered(scattering.g), scattered(scattering.b)};
    solid.interior.scatter_anisotropy = mean_cosine;
}

/// Collects the media that a scene format names inside and outside of each shape. Fathom derives the outside medium
/// from enclosing solids, so outside media that no shape or camera is inside of are reported or handled separately.
template <class Medium>
class ShapeMedia {
public:
    /// Registers the media of one shape; null for vacuum.
    void add(const Medium* inside, const Medium* outside)
    {
        if (inside) inside_.insert(inside);
        if (outside && std::find(outside_.begin(), outside_.end(), outside) == outside_.end())
            outside_.push_back(outside);
    }
    /// Outside media that are neither inside any shape nor around the camera, in order of registration.
    std::vector<const Medium*> not_enclosed(const Medium* around_camera) const
    {
        std::vector<const Medium*> found;
        for (const Medium* medium : outside_)
            if (medium != around_camera && !inside_.contains(medium)) found.push_back(medium);
        return found;
    }

private:
    std::set<const Medium*> inside_;
    std::vector<const Medium*> outside_;
};
inline constexpr const char* medium_not_enclosed_message =
    "surrounds shapes, but is neither inside a shape nor around the camera: it is ignored";

/// Adds a sphere filled with a medium around all shapes and cameras, with twice the radius of their bounds and the
/// lowest priority: it applies wherever no other medium does. Returns a warning, or an empty string.
std::string add_surrounding_medium(SceneDescription& scene, Material medium);

}  // namespace fathom
