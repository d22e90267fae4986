// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tables of measured surfaces in the layout that MeasuredBsdf reads.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "base/large_memory.h"
#include "fathom/description.h"
#include "materials/records.h"

namespace fathom {

/// Appends tables to `values` in the form of MeasuredWarp: each as a density over the unit square, bilinear between
/// rows and columns; then, for all tables, the running integrals along rows; then the running integrals over whole
/// rows.
///
/// A table of zeros becomes uniform, since sampling needs a positive density somewhere.
inline MeasuredTableRecord add_measured_warps(const MeasuredTable& tables, LargeVector<float>& values)
{
    const std::size_t w = std::size_t(tables.width), h = std::size_t(tables.height), size = w * h,
                      count = tables.values.size() / size, first = values.size();
    const std::size_t along = first + count * size, up = along + count * size;
    values.resize(up + count * h);
    for (std::size_t table = 0; table < count; ++table) {
        const float* given = &tables.values[table * size];
        const auto row_integral = [&](std::size_t row) {
            double sum = 0;
            for (std::size_t i = 1; i < w; ++i)
                sum += 0.5 * (double(given[row * w + i - 1]) + double(given[row * w + i]));
            return sum;
        };
        double whole = 0;
        for (std::size_t row = 1; row < h; ++row) whole += 0.5 * (row_integral(row - 1) + row_integral(row));
        const double even = 1 / (double(w - 1) * double(h - 1));
        const auto density = [&](std::size_t i) { return whole > 0 ? double(given[i]) / whole : even; };
        double below = 0, last = 0;
        for (std::size_t row = 0; row < h; ++row) {
            double sum = 0;
            for (std::size_t i = 0; i < w; ++i) {
                const std::size_t at = row * w + i;
                if (i > 0) sum += 0.5 * (density(at - 1) + density(at));
                values[first + table * size + at] = float(density(at));
                values[along + table * size + at] = float(sum);
            }
            if (row > 0) below += 0.5 * (last + sum);
            last = sum;
            values[up + table * h + row] = row + 1 < h ? float(below) : 1;
        }
    }
    return {std::uint32_t(first), std::uint32_t(w), std::uint32_t(h)};
}

/// Appends tables to `values` unchanged.
inline MeasuredTableRecord add_measured_table(const MeasuredTable& tables, LargeVector<float>& values)
{
    const std::size_t first = values.size();
    values.insert(values.end(), tables.values.begin(), tables.values.end());
    return {std::uint32_t(first), std::uint32_t(tables.width), std::uint32_t(tables.height)};
}

/// Number of values that a measured surface takes in ShadingTables::measured_values.
inline double measured_value_count(const MeasuredBrdf& brdf)
{
    double count = double(brdf.theta.size()) + double(brdf.phi.size());
    for (const MeasuredTable* t : {&brdf.ndf, &brdf.sigma, &brdf.color}) count += double(t->values.size());
    for (const MeasuredTable* t : {&brdf.vndf, &brdf.luminance}) count += 3 * double(t->values.size());
    return count;
}

/// Appends the tables of a validated measured surface (scene/measured.h) to `values`, and returns its record.
inline MeasuredRecord add_measured(const MeasuredBrdf& brdf, LargeVector<float>& values)
{
    MeasuredRecord r;
    const auto add_angles = [&](const std::vector<float>& angles, std::uint32_t& first, std::uint32_t& count) {
        first = std::uint32_t(values.size()), count = std::uint32_t(angles.size());
        values.insert(values.end(), angles.begin(), angles.end());
    };
    add_angles(brdf.theta, r.theta, r.theta_count);
    add_angles(brdf.phi, r.phi, r.phi_count);
    if (!brdf.is_isotropic()) {
        const double turns = 2 * std::numbers::pi / double(brdf.phi.back() - brdf.phi.front());
        r.symmetry = turns > 3.5 ? 4 : turns > 1.5 ? 2 : 1;
    }
    r.color_is_per_facet = brdf.color_is_per_facet;
    r.ndf = add_measured_table(brdf.ndf, values);
    r.sigma = add_measured_table(brdf.sigma, values);
    r.vndf = add_measured_warps(brdf.vndf, values);
    r.luminance = add_measured_warps(brdf.luminance, values);
    r.color = add_measured_table(brdf.color, values);
    return r;
}

}  // namespace fathom
