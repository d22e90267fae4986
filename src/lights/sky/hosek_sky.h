// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/vector.h"

namespace fathom {

/// Analytic clear sky: L. Hosek, A. Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance", in linear
/// Rec.709, up is +y. Its coefficients reproduce Mitsuba 3's `sunsky` (tools/hosek_sky.py). Radiance below the horizon
/// is 0.
class HosekSky {
public:
    static constexpr int coefficients = 10;  ///< nine coefficients of the formula, and its factor, the mean radiance

    /// turbidity      1 to 10: 2 is clear, 6 hazy; clamped to that range
    /// ground_albedo  0 to 1; albedo of the ground, whose reflected light the air scatters
    HosekSky(const Vec3d& to_sun, double turbidity, double ground_albedo);

    /// Radiance in W/m^2/sr/nm without the sun; d: unit vector.
    Color radiance(const Vec3d& d) const;

private:
    Vec3d to_sun_;
    double coefficients_[3][coefficients];
};

}  // namespace fathom
