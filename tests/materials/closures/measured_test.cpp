// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/measured.h"

#include <functional>
#include <map>
#include <random>

#include "materials/closure_checks.h"
#include "materials/closures/measured_tables.h"

namespace fathom::test {
namespace {

constexpr double pi_double = std::numbers::pi;

/// An artificial measured BRDF: random values from 0.4 to 1 in tables of different sizes, with the given width around
/// the normal.
MeasuredBrdf surface(std::vector<float> phis, unsigned seed, double width = 0.4)
{
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(0.4, 1);
    MeasuredBrdf brdf;
    brdf.theta = {0, 0.5f, 1.1f, 1.5f};
    brdf.phi = std::move(phis);
    const std::size_t slices = brdf.theta.size() * brdf.phi.size();
    const auto fill = [&](MeasuredTable& t, int w, int h, std::size_t count,
                          const std::function<double(double)>& shape) {
        t.width = w, t.height = h;
        for (std::size_t i = 0; i < count * std::size_t(w * h); ++i)
            t.values.push_back(float(uniform(engine) * shape(double(i % std::size_t(w)) / (w - 1))));
    };
    const auto even = [](double) { return 1.0; };
    // The distribution is peaked like that of microfacets, with a width of about a cell of the table.
    const auto facets = [&](double u) { return std::exp(-u * u * u * u / (width * width)); };
    fill(brdf.ndf, 9, 6, 1, facets);
    fill(brdf.sigma, 5, 7, 1, even);
    fill(brdf.vndf, 12, 9, slices, [&](double u) { return u * std::sin(u * u * pi_double / 2) * facets(u); });
    fill(brdf.luminance, 6, 5, slices, even);
    fill(brdf.color, 7, 8, 3 * slices, even);
    return brdf;
}

const std::vector<float> all_phis = {-3.1415927f, -1.5f, 0.2f, 1.7f, 3.1415927f};
const std::vector<float> half_of_phis = {-3.1415927f, -2.2f, -1, 0},
                         quarter_of_phis = {-3.1415927f, -2.2f, -1.5707964f};

/// Owns the values that the closure refers to.
struct MeasuredSurface {
    MeasuredBrdf brdf;
    LargeVector<float> values = {7, 7, 7};  // values of other tables come first
    MeasuredMaterialPoint point;

    explicit MeasuredSurface(MeasuredBrdf b) : brdf(std::move(b))
    {
        const MeasuredRecord r = add_measured(brdf, values);
        point = material(0.5f, 0.5f);
        MeasuredPoint& m = point.measured;
        m.values = values.data();
        m.theta = UInt(r.theta), m.theta_count = UInt(r.theta_count);
        m.phi = UInt(r.phi), m.phi_count = UInt(r.phi_count), m.symmetry = UInt(r.symmetry);
        m.color_is_per_facet = Mask(r.color_is_per_facet != 0);
        const auto table = [](const MeasuredTableRecord& t) {
            return MeasuredTablePoint{UInt(t.first), UInt(t.width), UInt(t.height)};
        };
        m.ndf = table(r.ndf), m.sigma = table(r.sigma), m.vndf = table(r.vndf);
        m.luminance = table(r.luminance), m.color = table(r.color);
        m.has_phis = r.phi_count > 1;
        m.tangent = Vec3(Float(0), Float(0), Float(0)), m.facing = Float(1);
    }
    MeasuredBsdf bsdf() const { return MeasuredBsdf(point); }
};

/// The model in double precision from its definition, without tables of integrals or searches.
class Formula {
public:
    explicit Formula(const MeasuredBrdf& brdf) : b_(brdf) {}

    struct Result {
        double f_cos[3], pdf;
    };
    Result at(Direction wo, Direction wi) const
    {
        const auto angle_from = [](double x, double y, double from) {
            return std::remainder(std::atan2(y, x) - from, 2 * pi_double);
        };
        if (b_.phi.size() > 2) {
            const double turned = 2 * pi_double / double(b_.phi.back() - b_.phi.front());
            if (turned > 3) {
                if (wo.x > 0) wo.x = -wo.x, wi.x = -wi.x;
                if (wo.y > 0) wo.y = -wo.y, wi.y = -wi.y;
            } else if (turned > 1.5 && wo.y > 0) {
                wo.x = -wo.x, wi.x = -wi.x, wo.y = -wo.y, wi.y = -wi.y;
            }
        }
        const double sum[] = {wo.x + wi.x, wo.y + wi.y, wo.z + wi.z};
        const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        const double m[] = {sum[0] / length, sum[1] / length, sum[2] / length};
        const double phi_o = std::atan2(wo.y, wo.x), theta_o = std::acos(wo.z), theta_m = std::acos(m[2]);
        weigh(theta_o, phi_o);
        const double u = std::sqrt(theta_m / (pi_double / 2));
        const double v = angle_from(m[0], m[1], b_.phi.size() > 2 ? 0 : phi_o) / (2 * pi_double) + 0.5;
        const auto vndf = [&](double x, double y) { return density(b_.vndf, x, y); };
        // These are the integral below v, and the integral left of u in the row at v.
        const double even_v = integral(0, v, b_.vndf.height, [&](double y) { return row(y); });
        const double even_u = integral(0, u, b_.vndf.width, [&](double x) { return vndf(x, v); }) / row(v);
        const double d_theta = pi_double * u, d_phi = 2 * pi_double;
        Result r{};
        r.pdf = vndf(u, v) * density(b_.luminance, even_u, even_v) /
                (d_theta * d_phi * std::sin(theta_m) * 4 * (wo.x * m[0] + wo.y * m[1] + wo.z * m[2]));
        const double facets =
            bilinear(b_.ndf, 0, u, v) /
            (4 * bilinear(b_.sigma, 0, std::sqrt(theta_o / (pi_double / 2)), phi_o / (2 * pi_double) + 0.5));
        for (std::size_t c = 0; c < 3; ++c) {
            for (const auto& [slice, weight] : slices_)
                r.f_cos[c] += weight * bilinear(b_.color, 3 * slice + c, even_u, even_v);
            if (b_.color_is_per_facet) r.f_cos[c] *= facets;
        }
        return r;
    }

private:
    /// Computes indices and weights of the tables around the angles.
    void weigh(double theta, double phi) const
    {
        const auto around = [](const std::vector<float>& angles, double x) {
            std::vector<std::pair<std::size_t, double>> shares;
            if (angles.size() == 1 || x <= double(angles.front())) return shares = {{0, 1.0}};
            for (std::size_t i = 1; i < angles.size(); ++i) {
                const double a = double(angles[i - 1]), b = double(angles[i]);
                if (x > b) continue;
                return shares = {{i - 1, (b - x) / (b - a)}, {i, (x - a) / (b - a)}};
            }
            return shares = {{angles.size() - 1, 1.0}};
        };
        slices_.clear();
        for (const auto& [j, by_phi] : around(b_.phi, phi))
            for (const auto& [i, by_theta] : around(b_.theta, theta))
                slices_.emplace_back(j * b_.theta.size() + i, by_phi * by_theta);
    }
    static double bilinear(const MeasuredTable& t, std::size_t slice, double u, double v)
    {
        const double x = u * (t.width - 1), y = v * (t.height - 1);
        double sum = 0;
        for (int j = 0; j < t.height; ++j)
            for (int i = 0; i < t.width; ++i) {
                const int place = (int(slice) * t.height + j) * t.width + i;
                sum += std::max(0.0, 1 - std::abs(x - i)) * std::max(0.0, 1 - std::abs(y - j)) *
                       double(t.values[std::size_t(place)]);
            }
        return sum;
    }
    /// Integrates by Simpson's rule in each table cell, where f is linear.
    static double integral(double from, double to, int size, const std::function<double(double)>& f)
    {
        double sum = 0;
        for (int i = 0; i + 1 < size; ++i) {
            const double a = std::max(from, double(i) / (size - 1)), b = std::min(to, double(i + 1) / (size - 1));
            if (a < b) sum += (b - a) / 6 * (f(a) + 4 * f((a + b) / 2) + f(b));
        }
        return sum;
    }
    static double whole(const MeasuredTable& t, std::size_t slice)
    {
        return integral(0, 1, t.height, [&](double y) {
            return integral(0, 1, t.width, [&](double x) { return bilinear(t, slice, x, y); });
        });
    }
    double density(const MeasuredTable& t, double u, double v) const
    {
        double sum = 0;
        for (const auto& [slice, weight] : slices_) {
            const auto [found, is_new] = wholes_.try_emplace({&t, slice}, 0.0);
            if (is_new) found->second = whole(t, slice);
            sum += weight * bilinear(t, slice, u, v) / found->second;
        }
        return sum;
    }
    double row(double v) const
    {
        return integral(0, 1, b_.vndf.width, [&](double x) { return density(b_.vndf, x, v); });
    }

    const MeasuredBrdf& b_;
    mutable std::vector<std::pair<std::size_t, double>> slices_;
    mutable std::map<std::pair<const MeasuredTable*, std::size_t>, double> wholes_;
};

Direction direction(std::mt19937& engine)
{
    std::uniform_real_distribution<double> uniform;
    const double z = 0.02 + 0.97 * uniform(engine), phi = 2 * pi_double * uniform(engine), s = std::sqrt(1 - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

TEST(Measured, IsThePapersFormula)
{
    for (const auto& phis : {std::vector<float>{0}, std::vector<float>{-1, 2}, all_phis, half_of_phis, quarter_of_phis})
        for (const bool per_facet : {true, false}) {
            MeasuredBrdf brdf = surface(phis, unsigned(phis.size()), 2);
            brdf.color_is_per_facet = per_facet;
            const MeasuredSurface s(brdf);
            const Formula formula(s.brdf);
            std::mt19937 engine(7);
            for (int i = 0; i < 150; ++i) {
                const Direction wo = direction(engine), wi = direction(engine);
                SCOPED_TRACE(testing::Message() << phis.size() << " phis, " << wo.x << ' ' << wo.y << ' ' << wo.z
                                                << " to " << wi.x << ' ' << wi.y << ' ' << wi.z);
                const BsdfEval e = s.bsdf().eval(lane_direction(wo), lane_direction(wi));
                const Formula::Result r = formula.at(wo, wi);
                EXPECT_NEAR(first(e.pdf), r.pdf, 2e-4 * r.pdf);
                for (int c = 0; c < channels; ++c) EXPECT_NEAR(first(e.f_cos.c[c]), r.f_cos[c], 2e-4 * r.f_cos[c]);
            }
        }
}

TEST(Measured, SamplesByItsDensity)
{
    const std::pair<std::vector<float>, double> cases[] = {
        {{0}, 20}, {{0}, 70}, {all_phis, 50}, {half_of_phis, 40}, {quarter_of_phis, 60}};
    for (const auto& [phis, degrees] : cases)
        check_sampling(MeasuredSurface(surface(phis, 3, 0.6)).bsdf(), degrees, "measured");
}

/// The pdf is positive wherever f is.
TEST(Measured, SamplesAllThatIsReflected)
{
    for (const auto& phis : {std::vector<float>{0}, half_of_phis}) {
        const MeasuredSurface s(surface(phis, 5, 0.8));
        for (const double degrees : {10.0, 60.0}) {
            const Vec3 wo = outgoing(degrees);
            const double all = integrate_sphere(
                [&](Direction d) { return double(first(s.bsdf().eval(wo, lane_direction(d)).f_cos.c[0])); });
            EXPECT_NEAR(albedo_of(s.bsdf(), wo), all, 0.01 * all);
        }
    }
}

/// The BRDF rotates with the tangent; y is not mirrored on the back side.
TEST(Measured, LiesAlongTheTangent)
{
    const MeasuredBrdf brdf = surface(all_phis, 9, 2);
    MeasuredSurface plain(brdf), turned(brdf);
    const double angle = 0.7;
    turned.point.measured.tangent =
        Vec3(Float(float(3 * std::cos(angle))), Float(float(3 * std::sin(angle))), Float(0.5f));
    std::mt19937 engine(1);
    for (const double side : {1.0, -1.0}) {
        turned.point.measured.facing = Float(float(0.3 * side));
        for (int i = 0; i < 50; ++i) {
            const Direction wo = direction(engine), wi = direction(engine);
            // MeasuredSurface direction in the shading frame.
            const auto in_frame = [&](Direction d) {
                const double y = d.y * side;
                return lane_direction(
                    {d.x * std::cos(angle) - y * std::sin(angle), d.x * std::sin(angle) + y * std::cos(angle), d.z});
            };
            const double f = first(plain.bsdf().eval(lane_direction(wo), lane_direction(wi)).f_cos.c[1]);
            EXPECT_NEAR(first(turned.bsdf().eval(in_frame(wo), in_frame(wi)).f_cos.c[1]), f, 1e-4 * f);
            const Sample2 random{Float(float(i) / 50), Float(0.3f)};
            const Vec3 a = plain.bsdf().sample(lane_direction(wo), random, Float(0)).wi,
                       b = turned.bsdf().sample(in_frame(wo), random, Float(0)).wi,
                       expected = in_frame({first(a.x), first(a.y), first(a.z)});
            EXPECT_NEAR(first(b.x), first(expected.x), 1e-5);
            EXPECT_NEAR(first(b.y), first(expected.y), 1e-5);
        }
    }
}

/// Nothing is reflected below the surface, and all values are finite for any table.
TEST(Measured, StaysFinite)
{
    MeasuredBrdf brdf = surface({0}, 2);
    for (MeasuredTable* t : {&brdf.vndf, &brdf.luminance, &brdf.sigma}) t->values.assign(t->values.size(), 0);
    for (float& x : brdf.color.values) x -= 0.7f;  // colors outside the RGB gamut
    const MeasuredSurface s(brdf);
    std::mt19937 engine(4);
    for (int i = 0; i < 200; ++i) {
        const Direction wo = direction(engine), wi = direction(engine);
        const BsdfEval e = s.bsdf().eval(lane_direction(wo), lane_direction(i % 2 ? wi : wo));
        EXPECT_TRUE(std::isfinite(first(e.pdf)) && first(e.pdf) >= 0);
        for (const Float& f : e.f_cos.c) EXPECT_TRUE(std::isfinite(first(f)) && first(f) >= 0);
        const BsdfEval below = s.bsdf().eval(lane_direction(wo), lane_direction({wi.x, wi.y, -wi.z}));
        EXPECT_EQ(first(below.pdf), 0);
        EXPECT_EQ(first(below.f_cos.c[0]), 0);
    }
    draw(s.bsdf(), outgoing(30), 20000);
}

}  // namespace
}  // namespace fathom::test
