// SPDX-License-Identifier: Apache-2.0
#include "scene/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom {

namespace {

/// Largest value of a table, so that products of a few values don't overflow a float, and its largest width.
constexpr float largest_value = 1e10f;
constexpr int widest = 1 << 12;

std::string problem_of_angles(const char* name, const std::vector<float>& angles)
{
    if (angles.empty()) return fmt::format("'{}': there are no angles", name);
    for (std::size_t i = 0; i < angles.size(); ++i) {
        if (!(std::abs(angles[i]) <= 10)) return fmt::format("'{}': {:g} is not an angle in radians", name, angles[i]);
        if (i > 0 && !(angles[i - 1] < angles[i])) return fmt::format("'{}': angles must increase", name);
    }
    return {};
}

/// Checks a table's size and values.
///
/// count  number of slices
/// least  smallest valid value
std::string problem_of_table(const char* name, const MeasuredTable& table, double count, float least)
{
    if (table.width < 2 || table.height < 2 || table.width > widest || table.height > widest)
        return fmt::format("'{}': a table of {} by {} values: 2 to {} are supported along each axis", name, table.width,
                           table.height, widest);
    const double wanted = count * double(table.width) * double(table.height);
    if (double(table.values.size()) != wanted)
        return fmt::format("'{}': {} values, expected {:.0f}", name, table.values.size(), wanted);
    const auto is_wrong = [&](float x) { return !(x >= least && x <= largest_value); };
    const auto wrong = std::find_if(table.values.begin(), table.values.end(), is_wrong);
    if (wrong == table.values.end()) return {};
    return fmt::format("'{}': the value {:g} can't be rendered", name, *wrong);
}

}  // namespace

std::string problem_of(const MeasuredBrdf& brdf)
{
    for (const auto& [name, angles] : {std::pair{"theta_i", &brdf.theta}, std::pair{"phi_i", &brdf.phi}})
        if (std::string problem = problem_of_angles(name, *angles); !problem.empty()) return problem;
    const double slices = double(brdf.theta.size()) * double(brdf.phi.size());
    struct Part {
        const char* name;
        const MeasuredTable& table;
        double count;
        float least;
    };
    // Colors outside the sRGB gamut have negative channels.
    for (const Part& part :
         {Part{"ndf", brdf.ndf, 1, 0}, Part{"sigma", brdf.sigma, 1, 0}, Part{"vndf", brdf.vndf, slices, 0},
          Part{"luminance", brdf.luminance, slices, 0}, Part{"rgb", brdf.color, 3 * slices, -largest_value}})
        if (std::string problem = problem_of_table(part.name, part.table, part.count, part.least); !problem.empty())
            return problem;
    return {};
}

Color reflectance_of(const MeasuredBrdf& brdf)
{
    // Samples that are uniform in the unit square of the vndf warp have uniform reflected density where masking is
    // absent, so the mean of the colors over the square approximates the reflectance.
    const auto distance = [](float theta) { return std::abs(theta - float(std::numbers::pi / 4)); };
    const auto nearest = std::min_element(brdf.theta.begin(), brdf.theta.end(),
                                          [&](float a, float b) { return distance(a) < distance(b); });
    const std::size_t theta = std::size_t(nearest - brdf.theta.begin());
    const std::size_t size = std::size_t(brdf.color.width) * std::size_t(brdf.color.height);
    double sum[3] = {};
    for (std::size_t phi = 0; phi < brdf.phi.size(); ++phi)
        for (std::size_t c = 0; c < 3; ++c) {
            const float* table = &brdf.color.values[(3 * (phi * brdf.theta.size() + theta) + c) * size];
            for (std::size_t i = 0; i < size; ++i) sum[c] += double(table[i]);
        }
    const auto channel = [&](std::size_t c) {
        return float(std::clamp(sum[c] / double(size * brdf.phi.size()), 0.0, 1.0));
    };
    return {channel(0), channel(1), channel(2)};
}

}  // namespace fathom
