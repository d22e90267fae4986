// SPDX-License-Identifier: Apache-2.0
#include "formats/common/spectra.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom {

namespace {

constexpr int first_nm = 360, last_nm = 830;
constexpr double planck = 6.62607015e-34, light_speed = 299792458, boltzmann = 1.380649e-23;

double lobe(double x, double mean, double low, double high)
{
    const double t = (x - mean) * (x < mean ? low : high);
    return std::exp(-0.5 * t * t);
}

std::array<double, 3> matching(double nm)
{
    return {0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
                0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
            0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
            1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

Color rec709(double x, double y, double z)
{
    return {float(3.2404542 * x - 1.5371385 * y - 0.4985314 * z), float(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
            float(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

double radiance_of_black_body(double nm, double temperature)
{
    const double m = nm * 1e-9;
    return 2e-9 * planck * light_speed * light_speed /
           (std::pow(m, 5) * std::expm1(planck * light_speed / (m * boltzmann * temperature)));
}

/// Relative spectral power of D65, in steps of 20 nm from 360 nm (CIE 15).
double daylight(double nm)
{
    constexpr double first = 360, step = 20;
    constexpr double of[] = {46.64, 49.98, 82.75, 93.43, 104.86, 117.81, 115.92, 109.35, 104.79, 104.41, 100.00, 95.79,
                             90.01, 87.70, 83.70, 80.21, 78.28,  71.61,  61.60,  75.09,  46.42,  63.38,  60.31,  58.00};
    const double at = std::clamp((nm - first) / step, 0.0, double(std::size(of) - 1));
    const std::size_t i = std::min(std::size_t(at), std::size(of) - 2);
    return of[i] + (at - double(i)) * (of[i + 1] - of[i]);
}

double value_at(const std::vector<SpectrumPoint>& points, double nm)
{
    const auto after = std::upper_bound(points.begin(), points.end(), nm,
                                        [](double x, const SpectrumPoint& p) { return x < p.wavelength; });
    if (after == points.begin()) return 0;
    const SpectrumPoint& before = *(after - 1);
    if (after == points.end()) return before.wavelength == nm ? before.value : 0;
    const double span = after->wavelength - before.wavelength;
    return before.value + (nm - before.wavelength) / span * (after->value - before.value);
}

/// Integrates a spectrum against the color matching functions, normalized so that `white` has luminance 1.
template <class Value, class White>
Color integrated(const Value& value, const White& white)
{
    double sum[3] = {}, whole = 0;
    for (int nm = first_nm; nm <= last_nm; ++nm) {
        const std::array<double, 3> xyz = matching(nm);
        const double v = value(nm);
        for (std::size_t i = 0; i < 3; ++i) sum[i] += v * xyz[i];
        whole += white(nm) * xyz[1];
    }
    return rec709(sum[0] / whole, sum[1] / whole, sum[2] / whole);
}

}  // namespace

Color color_of_light(const std::vector<SpectrumPoint>& points)
{
    return integrated([&](double nm) { return value_at(points, nm); }, [](double) { return 1.0; });
}

Color color_in_daylight(const std::vector<SpectrumPoint>& points)
{
    const Color c = integrated([&](double nm) { return value_at(points, nm) * daylight(nm); }, daylight),
                white = integrated(daylight, daylight);
    return {c.r / white.r, c.g / white.g, c.b / white.b};
}

Color color_of_surface(const std::vector<SpectrumPoint>& points)
{
    const auto limited = [](float x) { return std::clamp(x, 0.f, 1.f); };
    const Color c = color_in_daylight(points);
    return {limited(c.r), limited(c.g), limited(c.b)};
}

Color color_of_black_body(double temperature)
{
    return integrated([&](double nm) { return radiance_of_black_body(nm, temperature); }, [](double) { return 1.0; });
}

}  // namespace fathom
