#pragma once
#include <span>

#include "fathom/vector.h"

/// Metals by what was measured of them.
namespace fathom {

/// Complex index of refraction, eta + i k, of red, green and blue.
struct Conductor {
    const char* name;
    Color eta, k;
};

/// Known ones, by name: from refractiveindex.info (Polyanskiy 2024), at 650, 550 and 450 nm.
std::span<const Conductor> conductors();

/// As it is met from a medium of this index.
Conductor within(Conductor conductor, float outside);

/// As the materials have it: the reflectance at normal incidence, and what is left at 82 degrees of what Schlick's law
/// makes of that (Hoffman 2019, "Fresnel Equations Considered Harmful").
struct ConductorColors {
    Color base, edge;
};
ConductorColors colors_of(const Conductor& conductor);

/// Fresnel's reflectance of unpolarised light, at an angle of this cosine.
double conductor_reflectance(double cosine, double eta, double k);

}  // namespace fathom
