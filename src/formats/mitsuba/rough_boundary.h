// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fathom::mitsuba {

/// Diffuse internal reflectance of a rough dielectric boundary, as `roughplastic` computes it: the mean over 64 cosines
/// from 0 to 1, ends included, which is 1 to 2 % below the integral.
double inner_reflectance(double alpha, bool beckmann, double ior);

}  // namespace fathom::mitsuba
