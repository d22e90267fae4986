// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// A clear sky seen from the ground, up is +y. Single scattering by molecules and haze, with absorption by ozone, is
/// integrated along rays (T. Nishita et al. 1993, "Display of the Earth Taking into Account Atmospheric Scattering").
/// Higher orders, including the ground's reflection, are approximated as isotropic (S. Hillaire 2020, "A Scalable and
/// Production Ready Sky and Atmosphere Rendering Technique", section 5.5). The spectrum has 34 bands of 10 nm, with the
/// data of E. Bruneton 2017, "A Qualitative and Quantitative Evaluation of 8 Clear Sky Models". Below the horizon is
/// gray ground in that light.
///
/// The unit of radiance is the radiance of a white surface that faces the sun above the atmosphere.
class Sky {
public:
    static constexpr double sun_angle = 0.00935;  ///< angular diameter of the sun in radians

    explicit Sky(const Vec3d& to_sun);

    /// Radiance without the sun; d: unit vector.
    Color radiance(const Vec3d& d) const;
    /// The single-scattering part of radiance(), above the horizon.
    Color scattered_once(const Vec3d& d) const;
    /// Irradiance of a surface that faces the sun, by direct sunlight; 0 if the sun is below the horizon.
    static Color sun_irradiance(const Vec3d& to_sun);

    /// Optical depths of a ray through the atmosphere: multiplied by a band's coefficients they give its extinction.
    struct OpticalDepths {
        double molecules = 0, haze = 0, ozone = 0;

        void add(const OpticalDepths& d) { molecules += d.molecules, haze += d.haze, ozone += d.ozone; }
        /// Adds a segment of constant density.
        template <class Densities>
        void add(const Densities& here, double length)
        {
            molecules += here.molecules * length, haze += here.haze * length, ozone += here.ozone * length;
        }
    };
    /// Optical depths from a height above the ground (km) to space, by the cosine of the zenith angle. Rays below the
    /// horizon pass through ground, which counts as air of ground density.
    static OpticalDepths depths_to_space(double height, double cosine);
    /// Transmittance at a wavelength in nm.
    static double transmittance(const OpticalDepths& depths, double wavelength);

private:
    /// Scattering orders to include: only the first, or all.
    enum class Scattering { once, all };
    Color scattered(const Vec3d& d, Scattering times) const;
    /// Radiance of second order, and the fraction that further orders add, for each band.
    struct Orders {
        std::vector<double> second, further;
    };
    void add_second_order(double height, const Vec3d& sun, double x, double y, Orders& sum) const;
    void make_multiple();
    /// Bilinear lookup in `multiple_`: four indices with their weights.
    struct MultipleAt {
        std::size_t place[4];
        double weight[4];
    };
    static MultipleAt multiple_at(double height, double cosine, double sun_elevation);
    /// Interpolates the table of depths_to_space.
    OpticalDepths depths_to_sun(double height, double cosine) const;

    Vec3d to_sun_;
    std::vector<OpticalDepths> table_;
    /// Radiance of multiply scattered light by height, sun elevation and band, for an irradiance of 1 above the
    /// atmosphere.
    std::vector<double> multiple_;
    Color ground_;
};

}  // namespace fathom
