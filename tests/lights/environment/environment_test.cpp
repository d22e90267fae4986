// SPDX-License-Identifier: Apache-2.0
#include "lights/environment/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

Vec3 lanes_of(Vec3d d)
{
    return Vec3(Vec3f{float(d.x), float(d.y), float(d.z)});
}

/// Direction of image coordinates (u, v) by the documentation: the center looks along +x, the top along +y, u increases
/// to the right as seen from inside.
Vec3d direction_of(double u, double v)
{
    const double phi = 2 * std::numbers::pi * (u - 0.5), theta = std::numbers::pi * v;
    // +z is to the right when looking along +x with y up.
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

/// Rotation about an axis (Rodrigues).
struct Turn {
    Vec3d axis;
    double angle;

    Vec3d vector(Vec3d v) const
    {
        const Vec3d a = normalize(axis);
        return v * std::cos(angle) + cross(a, v) * std::sin(angle) + a * (dot(a, v) * (1 - std::cos(angle)));
    }
    Turn inverse() const { return {axis, -angle}; }
    /// Sets environment_from_render.
    void put_into(EnvironmentRecord& e) const
    {
        const Vec3d x = vector({1, 0, 0}), y = vector({0, 1, 0}), z = vector({0, 0, 1});
        const double rows[9] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
        for (std::size_t i = 0; i < 9; ++i) e.environment_from_render[i] = float(rows[i]);
    }
};

/// An image with one bright texel and sampling tables without empty cells.
LightTables image_tables(int width, int height, int x, int y)
{
    LightTables tables;
    EnvironmentRecord& e = tables.environment;
    e.kind = std::uint32_t(EnvironmentKind::image);
    e.color = {1, 1, 1};
    e.light = 0;
    e.width = width, e.height = height;
    e.texels.assign(std::size_t(width) * std::size_t(height) * 4, 0);
    for (int c = 0; c < 3; ++c) e.texels[std::size_t(4 * (y * width + x) + c)] = float(c + 1);
    double total = 0;
    e.marginal = {0};
    std::vector<double> sums;
    for (int row = 0; row < height; ++row) {
        double in_row = 0;
        std::vector<double> cells;
        for (int column = 0; column < width; ++column) cells.push_back(in_row += 1 + (row * 7 + column * 5) % 11);
        e.conditional.push_back(0);
        for (double c : cells) e.conditional.push_back(float(c / in_row));
        sums.push_back(total += in_row);
    }
    for (double s : sums) e.marginal.push_back(float(s / total));
    e.marginal_guide = make_guides(e.marginal, height);
    e.conditional_guides = make_guides(e.conditional, width);
    tables.lights.emplace_back();
    return tables;
}

TEST(Environment, PointsOfTheImage)
{
    for (double u : {0.02, 0.25, 0.5, 0.6, 0.75, 0.98})
        for (double v : {0.01, 0.2, 0.5, 0.7, 0.99}) {
            const detail::ImagePoint at = detail::image_point(lanes_of(direction_of(u, v)));
            EXPECT_NEAR(first(at.u), u, 2e-5) << u << " " << v;
            EXPECT_NEAR(first(at.v), v, 2e-5) << u << " " << v;
        }
    // The directions are ahead, right and up.
    EXPECT_NEAR(first(detail::image_point(lanes_of({1, 0, 0})).u), 0.5, 1e-6);
    EXPECT_NEAR(first(detail::image_point(lanes_of({0, 0, 1})).u), 0.75, 1e-6);
    EXPECT_NEAR(first(detail::image_point(lanes_of({0, 1, 0})).v), 0, 1e-3);
}

TEST(Environment, ABrightTexelAppearsInItsDirection)
{
    constexpr int width = 16, height = 8;
    for (const auto& [x, y] : {std::pair{3, 2}, {8, 4}, {0, 6}, {15, 1}}) {
        LightTables tables = image_tables(width, height, x, y);
        tables.environment.color = {1, 10, 100};
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column) {
                const Spectrum seen = environment_radiance(
                    tables, lanes_of(direction_of((column + 0.5) / width, (row + 0.5) / height)), Mask(true));
                const bool here = row == y && column == x;
                EXPECT_NEAR(first(seen.c[0]), here ? 1 : 0, 1e-4);
                EXPECT_NEAR(first(seen.c[1]), here ? 20 : 0, 2e-3);
                EXPECT_NEAR(first(seen.c[2]), here ? 300 : 0, 3e-2);
            }
        // Halfway to the next column the value is half; the last column's neighbor is the first.
        const Spectrum between =
            environment_radiance(tables, lanes_of(direction_of((x + 1.0) / width, (y + 0.5) / height)), Mask(true));
        EXPECT_NEAR(first(between.c[0]), 0.5, 1e-4);
    }
}

/// environment_from_render maps directions of the scene to those of the image.
TEST(Environment, RotatesWithItsMatrix)
{
    LightTables tables = image_tables(16, 8, 11, 2);
    const Turn turn{{1, 2, 0.5}, 0.8};
    turn.put_into(tables.environment);
    const Vec3d bright = turn.inverse().vector(direction_of(11.5 / 16, 2.5 / 8));
    EXPECT_NEAR(first(environment_radiance(tables, lanes_of(bright), Mask(true)).c[0]), 1, 1e-4);
    // rotate_out() is the inverse of rotate_in().
    const Vec3 there = detail::rotate_in(tables.environment, lanes_of({0.36, 0.48, 0.8}));
    const Vec3 back = detail::rotate_out(tables.environment, there);
    EXPECT_NEAR(first(back.x), 0.36, 1e-6);
    EXPECT_NEAR(first(back.y), 0.48, 1e-6);
    EXPECT_NEAR(first(back.z), 0.8, 1e-6);

    tables.environment.kind = std::uint32_t(EnvironmentKind::gradient);
    tables.environment.bottom = {1, 2, 3}, tables.environment.top = {5, 4, 3};
    for (const Vec3d& d : {Vec3d{0, 1, 0}, {0, -1, 0}, {0.6, 0, 0.8}, {-0.48, 0.6, 0.64}}) {
        const double t = 0.5 + 0.5 * turn.vector(d).y;
        const Spectrum seen = environment_radiance(tables, lanes_of(d), Mask(true));
        EXPECT_NEAR(first(seen.c[0]), 1 + 4 * t, 1e-5);
        EXPECT_NEAR(first(seen.c[1]), 2 + 2 * t, 1e-5);
        EXPECT_NEAR(first(seen.c[2]), 3, 1e-5);
    }
    tables.environment.kind = std::uint32_t(EnvironmentKind::constant);
    tables.environment.color = {1, 2, 3};
    EXPECT_EQ(first(environment_radiance(tables, lanes_of({0, 0, 1}), Mask(true)).c[2]), 3);
}

TEST(Environment, SamplingFollowsTheDensityWhichIsThatOfTheTables)
{
    LightTables tables = image_tables(12, 10, 4, 4);
    const Turn turn{{0.3, -1, 0.5}, 2};
    turn.put_into(tables.environment);
    const auto pdf = [&](test::Direction d) {
        return double(first(environment_pdf(tables, lanes_of({d.x, d.y, d.z}))));
    };
    EXPECT_NEAR(test::integrate_sphere(pdf), 1, 3e-3);
    // The pdf at a cell's center is its probability over (u, v), divided by 2 pi^2 sin(theta) du dv.
    const EnvironmentRecord& e = tables.environment;
    for (const auto& [x, y] : {std::pair{0, 0}, {7, 3}, {11, 9}}) {
        const double share =
            (double(e.marginal[std::size_t(y) + 1]) - e.marginal[std::size_t(y)]) *
            (double(e.conditional[std::size_t(y * 13 + x + 1)]) - e.conditional[std::size_t(y * 13 + x)]);
        const double theta = std::numbers::pi * (y + 0.5) / 10;
        const Vec3d d = turn.inverse().vector(direction_of((x + 0.5) / 12, (y + 0.5) / 10));
        EXPECT_NEAR(pdf({d.x, d.y, d.z}) / (share * 120 / (2 * std::numbers::pi * std::numbers::pi * std::sin(theta))),
                    1, 1e-3);
    }

    tables.environment.base_luminance = 0.5f, tables.environment.luminance_per_pdf = 3;
    // Histogram of samples over cells of the image.
    std::vector<double> observed(120), expected(120);
    test::Random random;
    int drawn = 0, compared = 0;
    for (; drawn < 200000; drawn += lanes) {
        const EnvironmentSample s = sample_environment(tables, random.next2());
        const Float other = environment_pdf(tables, s.wi);
        const Spectrum sampled = environment_radiance(tables, s, Mask(true)),
                       seen = environment_radiance(tables, s.wi, Mask(true));
        float x[3][lanes], product[lanes], radiance[lanes], again[lanes], likely[lanes], inverse[lanes];
        store(x[0], s.wi.x), store(x[1], s.wi.y), store(x[2], s.wi.z);
        store(likely, s.likely * s.inverse_pdf), store(inverse, s.inverse_pdf);
        store(product, other * s.inverse_pdf), store(radiance, sampled.c[2]), store(again, seen.c[2]);
        for (int i = 0; i < lanes; ++i) {
            const Vec3d d = turn.vector({x[0][i], x[1][i], x[2][i]});
            ASSERT_NEAR(length(d), 1, 1e-5);
            const double u = std::atan2(d.z, d.x) / (2 * std::numbers::pi) + 0.5,
                         v = std::acos(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi;
            ++observed[std::size_t(std::clamp(int(v * 10), 0, 9) * 12 + std::clamp(int(u * 12), 0, 11))];
            // Directions are rounded: samples near a cell's edge may fall into its neighbor, and at the poles into any
            // cell.
            const double sine = std::hypot(d.x, d.z), rounding = 3e-6 / sine;
            const auto is_within = [&](double at) { return std::abs(at - std::round(at)) > rounding; };
            if (sine < 0.01 || !is_within(u * 12) || !is_within(v * 10)) continue;
            ++compared;
            ASSERT_NEAR(product[i], 1, rounding);
            ASSERT_NEAR(radiance[i], again[i], rounding);
            ASSERT_NEAR(likely[i], 0.5 * inverse[i] + 3, 1e-5 * (0.5 * inverse[i] + 3));
        }
    }
    for (std::size_t y = 0; y < 10; ++y)
        for (std::size_t x = 0; x < 12; ++x)
            expected[y * 12 + x] = drawn * (double(e.marginal[y + 1]) - e.marginal[y]) *
                                   (double(e.conditional[y * 13 + x + 1]) - e.conditional[y * 13 + x]);
    EXPECT_GT(compared, 0.99 * drawn);
    EXPECT_EQ(test::chi_square(observed, expected), "");
}

TEST(Environment, IsNotSampledUnlessItIsALight)
{
    LightTables tables = image_tables(4, 2, 1, 1);
    tables.environment.light = no_index;
    EXPECT_EQ(first(environment_pdf(tables, lanes_of({0, 0.6, 0.8}))), 0);
    tables.environment.light = 0;
    tables.environment.kind = std::uint32_t(EnvironmentKind::constant);
    EXPECT_EQ(first(environment_pdf(tables, lanes_of({0, 0.6, 0.8}))), 0);
}

/// Interval lookup in a cumulative table agrees with a linear search, also with empty intervals.
TEST(Environment, IntervalsOfATable)
{
    for (int n : {1, 2, 3, 7, 64, 100}) {
        std::vector<float> table{0};
        for (int i = 0; i < n; ++i) table.push_back(table.back() + (i % 3 == 1 ? 0.f : float(i % 5 + 1)));
        for (float& v : table) v /= table.back();
        for (int k = 0; k < 200; ++k) {
            const float x = float(k) / 200;
            int expected = 0;
            while (expected + 1 < n && table[std::size_t(expected) + 1] <= x) ++expected;
            const auto found = int(first(find_interval(table.data(), UInt(0u), n, Float(x))));
            EXPECT_EQ(found, expected) << n << " " << x;
        }
    }
}

/// A guide table only accelerates the search: equal results also at the ends of its entries and in the second of two
/// tables.
TEST(Environment, GuidesFindWhatASearchFinds)
{
    for (int n : {1, 2, 5, 64, 1000}) {
        LargeVector<float> tables;
        for (int table = 0; table < 2; ++table) {
            double sum = 0;
            std::vector<double> sums{0};
            for (int i = 0; i < n; ++i) sums.push_back(sum += i % 3 == 1 ? 0 : std::pow((i * 7 + table) % 11 + 1, 6));
            for (double s : sums) tables.push_back(float(s / sum));
        }
        const auto guides = make_guides(tables, n);
        const float* second = &tables[std::size_t(n) + 1];
        std::vector<float> numbers(second, second + n);
        for (std::uint32_t k = 0; k < guide_size(n); ++k) numbers.push_back(float(k) / float(guide_size(n)));
        for (float at : std::vector(numbers))
            for (float x : {std::nextafter(at, 0.f), std::nextafter(at, 1.f)}) numbers.push_back(x);
        for (float x : numbers) {
            if (x >= 1) continue;
            const GuidedInterval found = find_guided(tables, guides, n, UInt(1u), Float(x));
            const UInt expected = find_interval(tables.data(), UInt(std::uint32_t(n) + 1), n, Float(x));
            ASSERT_EQ(first(found.number), first(expected)) << n << " " << x;
            EXPECT_EQ(first(found.begin), second[first(expected)]);
            EXPECT_EQ(first(found.end), second[first(expected) + 1]);
        }
    }
}

/// u times the guide's size may round up to the size: numbers just below 1 must stay in the last interval of their own
/// table.
TEST(Environment, GuidesEndWhereTheirTableEnds)
{
    for (const int n : {1, 2, 4, 5, 64, 1000, 3000}) {
        LargeVector<float> tables;
        for (int table = 0; table < 2; ++table)
            for (int i = 0; i <= n; ++i) tables.push_back(float(i) / float(n));
        const auto guides = make_guides(tables, n);
        for (const float x : {1.f, std::nextafter(1.f, 0.f)}) {
            EXPECT_EQ(first(guide_entry(n, Float(x))), guide_size(n) - 1) << n;
            const GuidedInterval found = find_guided(tables, guides, n, UInt(0u), Float(x));
            EXPECT_EQ(first(found.number), std::uint32_t(n) - 1) << n;
            EXPECT_EQ(first(found.end), 1) << n;
            EXPECT_EQ(first(find_interval(tables.data(), UInt(0u), n, Float(x))), std::uint32_t(n) - 1) << n;
        }
        // Guide entries have no gaps or overlaps: each starts where the previous one ends.
        for (std::uint32_t k = 0; k < guide_size(n); ++k) {
            const float middle = (float(k) + 0.5f) / float(guide_size(n));
            EXPECT_EQ(first(guide_entry(n, Float(middle))), k) << n;
        }
    }
}

}  // namespace
}  // namespace fathom
