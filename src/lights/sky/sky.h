#pragma once
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// A clear sky, seen from the ground, up +y: light of the sun that molecules and haze scatter once, and less of it
/// where these and ozone take it away on either way (T. Nishita et al.: Display of the Earth Taking into Account
/// Atmospheric Scattering, 1993), and all that they and the ground scatter further, as if alike in all directions
/// (S. Hillaire: A Scalable and Production Ready Sky and Atmosphere Rendering Technique, 2020, section 5.5). By 34
/// bands of 10 nm, with the numbers of E. Bruneton: A Qualitative and Quantitative Evaluation of 8 Clear Sky Models,
/// 2017. Below the horizon is grey ground in that light. In units in which a white surface that faces the sun above the
/// air has a radiance of 1.
class Sky {
public:
    static constexpr double sun_angle = 0.00935;  ///< diameter, radians

    explicit Sky(const Vec3d& to_sun);

    /// Without the sun itself; d of unit length.
    Color radiance(const Vec3d& d) const;
    /// The part of it that was scattered once, above the horizon.
    Color scattered_once(const Vec3d& d) const;
    /// Of a surface that faces the sun; black when it is below the horizon.
    static Color sun_irradiance(const Vec3d& to_sun);

    /// Optical depths of a way through the air: times the coefficients of a band, they are its exponent.
    struct Depths {
        double molecules = 0, haze = 0, ozone = 0;

        void add(const Depths& d) { molecules += d.molecules, haze += d.haze, ozone += d.ozone; }
        /// A way through air of one density.
        template <class Densities>
        void add(const Densities& here, double length)
        {
            molecules += here.molecules * length, haze += here.haze * length, ozone += here.ozone * length;
        }
    };
    /// From a height above the ground, km, to space, by the cosine of the angle to the zenith. Ground in the way counts
    /// as air as dense as on it.
    static Depths depths_to_space(double height, double cosine);
    /// Share of the light of a wavelength, nm, that is left.
    static double transmittance(const Depths& depths, double wavelength);

private:
    /// times  how often it was scattered: once, or as often as may be
    enum class Scattering { once, all };
    Color scattered(const Vec3d& d, Scattering times) const;
    /// By band.
    struct Orders {
        std::vector<double> second, further;
    };
    void add_second_order(double height, const Vec3d& sun, double x, double y, Orders& sum) const;
    void make_multiple();
    /// Places in `multiple_`, and the weight of each.
    struct MultipleAt {
        std::size_t place[4];
        double weight[4];
    };
    static MultipleAt multiple_at(double height, double cosine, double sun_elevation);
    /// From a table.
    Depths depths_to_sun(double height, double cosine) const;

    Vec3d to_sun_;
    std::vector<Depths> table_;
    /// Radiance of light that was scattered before, by height, elevation of the sun, and band, for an irradiance of 1
    /// above the air.
    std::vector<double> multiple_;
    Color ground_;
};

}  // namespace fathom
