// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "compile/compiler.h"
#include "lights/environment/studio.h"
#include "lights/sky/hosek_sky.h"
#include "lights/sky/sky.h"
#include "math/guide.h"
#include "math/luminance.h"

namespace fathom {

namespace {

/// Images whose maximum is at most this multiple of their mean are sampled without MIS compensation.
constexpr double much_above_mean = 2;

/// Luminance per pixel, averaged over 3x3 neighbors: bilinear lookup spreads a pixel's light over its neighbors.
std::vector<float> cell_luminances(const EnvironmentRecord& t)
{
    const int w = t.width, h = t.height;
    const auto value = [&](int x, int y) {
        x = (x + w) % w;
        y = std::clamp(y, 0, h - 1);
        const float* texel = &t.texels[(std::uint64_t(y) * std::uint64_t(w) + std::uint64_t(x)) * 4];
        const float c[3] = {texel[0] * t.color[0], texel[1] * t.color[1], texel[2] * t.color[2]};
        return std::max(0.0, luminance(c));
    };
    std::vector<float> cells;
    cells.reserve(std::size_t(w) * std::size_t(h));
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            double v = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) v += value(x + dx, y + dy) / 9;
            cells.push_back(float(v));
        }
    return cells;
}

/// Returns the sine of the polar angle at the middle of row y, to which the solid angle of its pixels is proportional.
double row_sine(int y, int height)
{
    return std::sin((y + 0.5) * std::numbers::pi / height);
}

double mean_over_sphere(const std::vector<float>& cells, int w, int h)
{
    double sum = 0, weight = 0;
    for (int y = 0; y < h; ++y) {
        const float* const row = &cells[std::size_t(y) * std::size_t(w)];
        sum += row_sine(y, h) * std::accumulate(row, row + w, 0.0);
        weight += row_sine(y, h) * w;
    }
    return sum / weight;
}

/// Builds the cumulative distributions over rows and, within rows, over pixels, by luminance times solid angle, with
/// guide tables. Returns the mean luminance.
///
/// Only the part above the mean is sampled. The rest is left to BSDF sampling; MIS weights account for it (Karlík et
/// al. 2019, "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling").
double make_environment_distribution(EnvironmentRecord& t)
{
    const int w = t.width, h = t.height;
    std::vector<float> cells = cell_luminances(t);
    const double mean = mean_over_sphere(cells, w, h);
    const bool is_compensated = *std::max_element(cells.begin(), cells.end()) > much_above_mean * mean;
    if (is_compensated)
        for (float& v : cells) v = std::max(0.f, v - float(mean));
    t.base_luminance = is_compensated ? float(mean) : 0;
    t.luminance_per_pdf = float(4 * std::numbers::pi * mean_over_sphere(cells, w, h));
    t.marginal.assign(std::size_t(h) + 1, 0);
    t.conditional.assign(std::size_t(h) * std::size_t(w + 1), 0);
    std::vector<double> rows(std::size_t(h) + 1);
    for (int y = 0; y < h; ++y) {
        std::vector<double> sum(std::size_t(w) + 1);
        const float* const values = &cells[std::size_t(y) * std::size_t(w)];
        for (std::size_t x = 0; x < std::size_t(w); ++x) sum[x + 1] = sum[x] + values[x];
        const double all = sum[std::size_t(w)];
        float* row = &t.conditional[std::size_t(y) * std::size_t(w + 1)];
        for (int x = 0; x <= w; ++x) row[x] = all > 0 ? float(sum[std::size_t(x)] / all) : float(x) / float(w);
        rows[std::size_t(y) + 1] = rows[std::size_t(y)] + all * row_sine(y, h);
    }
    const double total = rows[std::size_t(h)];
    for (int y = 0; y <= h; ++y)
        t.marginal[std::size_t(y)] = total > 0 ? float(rows[std::size_t(y)] / total) : float(y) / float(h);
    t.marginal_guide = make_guides(t.marginal, h);
    t.conditional_guides = make_guides(t.conditional, w);
    return mean;
}

/// Renders a procedural environment to an equirectangular image, which is then evaluated and sampled as any other.
template <class Radiance>
void make_picture(EnvironmentRecord& t, int width, const Radiance& radiance)
{
    t.kind = std::uint32_t(EnvironmentKind::image);
    t.width = width, t.height = width / 2;
    t.texels.resize(std::size_t(t.width) * std::size_t(t.height) * 4);
    tbb::parallel_for(0, t.height, [&](int y) {
        float* texel = &t.texels[std::size_t(y) * std::size_t(t.width) * 4];
        const double theta = (y + 0.5) / t.height * std::numbers::pi;
        for (int x = 0; x < t.width; ++x, texel += 4) {
            const double phi = ((x + 0.5) / t.width - 0.5) * 2 * std::numbers::pi;
            const Color c =
                radiance(Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
            texel[0] = c.r, texel[1] = c.g, texel[2] = c.b, texel[3] = 1;
        }
    });
}

/// Illuminance that the image, without its factor, gives a surface facing up (luminance times solid angle).
double illuminance_of(const EnvironmentRecord& t, bool faces_middle)
{
    double sum = 0;
    for (int y = 0; y < t.height; ++y) {
        const float* texel = &t.texels[std::size_t(y) * std::size_t(t.width) * 4];
        const double theta = (y + 0.5) / t.height * std::numbers::pi, sine = std::sin(theta);
        double row = 0;
        for (int x = 0; x < t.width; ++x, texel += 4) {
            // An equal-area image is centered on +z.
            const double phi = ((x + 0.5) / t.width - 0.5) * 2 * std::numbers::pi,
                         cosine = faces_middle ? sine * std::sin(phi) : std::cos(theta);
            row += std::max(0.0, cosine) * luminance(texel);
        }
        sum += sine * row;
    }
    return sum * 2 * std::numbers::pi * std::numbers::pi / (double(t.width) * t.height);
}

}  // namespace

void compile_environment(Compiler& c)
{
    const Environment& e = c.scene.environment;
    EnvironmentRecord& t = c.tables.environment;
    const bool has_picture =
        e.kind == EnvironmentKind::image || e.kind == EnvironmentKind::cube || e.kind == EnvironmentKind::equal_area;
    t.kind = std::uint32_t(has_picture ? EnvironmentKind::image : e.kind);
    t.color = {e.color.r, e.color.g, e.color.b};
    t.bottom = {e.bottom.r, e.bottom.g, e.bottom.b};
    t.top = {e.top.r, e.top.g, e.top.b};
    t.mean_luminance = 0;
    t.base_luminance = t.luminance_per_pdf = 0;
    t.environment_from_render = EnvironmentRecord().environment_from_render;
    // Images are in the tables already; data left from an earlier environment must not affect the scene's fingerprint.
    if (!has_picture) {
        t.texels.clear();
        t.width = t.height = 0;
    }
    if (e.kind == EnvironmentKind::none) return;
    const Transform inverse = e.world_from_environment.inverse();
    for (std::size_t i = 0; i < 9; ++i) t.environment_from_render[i] = float(inverse.m[i / 3][i % 3]);
    if (e.kind == EnvironmentKind::studio)
        make_picture(t, 256, [](const Vec3d& d) {
            const auto r = float(studio_radiance(d));
            return Color{r, r, r};
        });
    if (e.kind == EnvironmentKind::sky)
        make_picture(t, 256, [sky = Sky(e.to_sun), has_ground = e.sky_ground](const Vec3d& d) {
            return has_ground || d.y >= 0 ? sky.radiance(d) : Color{0, 0, 0};
        });
    if (e.kind == EnvironmentKind::hosek_wilkie)
        make_picture(t, 512, [sky = HosekSky(e.to_sun, e.turbidity, e.ground_albedo)](const Vec3d& d) {
            return sky.radiance(d);
        });
    if (has_picture && e.illuminance > 0 && t.width > 0)
        if (const double own = illuminance_of(t, e.kind == EnvironmentKind::equal_area); own > 0)
            for (float& factor : t.color) factor = float(double(factor) * e.illuminance / own);
    if (EnvironmentKind(t.kind) == EnvironmentKind::image && t.width > 0)
        t.mean_luminance = make_environment_distribution(t);
}

}  // namespace fathom
