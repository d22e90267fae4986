#pragma once
#include "fathom/vector.h"

namespace fathom {

/// A clear sky by a formula: L. Hosek, A. Wilkie: An Analytic Model for Full Spectral Sky-Dome Radiance, 2012, in
/// linear Rec.709, up +y. Its coefficients are those that give back what Mitsuba 3's `sunsky` shows
/// (tools/hosek_sky.py). Nothing is below the horizon.
class HosekSky {
public:
    static constexpr int coefficients = 10;  ///< nine of the formula, and the mean radiance that it is times

    /// turbidity      1 to 10: 2 clear, 6 hazy; others are taken as the nearest of these
    /// ground_albedo  0 to 1, of the ground that lights the air from below
    HosekSky(const Vec3d& to_sun, double turbidity, double ground_albedo);

    /// W/m^2/sr/nm, without the sun itself; d of unit length.
    Color radiance(const Vec3d& d) const;

private:
    Vec3d to_sun_;
    double coefficients_[3][coefficients];
};

}  // namespace fathom
