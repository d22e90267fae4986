// SPDX-License-Identifier: Apache-2.0
#include "lights/sky/sky.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace fathom {

namespace {

constexpr double earth_radius = 6360, air_height = 60;  // radius of the earth and height of the atmosphere in km
constexpr double molecule_scale = 8, haze_scale = 1.2;  // scale heights in km, over which densities fall to 1/e
constexpr double haze_anisotropy = 0.8, haze_albedo = 0.9, ground_albedo = 0.2;

constexpr int bands = 34;
constexpr double band_width = 10, first_band = 385;  // width of the bands and center of the first one, in nm

/// Solar irradiance above the atmosphere, W/m^2/nm: ASTM G-173, averaged over bands.
constexpr std::array<double, bands> solar = {
    1.01249, 1.14716, 1.72765, 1.73054, 1.68870, 1.61253, 1.91198, 2.03474, 2.02042, 2.02212, 1.93377, 1.95809,
    1.91686, 1.82980, 1.86850, 1.89310, 1.85149, 1.85040, 1.83410, 1.83450, 1.81470, 1.78158, 1.75330, 1.69650,
    1.68194, 1.64654, 1.60480, 1.52143, 1.55622, 1.51130, 1.47400, 1.44820, 1.41018, 1.36775};

/// Absorption cross section of ozone at 233 K, m^2 per molecule: V. Gorshelev, A. Serdyuchenko et al. 2014, averaged
/// over bands.
constexpr std::array<double, bands> ozone_section = {
    2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.520e-27, 8.451e-27, 1.582e-26, 2.316e-26, 3.669e-26,
    4.924e-26, 7.752e-26, 9.016e-26, 1.480e-25, 1.602e-25, 2.139e-25, 2.755e-25, 3.091e-25, 3.500e-25,
    4.266e-25, 4.672e-25, 4.398e-25, 4.701e-25, 5.019e-25, 4.305e-25, 3.740e-25, 3.215e-25, 2.662e-25,
    2.238e-25, 1.852e-25, 1.473e-25, 1.209e-25, 9.423e-26, 7.455e-26, 6.566e-26};

/// Extinction coefficients per km: of molecules and haze at ground level, and of ozone at its densest.
struct Coefficients {
    double molecules, haze, ozone;
};

Coefficients coefficients_at(double wavelength)
{
    const double um = wavelength / 1000;
    const double index = std::clamp((wavelength - first_band) / band_width, 0.0, double(bands - 1));
    const double section = ozone_section[std::size_t(std::lround(index))];
    // Peak density of ozone, for a column of 300 Dobson units in the profile of 15 km effective width below.
    constexpr double densest = 300 * 2.687e20 / 15000;
    // Haze has an optical depth of 0.1 at 550 nm and an Angstrom exponent of 1.3.
    return {1.24062e-3 * std::pow(um, -4), 0.1 / haze_scale * std::pow(um / 0.55, -1.3), densest * section * 1000};
}

/// CIE color matching functions: C. Wyman, P.-P. Sloan, P. Shirley 2013, "Simple Analytic Approximations to the CIE XYZ
/// Color Matching Functions".
Vec3d matching(double wavelength)
{
    const auto lobe = [&](double middle, double below, double above) {
        const double t = (wavelength - middle) / (wavelength < middle ? below : above);
        return std::exp(-0.5 * t * t);
    };
    return {1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2),
            0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
            1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)};
}

/// A value for each band.
using Spectrum = std::array<double, bands>;

struct BandTable {
    Spectrum molecules, haze, ozone;   ///< extinction coefficients, as in Coefficients
    std::array<Vec3d, bands> weights;  ///< Rec.709 color per transmittance of sunlight, for each band
};

Vec3d rec709_from_xyz(const Vec3d& c)
{
    return {3.2406 * c.x - 1.5372 * c.y - 0.4986 * c.z, -0.9689 * c.x + 1.8758 * c.y + 0.0415 * c.z,
            0.0557 * c.x - 0.2040 * c.y + 1.0570 * c.z};
}

/// Weights are normalized so that unattenuated sunlight has an illuminance of pi.
BandTable make_bands()
{
    BandTable made;
    double y = 0;
    for (std::size_t i = 0; i < bands; ++i) {
        const double wavelength = first_band + band_width * double(i);
        const Vec3d xyz = matching(wavelength) * solar[i];
        y += xyz.y;
        const Coefficients air = coefficients_at(wavelength);
        made.molecules[i] = air.molecules, made.haze[i] = air.haze, made.ozone[i] = air.ozone;
        made.weights[i] = rec709_from_xyz(xyz);
    }
    for (Vec3d& weight : made.weights) weight = weight * (std::numbers::pi / y);
    return made;
}

const BandTable& band_table()
{
    static const BandTable table = make_bands();
    return table;
}

/// e^x for x <= 0 with relative error 1e-11: branch-free, so that loops vectorize, and bitwise equal on all machines,
/// unlike std::exp.
double exp_negative(double x)
{
    constexpr double magic = 0x1.8p52;  // adding this number rounds to an integer, held in the lowest bits
    const double octaves = std::max(x, -700.0) * std::numbers::log2e, shifted = octaves + magic;
    const double r = (octaves - (shifted - magic)) * std::numbers::ln2;
    double e = 1.0 / 362880;
    for (const double inverse : {40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0, 1.0, 1.0}) e = e * r + 1 / inverse;
    const auto exponent = std::bit_cast<std::uint64_t>(shifted) - std::bit_cast<std::uint64_t>(magic);
    return e * std::bit_cast<double>((exponent + 1023) << 52);
}

/// Transmittance for each band.
Spectrum transmittances(const Sky::OpticalDepths& depths)
{
    const BandTable& t = band_table();
    Spectrum left;
    for (std::size_t i = 0; i < bands; ++i)
        // Haze scatters only a part of the light that it removes; extinction counts all of it.
        left[i] =
            exp_negative(-(t.molecules[i] * depths.molecules + t.haze[i] * depths.haze + t.ozone[i] * depths.ozone));
    return left;
}

Color color_of(const Vec3d& c)
{
    return {float(std::max(0.0, c.x)), float(std::max(0.0, c.y)), float(std::max(0.0, c.z))};
}

Color color_of_light(const Spectrum& light)
{
    Vec3d sum;
    for (std::size_t i = 0; i < bands; ++i) sum = sum + band_table().weights[i] * light[i];
    return color_of(sum);
}

struct Densities {
    double molecules, haze, ozone;
};

Densities densities_at(double height)
{
    // The density of ozone rises linearly from 10 km to its maximum at 25 km, and falls to 0 at 40 km.
    return {std::exp(-height / molecule_scale), std::exp(-height / haze_scale),
            std::max(0.0, 1 - std::abs(height - 25) / 15)};
}

/// Distance in km along a ray to the top of the atmosphere.
double distance_to_space(double height, double cosine)
{
    const double r = earth_radius + height, top = earth_radius + air_height;
    return -r * cosine + std::sqrt(std::max(0.0, r * r * (cosine * cosine - 1) + top * top));
}

double height_along_ray(double height, double cosine, double way)
{
    const double r = earth_radius + height;
    return std::sqrt(r * r + way * way + 2 * r * way * cosine) - earth_radius;
}

bool intersects_ground(double height, double cosine)
{
    const double r = earth_radius + height;
    return cosine < 0 && r * r * (1 - cosine * cosine) < earth_radius * earth_radius;
}

// Size of the table of optical depths by height and zenith cosine, both with finer steps where depths change faster.
constexpr int table_heights = 48, table_cosines = 192;

double table_height(double i)
{
    const double t = i / (table_heights - 1);
    return air_height * t * t;
}
double table_cosine(double j)
{
    const double t = 2 * j / (table_cosines - 1) - 1;
    return t * std::abs(t);
}

// Size of the table of multiple scattering by height and by the sun's elevation at the points of the visible
// atmosphere, whose far end is 8 degrees around the earth.
constexpr int multiple_heights = 12, multiple_elevations = 10;
constexpr double elevations_around = 9 * std::numbers::pi / 180;

/// Scattering coefficients per km for isotropic light.
Spectrum scattering(const Densities& here)
{
    const BandTable& t = band_table();
    Spectrum sent;
    for (std::size_t i = 0; i < bands; ++i)
        sent[i] = t.molecules[i] * here.molecules + haze_albedo * t.haze[i] * here.haze;
    return sent;
}

/// Divides a ray into steps that are shorter near its origin, and calls f(distance to the step's middle, its length).
template <class F>
void along(double way, int steps, F f)
{
    for (int i = 0; i < steps; ++i) {
        const double from = double(i) / steps, to = double(i + 1) / steps;
        const double begin = way * from * from, end = way * to * to;
        f((begin + end) / 2, end - begin);
    }
}

}  // namespace

Sky::OpticalDepths Sky::depths_to_space(double height, double cosine)
{
    OpticalDepths sum;
    along(distance_to_space(height, cosine), 200, [&](double at, double length) {
        // Rays into the ground are clamped to ground level, so that all table entries are finite.
        const Densities d = densities_at(std::max(0.0, height_along_ray(height, cosine, at)));
        sum.add(d, length);
    });
    return sum;
}

double Sky::transmittance(const OpticalDepths& depths, double wavelength)
{
    const Coefficients air = coefficients_at(wavelength);
    return std::exp(-(air.molecules * depths.molecules + air.haze * depths.haze + air.ozone * depths.ozone));
}

Sky::Sky(const Vec3d& to_sun) : to_sun_(normalize(to_sun))
{
    constexpr int places = table_heights * table_cosines;
    table_.resize(places);
    tbb::parallel_for(0, places, [&](int place) {
        const int height = place / table_cosines, cosine = place % table_cosines;
        table_[std::size_t(place)] = depths_to_space(table_height(height), table_cosine(cosine));
    });
    make_multiple();
    // Irradiance of the ground is that by direct sunlight, plus the sky integrated over the upper hemisphere.
    const Color sun = sun_irradiance(to_sun_);
    const double facing = std::max(0.0, to_sun_.y);
    Vec3d sum = Vec3d{double(sun.r), double(sun.g), double(sun.b)} * facing;
    constexpr int rows = 16, columns = 32;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            // The strata have equal projected solid angle.
            const double sine = std::sqrt((i + 0.5) / rows), phi = 2 * std::numbers::pi * (j + 0.5) / columns;
            const Color c =
                scattered({sine * std::cos(phi), std::sqrt(1 - sine * sine), sine * std::sin(phi)}, Scattering::all);
            sum = sum + Vec3d{double(c.r), double(c.g), double(c.b)} * (std::numbers::pi / (rows * columns));
        }
    ground_ = color_of(sum * (ground_albedo / std::numbers::pi));
}

Sky::OpticalDepths Sky::depths_to_sun(double height, double cosine) const
{
    const double x =
        std::clamp(std::sqrt(std::max(0.0, height) / air_height) * (table_heights - 1), 0.0, table_heights - 1.001);
    const double t = std::copysign(std::sqrt(std::abs(cosine)), cosine);
    const double y = std::clamp((t + 1) / 2 * (table_cosines - 1), 0.0, table_cosines - 1.001);
    const auto i = std::size_t(x), j = std::size_t(y);
    const double u = x - double(i), v = y - double(j);
    const auto mix = [&](double OpticalDepths::* member) {
        const auto at = [&](std::size_t a, std::size_t b) { return table_[a * table_cosines + b].*member; };
        return std::lerp(std::lerp(at(i, j), at(i, j + 1), v), std::lerp(at(i + 1, j), at(i + 1, j + 1), v), u);
    };
    return {mix(&OpticalDepths::molecules), mix(&OpticalDepths::haze), mix(&OpticalDepths::ozone)};
}

Color Sky::sun_irradiance(const Vec3d& to_sun)
{
    const double cosine = normalize(to_sun).y;
    if (!(cosine > 0)) return {0, 0, 0};
    return color_of_light(transmittances(depths_to_space(0, cosine)));
}

/// Adds the contribution of one direction (x towards the sun, y up): isotropic second-order radiance, and the fraction
/// of ambient light that further scattering adds at this point.
void Sky::add_second_order(double height, const Vec3d& sun, double x, double y, Orders& sum) const
{
    constexpr int steps = 20;
    const double r = earth_radius + height;
    const bool to_ground = intersects_ground(height, y);
    const double way = to_ground ? -r * y - std::sqrt(r * r * (y * y - 1) + earth_radius * earth_radius)
                                 : distance_to_space(height, y);
    const auto sun_cosine = [&](double at, double there) {
        return (r * sun.y + at * (x * sun.x + y * sun.y)) / (earth_radius + there);
    };
    OpticalDepths seen;
    along(way, steps, [&](double at, double length) {
        const double there = std::max(0.0, height_along_ray(height, y, at));
        const Densities here = densities_at(there);
        seen.add(here, length / 2);
        const double cosine = sun_cosine(at, there);
        const bool lit = !intersects_ground(there, cosine);
        Spectrum sent = scattering(here);
        const Spectrum left = transmittances(seen);
        for (std::size_t b = 0; b < bands; ++b) sum.further[b] += sent[b] *= left[b] * length;
        seen.add(here, length / 2);
        if (!lit) return;
        const Spectrum sunlight = transmittances(depths_to_sun(there, cosine));
        for (std::size_t b = 0; b < bands; ++b) sum.second[b] += sent[b] * sunlight[b] / (4 * std::numbers::pi);
    });
    const double cosine = sun_cosine(way, 0);
    if (!to_ground || !(cosine > 0)) return;
    seen.add(depths_to_sun(0, cosine));
    const Spectrum sunlight = transmittances(seen);
    for (std::size_t b = 0; b < bands; ++b) sum.second[b] += ground_albedo / std::numbers::pi * cosine * sunlight[b];
}

/// Fills the table by Hillaire's equations 5 to 9: second-order radiance from all directions, divided by one minus the
/// fraction that each further order retains (a geometric series).
void Sky::make_multiple()
{
    constexpr int cosines = 8, turns = 8;
    constexpr double share = 1.0 / (cosines * turns);
    const double elevation = std::asin(std::clamp(to_sun_.y, -1.0, 1.0));
    constexpr int places = multiple_heights * multiple_elevations;
    multiple_.resize(std::size_t(places) * bands);
    tbb::parallel_for(0, places, [&](int place) {
        const int height = place / multiple_elevations, angle = place % multiple_elevations;
        const double t = double(height) / (multiple_heights - 1);
        const double e = elevation + (2.0 * angle / (multiple_elevations - 1) - 1) * elevations_around;
        const Vec3d sun{std::abs(std::cos(e)), std::sin(e), 0};
        Orders sum{std::vector<double>(bands), std::vector<double>(bands)};
        for (int k = 0; k < cosines * turns; ++k) {
            const int cosine = k / turns, turn = k % turns;
            const double y = 2 * (cosine + 0.5) / cosines - 1;
            const double phi = 2 * std::numbers::pi * (turn + 0.5) / turns;
            add_second_order(air_height * t * t, sun, std::sqrt(1 - y * y) * std::cos(phi), y, sum);
        }
        double* const multiple = &multiple_[std::size_t(place) * bands];
        for (std::size_t b = 0; b < bands; ++b) multiple[b] = sum.second[b] * share / (1 - sum.further[b] * share);
    });
}

Sky::MultipleAt Sky::multiple_at(double height, double cosine, double sun_elevation)
{
    const auto split = [](double at, int count) {
        const double inside = std::clamp(at, 0.0, count - 1.001);
        return std::pair{std::size_t(inside), inside - std::floor(inside)};
    };
    const double elevation = std::asin(std::clamp(cosine, -1.0, 1.0));
    const auto [i, u] = split(std::sqrt(std::max(0.0, height) / air_height) * (multiple_heights - 1), multiple_heights);
    const auto [j, v] = split(((elevation - sun_elevation) / elevations_around + 1) / 2 * (multiple_elevations - 1),
                              multiple_elevations);
    const std::size_t first = (i * multiple_elevations + j) * bands, next_height = multiple_elevations * bands;
    return {{first, first + bands, first + next_height, first + next_height + bands},
            {(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v}};
}

Color Sky::scattered(const Vec3d& d, Scattering times) const
{
    const double cosine = dot(d, to_sun_), g = haze_anisotropy;
    const double of_molecules = 3 / (16 * std::numbers::pi) * (1 + cosine * cosine);
    // The phase function is that of W. Cornette, J. Shanks 1992, "Physically Reasonable Analytic Expression for the
    // Single-Scattering Phase Function".
    const double of_haze = 3 / (8 * std::numbers::pi) * (1 - g * g) * (1 + cosine * cosine) /
                           ((2 + g * g) * std::pow(1 + g * g - 2 * g * cosine, 1.5));
    const double sun_elevation = std::asin(std::clamp(to_sun_.y, -1.0, 1.0));
    const BandTable& t = band_table();
    Spectrum light{};
    OpticalDepths seen;
    along(distance_to_space(0, d.y), 40, [&](double at, double length) {
        const double height = height_along_ray(0, d.y, at);
        const Densities here = densities_at(height);
        seen.add(here, length / 2);
        const double sun_cosine = (earth_radius * to_sun_.y + at * cosine) / (earth_radius + height);
        if (!intersects_ground(height, sun_cosine)) {
            OpticalDepths way = depths_to_sun(height, sun_cosine);
            way.add(seen);
            const Spectrum left = transmittances(way);
            const double molecules = here.molecules * of_molecules * length,
                         haze = haze_albedo * here.haze * of_haze * length;
            for (std::size_t i = 0; i < bands; ++i)
                light[i] += (t.molecules[i] * molecules + t.haze[i] * haze) * left[i];
        }
        if (times == Scattering::all) {
            const MultipleAt m = multiple_at(height, sun_cosine, sun_elevation);
            const Spectrum sent = scattering(here), left = transmittances(seen);
            for (std::size_t i = 0; i < bands; ++i) {
                double before = 0;
                for (std::size_t k = 0; k < 4; ++k) before += m.weight[k] * multiple_[m.place[k] + i];
                light[i] += sent[i] * before * left[i] * length;
            }
        }
        seen.add(here, length / 2);
    });
    return color_of_light(light);
}

Color Sky::radiance(const Vec3d& d) const
{
    return d.y >= 0 ? scattered(d, Scattering::all) : ground_;
}

Color Sky::scattered_once(const Vec3d& d) const
{
    return scattered(d, Scattering::once);
}

}  // namespace fathom
