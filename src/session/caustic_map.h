// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "kernel/kernel.h"

namespace fathom {

/// The photons of a sample index, in any order. Runs in the caller's task arena.
std::vector<CausticPhoton> trace_photons(const KernelScene& scene, const CameraRecord& camera,
                                         const KernelSettings& settings, std::uint32_t sample);

/// Radius within which photons are gathered at sample index 0: the median distance from a photon to its twelfth
/// neighbor of the same sample. fallback: radius if there are too few photons to tell.
///
/// photons  of `samples` samples
float first_caustic_radius(std::vector<CausticPhoton> photons, std::uint32_t samples, float fallback);
/// Computes this radius from the photons of the first samples; traces as many samples as it takes to know their
/// density. Runs in the caller's task arena.
float first_caustic_radius(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                           float ball_radius);

/// Sorts photons of the samples [first, first + samples) into a grid. The radius of sample index k is first_radius
/// times (k + 1)^(-1/6), so that the mean over many samples converges: Knaus and Zwicker 2011, "Progressive Photon
/// Mapping: A Probabilistic Approach". A sample's estimate does not depend on the other samples of the map.
CausticMap make_caustic_map(std::vector<CausticPhoton> photons, std::uint32_t first, std::uint32_t samples,
                            float first_radius);

}  // namespace fathom
