// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lookup and sampling of the tables of measured surfaces, for all lanes.
#include "materials/closures/closure.h"
#include "sampling/sobol.h"

namespace fathom {
inline namespace FATHOM_LANES {

inline UInt min_of(UInt a, UInt b)
{
    return select(less(a, b), a, b);
}

/// Largest index below `count` whose value is at most x, for ascending values; 0 if there is none. Binary search.
template <class ValueOf>
UInt last_up_to(UInt count, Float x, ValueOf&& value_of)
{
    UInt lo(0u), hi = count - UInt(1u);
    for (Mask open = less(lo, hi); any(open); open = less(lo, hi)) {
        const UInt middle = (lo + hi + UInt(1u)) >> 1;
        const Mask right = value_of(middle) <= x;
        lo = select(open & right, middle, lo);
        hi = select(open & !right, middle - UInt(1u), hi);
    }
    return lo;
}

/// The four tables of a surface around a direction in theta and phi, with their weights for linear interpolation.
struct MeasuredSlices {
    UInt number[4], count;  ///< indices of the tables; count: number of all tables of the surface
    Float weight[4];
    int used;  ///< number of entries in use: 2 if no lane depends on phi, else 4

    MeasuredSlices(const MeasuredPoint& m, Float theta, Float phi)
    {
        const Between by_theta(m.values, m.theta, m.theta_count, theta), by_phi(m.values, m.phi, m.phi_count, phi);
        count = m.theta_count * m.phi_count;
        used = m.has_phis ? 4 : 2;
        for (int k = 0; k < 4; ++k) {
            const UInt row = k & 2 ? by_phi.above : by_phi.below, column = k & 1 ? by_theta.above : by_theta.below;
            number[k] = row * m.theta_count + column;
            weight[k] =
                (k & 1 ? by_theta.share : Float(1) - by_theta.share) * (k & 2 ? by_phi.share : Float(1) - by_phi.share);
        }
    }

    /// Weighted sum of f(index of a table) over the tables in use.
    template <class F>
    [[gnu::always_inline]] Float mixed(F&& f) const
    {
        Float sum = weight[0] * f(number[0]);
        for (int k = 1; k < used; ++k) sum = fma(weight[k], f(number[k]), sum);
        return sum;
    }

private:
    /// Linear interpolation between two entries of an ascending array.
    struct Between {
        UInt below, above;
        Float share;  ///< weight of `above`

        Between(const float* values, UInt first, UInt count, Float x)
        {
            const UInt last = count - UInt(1u);
            const UInt intervals = select(last == UInt(0u), UInt(1u), last);
            below = last_up_to(intervals, x, [&](UInt i) { return gather(values, first + i); });
            above = min_of(below + UInt(1u), last);
            const Float a = gather(values, first + below), b = gather(values, first + above);
            share = select(b > a, clamp((x - a) / (b - a), Float(0), Float(1)), Float(0));
        }
    };
};

/// Cell of a table that contains a point of the unit square: index of its first value, and position in the cell.
struct MeasuredCell {
    UInt column, row;
    Float x, y;

    MeasuredCell(const MeasuredTablePoint& table, Float u, Float v)
    {
        along(table.width, u, column, x);
        along(table.height, v, row, y);
    }

private:
    static void along(UInt size, Float u, UInt& cell, Float& rest)
    {
        const UInt last = size - UInt(1u);
        const Float at = clamp(u, Float(0), Float(1)) * to_float(last);
        cell = min_of(to_uint(at), last - UInt(1u));
        rest = at - to_float(cell);
    }
};

/// Bilinear interpolation between a cell's four values; first: index of the table's first value.
[[gnu::always_inline]] inline Float measured_value(const float* values, UInt first, UInt width,
                                                   const MeasuredCell& cell)
{
    const UInt at = first + cell.row * width + cell.column;
    Float below[2], above[2];
    gather_row(values, at, below), gather_row(values, at + width, above);
    const Float a = fma(cell.x, below[1] - below[0], below[0]), b = fma(cell.x, above[1] - above[0], above[0]);
    return fma(cell.y, b - a, a);
}
[[gnu::always_inline]] inline Float measured_value(const float* values, const MeasuredTablePoint& table, Float u,
                                                   Float v)
{
    return measured_value(values, table.first, table.width, MeasuredCell(table, u, v));
}

/// Sampling of the unit square by densities that are bilinear between table values: see add_measured_warps.
class MeasuredWarp {
public:
    struct Place {
        Float u, v, density;
    };

    MeasuredWarp(const float* values, const MeasuredTablePoint& table, const MeasuredSlices& slices)
        : values_(values), table_(table), slices_(slices), size_(table.width * table.height)
    {
    }

    Float density(Float u, Float v) const { return density(MeasuredCell(table_, u, v)); }

    /// Maps a uniform point of the square to a point distributed by the density.
    Place sample(Float at_u, Float at_v) const
    {
        const UInt last_row = table_.height - UInt(1u), last_column = table_.width - UInt(1u);
        MeasuredCell cell(table_, Float(0), Float(0));
        cell.row = last_up_to(last_row, at_v, [&](UInt row) { return up_to_row(row); });
        const Float row_a = row_integral(cell.row), row_b = row_integral(cell.row + UInt(1u));
        cell.y = place_in(at_v - up_to_row(cell.row), row_a, row_b);
        const Float along = at_u * fma(cell.y, row_b - row_a, row_a);
        const auto sum_to = [&](UInt column) { return up_to_column(cell.row, column, cell.y); };
        cell.column = last_up_to(last_column, along, sum_to);
        Float a, b;
        column_densities(cell, a, b);
        cell.x = place_in(along - sum_to(cell.column), a, b);
        return {(to_float(cell.column) + cell.x) / to_float(last_column),
                (to_float(cell.row) + cell.y) / to_float(last_row),
                fma(cell.x, b - a, a) * to_float(last_row * last_column)};
    }

    /// Inverse of sample: the uniform point that sample maps to (u, v).
    Place invert(Float u, Float v) const
    {
        const MeasuredCell cell(table_, u, v);
        const Float row_a = row_integral(cell.row), row_b = row_integral(cell.row + UInt(1u));
        const Float whole = fma(cell.y, row_b - row_a, row_a);
        Float a, b;
        column_densities(cell, a, b);
        const Float along = up_to_column(cell.row, cell.column, cell.y) + integral_to(cell.x, a, b);
        return {select(whole > Float(0), along / whole, Float(0)),
                up_to_row(cell.row) + integral_to(cell.y, row_a, row_b),
                fma(cell.x, b - a, a) * to_float((table_.height - UInt(1u)) * (table_.width - UInt(1u)))};
    }

private:
    /// Integral from 0 to x of the linear function from a (at 0) to b (at 1).
    static Float integral_to(Float x, Float a, Float b) { return x * fma(x * Float(0.5f), b - a, a); }
    /// Inverse of integral_to: solves a x + (b - a) x^2 / 2 = part without cancellation.
    static Float place_in(Float part, Float a, Float b)
    {
        const Float root = a + sqrt(max(fma(Float(2) * part, b - a, a * a), Float(0)));
        return select(root > Float(0), clamp(Float(2) * part / root, Float(0), Float(1)), Float(0));
    }

    Float density(const MeasuredCell& cell) const
    {
        const UInt cells = (table_.height - UInt(1u)) * (table_.width - UInt(1u));
        return to_float(cells) * slices_.mixed([&](UInt slice) {
            return measured_value(values_, table_.first + slice * size_, table_.width, cell);
        });
    }
    /// Densities at a cell's left and right column, at the cell's height y.
    void column_densities(const MeasuredCell& cell, Float& a, Float& b) const
    {
        const UInt at = table_.first + cell.row * table_.width + cell.column;
        for (int k = 0; k < slices_.used; ++k) {
            Float below[2], above[2];
            const UInt in_slice = at + slices_.number[k] * size_;
            gather_row(values_, in_slice, below), gather_row(values_, in_slice + table_.width, above);
            const Float w = slices_.weight[k];
            const Float left = fma(cell.y, above[0] - below[0], below[0]),
                        right = fma(cell.y, above[1] - below[1], below[1]);
            a = k == 0 ? w * left : fma(w, left, a);
            b = k == 0 ? w * right : fma(w, right, b);
        }
    }
    Float up_to_column(UInt row, UInt column, Float y) const
    {
        const UInt at = table_.first + slices_.count * size_ + row * table_.width + column;
        return slices_.mixed([&](UInt slice) {
            const Float below = gather(values_, at + slice * size_),
                        above = gather(values_, at + slice * size_ + table_.width);
            return fma(y, above - below, below);
        });
    }
    Float row_integral(UInt row) const
    {
        const UInt at = table_.first + slices_.count * size_ + row * table_.width + table_.width - UInt(1u);
        return slices_.mixed([&](UInt slice) { return gather(values_, at + slice * size_); });
    }
    Float up_to_row(UInt row) const
    {
        const UInt at = table_.first + slices_.count * size_ * UInt(2u) + row;
        return slices_.mixed([&](UInt slice) { return gather(values_, at + slice * table_.height); });
    }

    const float* values_;
    const MeasuredTablePoint& table_;
    const MeasuredSlices& slices_;
    UInt size_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
