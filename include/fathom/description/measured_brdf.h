// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace fathom {

/// One or more tables of values over the unit square, stored one after the other. Values are at regularly spaced points
/// that include the edges, with bilinear interpolation between them. v grows from row to row, u within a row.
struct MeasuredTable {
    int width = 0, height = 0;  ///< Number of values along u and v, 2 to 4096.
    std::vector<float> values;  ///< width * height values for each table.
};

/// A measured BRDF in the representation of the RGL material database: J. Dupuy and W. Jakob 2018, "An Adaptive
/// Parameterization for Efficient Material Acquisition and Rendering".
///
/// Directions are points (u, v) of the unit square: u is the square root of theta / (pi / 2), and v goes from 0 to 1 as
/// phi goes from -pi to pi. Tables for several incident directions are ordered by phi, then theta.
struct MeasuredBrdf {
    std::string name;  ///< Name of the file it was read from.
    /// Angles of the incident directions that the tables are for, in radians and ascending order.
    std::vector<float> theta{0}, phi{0};
    /// Distribution of microfacet normals, and projected area of the microfacets by direction: one table each.
    MeasuredTable ndf, sigma;
    MeasuredTable vndf;  ///< Distribution of visible normals: a table for each incident direction.
    MeasuredTable
        luminance;        ///< Density for sampling, over the square that `vndf` maps to: a table for each direction.
    MeasuredTable color;  ///< Reflectance over the same square: three tables (R, G, B) for each incident direction.
    bool color_is_per_facet = true;  ///< The BRDF times the cosine is color * ndf / (4 sigma); otherwise it is color.

    /// Returns whether the BRDF is isotropic: phi of outgoing directions is then relative to the incident direction.
    bool is_isotropic() const { return phi.size() <= 2; }
};

}  // namespace fathom
