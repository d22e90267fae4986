// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "fathom/vector.h"

/// Metals by their measured complex index of refraction.
namespace fathom {

/// Complex index of refraction, eta + i k, for red, green and blue.
struct Conductor {
    const char* name;
    Color eta, k;
};

/// Metals that scenes can name; data from refractiveindex.info (Polyanskiy 2024) at 650, 550 and 450 nm.
std::span<const Conductor> conductors();

/// The conductor's index relative to an adjacent medium with index of refraction `outside`.
Conductor within(Conductor conductor, float outside);

/// Parameters of the materials' Fresnel model: `base` is the reflectance at normal incidence, `edge` the ratio of the
/// true reflectance to Schlick's at 82 degrees (Hoffman 2019, "Fresnel Equations Considered Harmful").
struct ConductorColors {
    Color base, edge;
};
ConductorColors colors_of(const Conductor& conductor);

/// Fresnel reflectance of a conductor for unpolarized light; `cosine` is that of the angle of incidence.
double conductor_reflectance(double cosine, double eta, double k);

}  // namespace fathom
