#pragma once
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// The boundary of a solid at which nothing happens but that a medium begins.
inline Material open_boundary()
{
    Material m;
    m.kind = MaterialKind::glass;
    m.base_color = {{1, 1, 1}, -1};
    m.roughness = {0, -1, 0};
    m.ior = 1;
    return m;
}

/// Fills a solid with what absorbs and scatters so much in a unit of length.
inline void fill_solid(Material& solid, Color absorption, Color scattering, float mean_cosine)
{
    const double most = std::max({double(absorption.r) + scattering.r, double(absorption.g) + scattering.g,
                                  double(absorption.b) + scattering.b});
    if (!(most > 0)) return;
    // Over the distance in which the densest colour is halved, so that its colour is a number of moderate size.
    const double distance = 0.6931471805599453 / most;
    // Of the straight way both are taken.
    const auto left = [&](float a, float s) { return float(std::exp(-(double(a) + double(s)) * distance)); };
    const auto scattered = [&](float s) { return float(double(s) * distance); };
    solid.attenuation_distance = distance;
    solid.attenuation_color = {left(absorption.r, scattering.r), left(absorption.g, scattering.g),
                               left(absorption.b, scattering.b)};
    solid.transmission_scatter = {scattered(scattering.r), scattered(scattering.g), scattered(scattering.b)};
    solid.transmission_scatter_anisotropy = mean_cosine;
}

/// What shapes name as in and around them. What is around one follows from what others, and the camera, are in.
template <class Medium>
class MediaOfShapes {
public:
    /// Of one shape; null: nothing.
    void add(const Medium* inside, const Medium* outside)
    {
        if (inside) inside_.insert(inside);
        if (outside && std::find(outside_.begin(), outside_.end(), outside) == outside_.end())
            outside_.push_back(outside);
    }
    /// Those around shapes that are neither in one nor around the camera, in the order in which they came.
    std::vector<const Medium*> nowhere(const Medium* around_camera) const
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
inline constexpr const char* medium_is_nowhere =
    "is around shapes, but neither in one nor around the camera: nothing is there";

/// Puts a ball of a medium, which is a solid of it, around all shapes and cameras: what is in nothing else is in it. It
/// has twice the radius of what it surrounds. Returns what is to be said of that; empty: nothing.
std::string surround(SceneDescription& scene, Material medium);

}  // namespace fathom
