// SPDX-License-Identifier: Apache-2.0
#include "scene/conductors.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

constexpr Conductor known[] = {
    {"aluminium", {1.3456f, 0.96521f, 0.61722f}, {7.4746f, 6.3995f, 5.3031f}},
    {"brass", {0.444f, 0.527f, 1.094f}, {3.695f, 2.765f, 1.829f}},
    {"chromium", {3.1071f, 3.1812f, 2.3230f}, {3.3314f, 3.3291f, 3.1350f}},
    {"copper", {0.27105f, 0.67693f, 1.3164f}, {3.6092f, 2.6248f, 2.2921f}},
    {"gold", {0.18299f, 0.42108f, 1.3734f}, {3.4242f, 2.3459f, 1.7704f}},
    {"iron", {2.9114f, 2.9497f, 2.5845f}, {3.0893f, 2.9318f, 2.7670f}},
    {"platinum", {2.3757f, 2.0847f, 1.8453f}, {4.2655f, 3.7153f, 3.1365f}},
    {"silver", {0.15943f, 0.14512f, 0.13547f}, {3.9291f, 3.1900f, 2.3808f}},
    {"titanium", {2.7407f, 2.5418f, 2.2370f}, {3.8143f, 3.4345f, 3.0235f}},
};

/// Computes `base` and `edge` of ConductorColors for one channel.
void channel_colors(double eta, double k, float& base, float& edge)
{
    const double cosine = 1.0 / 7, f0 = conductor_reflectance(1, eta, k);
    const double schlick = f0 + (1 - f0) * std::pow(1 - cosine, 5);
    base = float(f0);
    edge = float(std::clamp(conductor_reflectance(cosine, eta, k) / schlick, 0.0, 1.0));
}

}  // namespace

std::span<const Conductor> conductors()
{
    return known;
}

Conductor within(Conductor c, float outside)
{
    for (Color* v : {&c.eta, &c.k}) *v = {v->r / outside, v->g / outside, v->b / outside};
    return c;
}

double conductor_reflectance(double cosine, double eta, double k)
{
    const double c2 = cosine * cosine, s2 = 1 - c2, difference = eta * eta - k * k - s2;
    const double sum = std::sqrt(difference * difference + 4 * eta * eta * k * k);
    const double a = std::sqrt(std::max(0.0, (sum + difference) / 2));
    const double s = (sum + c2 - 2 * a * cosine) / (sum + c2 + 2 * a * cosine);
    const double p = s * (c2 * sum + s2 * s2 - 2 * a * cosine * s2) / (c2 * sum + s2 * s2 + 2 * a * cosine * s2);
    return (s + p) / 2;
}

ConductorColors colors_of(const Conductor& c)
{
    ConductorColors colors;
    channel_colors(c.eta.r, c.k.r, colors.base.r, colors.edge.r);
    channel_colors(c.eta.g, c.k.g, colors.base.g, colors.edge.g);
    channel_colors(c.eta.b, c.k.b, colors.base.b, colors.edge.b);
    return colors;
}

}  // namespace fathom
