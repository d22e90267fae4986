// SPDX-License-Identifier: Apache-2.0
#include "lights/kinds/curve_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

struct CurveCase {
    const char* name;
    std::uint32_t flags;
    std::uint32_t pieces;
    std::vector<Vec4f> points;
    bool placed;
    Vec3d eye;
    bool within = false;  ///< the viewpoint is closer to the axis than half the width
    /// Control points at time 1, if the curve moves.
    std::vector<Vec4f> then = {};
};
/// Time of all rays.
constexpr float now = 0.375f;
const std::vector<Vec4f> bow{
    {-1, 2, 0, 0.3f}, {-0.4f, 2.5f, 0.3f, 0.25f}, {0.4f, 2.2f, -0.4f, 0.15f}, {1, 2, 0.2f, 0.2f}};
const std::vector<Vec4f> rod{{-1, 1, 0, 0.2f}, {1, 1.3f, 0.5f, 0.35f}};
const std::vector<Vec4f> cone{{-0.2f, 1, 0, 0.9f}, {0.9f, 1.3f, 0.5f, 0.02f}};
constexpr std::uint32_t linear = ShapeRecord::linear_curves, ribbon = ShapeRecord::ribbons;
const std::vector<Vec4f> later{
    {-0.8f, 2.2f, 0.1f, 0.2f}, {-0.3f, 2.6f, 0.2f, 0.3f}, {0.5f, 2.1f, -0.3f, 0.2f}, {1.1f, 2.1f, 0.2f, 0.15f}};
const CurveCase forms[] = {{"bow", 0, 4, bow, false, {0.3, 0, 0.2}},
                           {"rod", linear, 1, rod, false, {0.1, 0.2, 0.3}},
                           {"rod from its end", linear, 1, rod, false, {3, 2.5, 1.5}},
                           {"cone that shows all round", linear, 1, cone, false, {4, 2.4, 2}},
                           {"placed rod", linear, 1, rod, true, {1, 1, 0.3}},
                           {"ribbon", ribbon | linear, 1, rod, false, {0.1, 0.2, 0.3}},
                           {"bent ribbon", ribbon, 4, bow, false, {0.3, 0, 0.2}},
                           {"placed ribbon", ribbon | linear, 1, rod, true, {1, 1, 0.3}},
                           {"ribbon with the eye in it", ribbon | linear, 1, rod, false, {0.3, 1.3, 0.35}, true},
                           {"bow that moves", 0, 4, bow, false, {0.3, 0, 0.2}, false, later},
                           {"placed ribbon that moves", ribbon, 4, bow, true, {4, 1, 0.3}, false, later}};

GeometryTables tables_of(const CurveCase& form)
{
    GeometryTables t;
    t.shapes.emplace_back().flags = form.flags;
    t.curve_points = form.points;
    t.curve_points.insert(t.curve_points.end(), form.then.begin(), form.then.end());
    if (!form.then.empty()) {
        t.shapes[0].moving_vertices = std::uint32_t(form.points.size());
        t.vertex_times = {0, 1};
    }
    t.curves.push_back({0, form.pieces, 0, 1});
    t.shape_of_primitive.push_back(0);
    InstanceRecord instance;
    // The instance scales by 2: render = 2 (object rotated by 90 degrees about y) + (1, 0, 0).
    instance.object_from_render = {0, 0, -0.5f, 0, 0, 0.5f, 0, 0, 0.5f, 0, 0, -0.5f};
    t.instances.push_back(instance);
    return t;
}

Vec3 as_lanes(Vec3d p)
{
    return Vec3(Vec3f{float(p.x), float(p.y), float(p.z)});
}

/// All curve pieces that a ray hits, by testing each.
class BruteForce {
public:
    BruteForce(const CurveCase& form, const GeometryTables& t)
        : form_(form), t_(t), curve_(t, UInt(0u), UInt(0u), UInt(form.flags), Float(now), Mask(true))
    {
    }
    /// Calls f(t, u, m) for each piece of the curve.
    template <class F>
    void for_each_hit(Vec3 o, Vec3 d, const F& f) const
    {
        if (form_.placed) {
            const Affine a = object_from_render(t_, UInt(0u), Float(0), Mask(true));
            o = a.point(o), d = a.vector(d);
            d = normalize(d);
        }
        for (std::uint32_t k = 0; k < form_.pieces; ++k) {
            const Float number{float(k)};
            const CurvePoint<Float> a = curve_.begin(number), b = curve_.end(number);
            const CurvePiece piece{{a.x, a.y, a.z}, {b.x, b.y, b.z}, a.r, b.r};
            Float t(0.f), w(0.f);
            const Mask m =
                form_.flags & ribbon
                    ? intersect_ribbon_piece({piece, curve_.tangent(number), curve_.tangent(number + Float(1))}, o, d,
                                             Float(infinity), t, w)
                    : intersect_round_piece(piece, o, d, Float(infinity), t, w);
            f(form_.placed ? t * Float(2) : t, (number + w) / curve_.pieces(), m);
        }
    }

private:
    const CurveCase& form_;
    const GeometryTables& t_;
    const CurveReader curve_;
};

UInt instance_of(const CurveCase& form)
{
    return UInt(form.placed ? 0u : no_index);
}

/// Each sample is a visible point of the surface, and pdf() of its direction returns its density.
TEST(CurveLight, SamplesAreHitsOfTheirDensity)
{
    for (const CurveCase& form : forms) {
        const GeometryTables t = tables_of(form);
        const CurveLight light(t, UInt(0u), instance_of(form), Float(now), Mask(true));
        const BruteForce force(form, t);
        const Vec3 eye = as_lanes(form.eye);
        test::Random random;
        int sampled = 0, missed = 0, wrong = 0;
        for (int n = 0; n < 20'000; n += lanes) {
            const CurveLight::Sample s = light.sample(eye, random.next2());
            Mask met(false);
            Float pdf(0.f);
            force.for_each_hit(eye, s.wi, [&](Float at, Float u, Mask m) {
                const Mask here =
                    m & (abs(at - s.distance) < Float(1e-3f) * s.distance) & (abs(u - s.u) < Float(2e-3f));
                met |= here;
                pdf = select(here, light.pdf(eye, s.wi, at, u), pdf);
            });
            const Mask counts = s.inverse_pdf > Float(0);
            sampled += count(counts);
            missed += count(counts & !met);
            wrong += count(counts & met & !(abs(pdf * s.inverse_pdf - Float(1)) < Float(0.02f)));
        }
        EXPECT_GT(sampled, 15'000) << form.name;
        // Grazing rays may miss, and their density changes quickly.
        EXPECT_LT(missed, 100) << form.name;
        EXPECT_LT(wrong, 200) << form.name;
    }
}

/// Histogram of sampled directions against the density along rays that hit the curve.
TEST(CurveLight, DirectionsFollowTheDensity)
{
    for (const CurveCase& form : forms) {
        // If the viewpoint is inside a curve's width, the density has poles that the numerical integral misses.
        if (form.within) continue;
        const GeometryTables t = tables_of(form);
        const CurveLight light(t, UInt(0u), instance_of(form), Float(now), Mask(true));
        const BruteForce force(form, t);
        const Vec3 eye = as_lanes(form.eye);
        // Cylindrical map of directions: azimuth about y, and height, over the range of the samples.
        constexpr int draws = 1 << 16, cells = 12, fine = 64, n = cells * fine;
        std::vector<std::pair<double, double>> places;
        double lo[2] = {1, 1}, hi[2] = {0, -1};
        std::size_t without = 0;
        test::Random random;
        for (int k = 0; k < draws; k += lanes) {
            const CurveLight::Sample s = light.sample(eye, random.next2());
            float y[lanes], turn[lanes], inverse[lanes];
            store(y, s.wi.y), store(turn, atan2(s.wi.z, s.wi.x) * Float(0.5f * inv_pi)), store(inverse, s.inverse_pdf);
            for (int lane = 0; lane < lanes; ++lane) {
                if (!(inverse[lane] > 0)) {
                    ++without;
                    continue;
                }
                const double at[2] = {turn[lane] < 0 ? turn[lane] + 1.0 : double(turn[lane]), double(y[lane])};
                places.emplace_back(at[0], at[1]);
                for (int c = 0; c < 2; ++c)
                    lo[c] = std::min(lo[c], at[c] - 1e-3), hi[c] = std::max(hi[c], at[c] + 1e-3);
            }
        }
        const double width[2] = {hi[0] - lo[0], hi[1] - lo[1]};
        std::vector<double> expected(cells * cells + 1), drawn(cells * cells + 1);
        for (const auto& [turn, y] : places)
            drawn[std::size_t(int((y - lo[1]) / width[1] * cells) * cells + int((turn - lo[0]) / width[0] * cells))] +=
                1;
        drawn.back() = double(without);
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; i += lanes) {
                const Float column = to_float(UInt(std::uint32_t(i)) + iota()) + Float(0.5f);
                const double y = std::clamp(lo[1] + width[1] * (j + 0.5) / n, -1.0, 1.0);
                const SinCos a = sincos_2pi(fma(column, Float(float(width[0] / n)), Float(float(lo[0]))));
                const Float r(float(std::sqrt(1 - y * y)));
                const Vec3 d{r * a.cos, Float(float(y)), r * a.sin};
                Float sum(0.f);
                force.for_each_hit(eye, d, [&](Float at, Float u, Mask m) {
                    sum = sum + select(m, light.pdf(eye, d, at, u), Float(0));
                });
                float all[lanes];
                store(all, sum);
                for (int k = 0; k < lanes; ++k)
                    expected[std::size_t(j / fine * cells + (i + k) / fine)] +=
                        double(all[k]) * 2 * std::numbers::pi * width[0] * width[1] / n / n;
            }
        double all = 0;
        // A fine grid of rays may miss a curve that covers only a corner of a cell.
        for (double& e : expected) all += e, e = std::max(e * draws, 0.01);
        EXPECT_LT(all, 1.01) << form.name;
        expected.back() = std::max(draws * (1 - all), 0.0);
        EXPECT_EQ(test::chi_square(drawn, expected), "") << form.name;
    }
}

}  // namespace
}  // namespace fathom
