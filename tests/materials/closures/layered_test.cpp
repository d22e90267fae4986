// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/layered.h"

#include <complex>

#include "integrate/stages/dispersion.h"
#include "materials/closure_checks.h"
#include "materials/closures/principled.h"

namespace fathom::test {
namespace {

Spectrum gray(float value)
{
    return Spectrum(Float(value));
}
void set(LayersPoint& l, LayersRecord::Features feature)
{
    l.features |= feature;
}

LayeredMaterialPoint layers(float color, float roughness, float metallic = 0, float ior = 1.5f)
{
    LayeredMaterialPoint m{material(color, roughness, metallic, ior), {}};
    LayersPoint& l = m.layers;
    set(l, LayersRecord::energy_compensation);
    l.transmission_color = l.diffuse_transmission_color = l.coat_color = l.sheen_color = gray(1);
    l.tangent = Vec3(Float(1), Float(0), Float(0));
    l.coat_normal = Vec3(Float(0), Float(0), Float(1));
    l.coat_f0 = Float(0.04f), l.coat_inner = Float(0.6f), l.coat_darkening = Float(0);
    l.sheen_roughness = Float(0.5f);
    l.thin_film_thickness = Float(400), l.thin_film_ior = Float(1.3f);
    return m;
}
LayeredMaterialPoint with_sheen(LayeredMaterialPoint m, float color, float roughness)
{
    set(m.layers, LayersRecord::with_sheen);
    m.layers.sheen_color = gray(color), m.layers.sheen_roughness = Float(roughness);
    return m;
}
LayeredMaterialPoint with_coat(LayeredMaterialPoint m, float coat, float roughness)
{
    set(m.layers, LayersRecord::with_coat);
    m.layers.coat = Float(coat), m.layers.coat_roughness = Float(roughness);
    return m;
}
LayeredMaterialPoint with_anisotropy(LayeredMaterialPoint m, float strength, double degrees)
{
    set(m.layers, LayersRecord::anisotropic);
    m.layers.anisotropy = Float(strength);
    const double a = degrees * std::numbers::pi / 180;
    m.layers.tangent = Vec3(Float(float(std::cos(a))), Float(float(std::sin(a))), Float(0));
    return m;
}
LayeredMaterialPoint with_transmission(LayeredMaterialPoint m, float share, bool thin, bool entering = true)
{
    set(m.layers, LayersRecord::with_transmission);
    m.layers.transmission = Float(share);
    m.thin = Mask(thin), m.entering = Mask(entering);
    return m;
}
LayeredMaterialPoint with_diffuse_transmission(LayeredMaterialPoint m, float share)
{
    set(m.layers, LayersRecord::with_diffuse_transmission);
    m.layers.diffuse_transmission = Float(share);
    return m;
}
LayeredMaterialPoint with_film(LayeredMaterialPoint m, float share)
{
    set(m.layers, LayersRecord::with_thin_film);
    m.layers.thin_film = Float(share);
    return m;
}
LayeredMaterialPoint with_rough_diffuse(LayeredMaterialPoint m)
{
    set(m.layers, LayersRecord::rough_diffuse);
    m.layers.diffuse_roughness = Float(0.6f);
    return m;
}
LayeredMaterialPoint with_all(LayeredMaterialPoint m)
{
    m = with_coat(with_sheen(with_anisotropy(m, 0.6f, 30), 0.4f, 0.4f), 0.7f, 0.35f);
    m.layers.coat_normal = normalize(Vec3(Float(0.1f), Float(-0.15f), Float(1)));
    return with_film(with_rough_diffuse(m), 0.5f);
}

using Opaque = LayeredBsdf<false>;
using Passing = LayeredBsdf<true>;

TEST(Layered, SamplingAgreesWithItsDensity)
{
    for (const double degrees : {20.0, 75.0}) {
        check_sampling(Opaque(with_all(layers(0.6f, 0.5f, 0.5f))), degrees, "all");
        LayeredMaterialPoint m = with_diffuse_transmission(with_anisotropy(layers(0.6f, 0.5f), 0.5f, 30), 0.4f);
        check_sampling(Passing(with_transmission(m, 0.6f, true)), degrees, "a sheet");
        m = with_sheen(with_coat(m, 0.7f, 0.4f), 0.4f, 0.5f);
        check_sampling(Passing(with_transmission(m, 0.5f, false)), degrees, "a solid, from outside");
        check_sampling(Passing(with_transmission(m, 0.5f, false, false)), degrees, "a solid, from within");
    }
}

/// Albedo, with the eta^2 scaling of radiance undone, and its standard error.
template <class Bsdf>
std::pair<double, double> unscaled_albedo(const Bsdf& bsdf, double degrees, int n = 12000)
{
    Random random;
    double sum = 0, squares = 0;
    int count = 0;
    for (; count < n; count += lanes) {
        float weight[lanes];
        const BsdfSample s = bsdf.sample(outgoing(degrees), random.next2(), random.next());
        store(weight, s.weight.c[0] * s.eta * s.eta);
        for (const float w : weight) sum += w, squares += double(w) * w;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

template <class Bsdf>
void expect_white(const LayeredMaterialPoint& m, const char* what)
{
    for (const double degrees : {0.0, 50.0, 80.0}) {
        const auto [albedo, error] = unscaled_albedo(Bsdf(m), degrees);
        EXPECT_NEAR(albedo, 1, 0.005 + 4 * error) << what << " at " << degrees;
    }
}

/// White furnace with a wider tolerance for refracting boundaries, whose light for the diffuse base is approximate.
void expect_nearly_white(const LayeredMaterialPoint& m, const char* what)
{
    for (const double degrees : {0.0, 50.0, 80.0}) {
        const auto [albedo, error] = unscaled_albedo(Passing(m), degrees);
        EXPECT_NEAR(albedo, 1, 0.02 + 4 * error) << what << " at " << degrees;
    }
}

/// White layers are lossless in any combination.
TEST(Layered, WhiteFurnace)
{
    for (const float roughness : {0.0f, 0.3f, 1.0f})
        for (const float metallic : {0.0f, 0.5f}) {
            const LayeredMaterialPoint m = layers(1, roughness, metallic);
            expect_white<Opaque>(m, "nothing more");
            expect_white<Opaque>(with_rough_diffuse(m), "rough diffuse");
            expect_white<Opaque>(with_coat(m, 1, 0), "smooth coat");
            expect_white<Opaque>(with_coat(m, 0.5f, 0.1f), "half a coat");
            for (const float r : {0.2f, 0.5f, 1.0f}) expect_white<Opaque>(with_sheen(m, 1, r), "sheen");
            expect_white<Passing>(with_diffuse_transmission(m, 0.4f), "diffuse transmission");
        }
    for (const float share : {0.3f, 1.0f}) {
        for (const bool thin : {false, true}) {
            const char* const what = thin ? "thin transmission" : "transmission";
            expect_white<Passing>(with_transmission(layers(1, 0.05f), share, thin), what);
            expect_nearly_white(with_transmission(layers(1, 0.5f), share, thin), what);
            expect_nearly_white(with_transmission(layers(1, 1), share, thin), what);
        }
    }
    LayeredMaterialPoint m = layers(1, 0.4f);
    m.layers.specular = Float(0.3f);
    expect_white<Opaque>(m, "less specular");
    m.layers.specular = Float(1), m.layers.specular_color = gray(5);
    expect_white<Opaque>(m, "more specular");
}

/// A path inside a solid loses nothing at its rough boundary, whatever transmission the outside has.
TEST(Layered, WhiteFromWithin)
{
    for (const float roughness : {0.1f, 0.5f, 1.0f})
        for (const float share : {0.3f, 1.0f})
            expect_white<Passing>(with_transmission(layers(1, roughness), share, false, false), "from within");
}

/// No combination of layers creates energy.
TEST(Layered, ConservesEnergy)
{
    for (const double degrees : {0.0, 70.0, 85.0})
        for (const float roughness : {0.0f, 0.3f, 1.0f})
            for (const float metallic : {0.0f, 1.0f}) {
                const auto check = [&](const auto& bsdf, const char* what) {
                    const auto [albedo, error] = unscaled_albedo(bsdf, degrees, 6000);
                    EXPECT_LT(albedo, 1.005 + 4 * error)
                        << what << " at " << degrees << ", roughness " << roughness << ", metallic " << metallic;
                };
                check(Opaque(with_all(layers(1, roughness, metallic))), "all");
                check(Opaque(with_film(layers(1, roughness, metallic), 1)), "film");
                check(Opaque(with_anisotropy(layers(1, roughness, metallic), 1, 20)), "anisotropy");
                check(Passing(with_all(with_transmission(layers(1, roughness, metallic), 0.5f, false))), "solid");
                check(Passing(with_transmission(layers(1, roughness, metallic), 0.5f, false, false)), "from within");
                check(Passing(with_transmission(layers(1, roughness, metallic), 1, true)), "sheet");
            }
}

/// Without additional layers, the closure equals principled.
TEST(Layered, MatchesPrincipledWithoutExtraLayers)
{
    Random random(4);
    for (const float metallic : {0.0f, 0.3f, 1.0f})
        for (int i = 0; i < 200; ++i) {
            const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
            const LayeredMaterialPoint m = layers(0.7f, 0.3f, metallic);
            const float expected = first(PrincipledBsdf(m).eval(wo, wi).f_cos.c[0]);
            EXPECT_NEAR(first(Opaque(m).eval(wo, wi).f_cos.c[0]), expected, 2e-4f * expected + 1e-6f);
        }
}
/// With full transmission, the closure equals glass.
TEST(Layered, IsGlassWhereAllIsRefracted)
{
    Random random(5);
    for (const bool entering : {true, false})
        for (int i = 0; i < 400; ++i) {
            const LayeredMaterialPoint m = with_transmission(layers(1, 0.5f), 1, false, entering);
            const Vec3 wo = sample_cosine_hemisphere(random.next2());
            Vec3 wi = sample_cosine_hemisphere(random.next2());
            if (i % 2) wi.z = -wi.z;
            const float expected = first(GlassBsdf(CommonPoint{m}).eval(wo, wi).f_cos.c[0]);
            EXPECT_NEAR(first(Passing(m).eval(wo, wi).f_cos.c[0]), expected, 1e-3f * expected + 1e-5f) << i;
        }
}

/// A 3D vector of doubles.
struct V {
    double x, y, z;
};
double dot(V a, V b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
V unit(V a)
{
    const double n = std::sqrt(dot(a, a));
    return {a.x / n, a.y / n, a.z / n};
}
V v_of(Vec3 a)
{
    return {first(a.x), first(a.y), first(a.z)};
}

/// Anisotropic GGX follows the formulas of KHR_materials_anisotropy, with a rotated tangent.
TEST(Layered, AnisotropyFollowsItsFormula)
{
    const double roughness = 0.4, strength = 0.7, angle = 25 * std::numbers::pi / 180;
    const double at = roughness * roughness * (1 - strength * strength) + strength * strength,
                 ab = roughness * roughness;
    LayeredMaterialPoint m = with_anisotropy(layers(0.5f, float(roughness), 1), float(strength), 25);
    m.layers.compensation = Float(0);
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
        const V o = v_of(wo), l = v_of(wi), h = unit({o.x + l.x, o.y + l.y, o.z + l.z});
        const V t{std::cos(angle), std::sin(angle), 0}, b{-std::sin(angle), std::cos(angle), 0};
        const double th = dot(t, h), bh = dot(b, h), s = th * th / (at * at) + bh * bh / (ab * ab) + h.z * h.z;
        const double d = 1 / (std::numbers::pi * at * ab * s * s);
        const auto far = [&](V w, double other) {
            return other * std::sqrt(std::pow(at * dot(t, w), 2) + std::pow(ab * dot(b, w), 2) + w.z * w.z);
        };
        const double visibility = 0.5 / (far(o, l.z) + far(l, o.z));
        const double f = 0.5 + 0.5 * std::pow(1 - dot(o, h), 5);
        const double expected = f * d * visibility * l.z;
        EXPECT_NEAR(first(Opaque(m).eval(wo, wi).f_cos.c[0]), expected, 1e-3 * expected + 1e-6);
    }
}

/// Sheen follows the formulas of KHR_materials_sheen, and so does its scaling of the base.
TEST(Layered, SheenFollowsItsFormula)
{
    const double roughness = 0.45, alpha = roughness * roughness;
    LayeredMaterialPoint m = with_sheen(layers(0, float(roughness), 1), 0.6f, float(roughness));
    set(m.layers, LayersRecord::sheen_reciprocal);
    const SheenLobe lobe{Float(float(roughness))};
    Random random(7);
    for (int i = 0; i < 100; ++i) {
        const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
        const V o = v_of(wo), l = v_of(wi), h = unit({o.x + l.x, o.y + l.y, o.z + l.z});
        const double sine = std::sqrt(1 - h.z * h.z);
        const double d = (2 + 1 / alpha) * std::pow(sine, 1 / alpha) / (2 * std::numbers::pi);
        const double expected = 0.6 * d / (4 * (o.z + l.z - o.z * l.z)) * l.z;
        const LayeredMaterialPoint without = layers(0, float(roughness), 1);
        const double base = first(Opaque(without).eval(wo, wi).f_cos.c[0]);
        const double out = first(lobe.albedo(wo)), most = std::max<double>(out, first(lobe.albedo(wi)));
        m.layers.sheen_reciprocal = Mask(false);
        EXPECT_NEAR(first(Opaque(m).eval(wo, wi).f_cos.c[0]), expected + base * (1 - 0.6 * out),
                    2e-3 * expected + 1e-5);
        m.layers.sheen_reciprocal = Mask(true);
        const double f_cos = first(Opaque(m).eval(wo, wi).f_cos.c[0]),
                     swapped = first(Opaque(m).eval(wi, wo).f_cos.c[0]);
        EXPECT_NEAR(f_cos, expected + base * (1 - 0.6 * most), 2e-3 * expected + 1e-5);
        EXPECT_NEAR(f_cos * o.z, swapped * l.z, 1e-4 * f_cos * o.z + 1e-6);
    }
}
TEST(Sheen, AlbedoIsTheIntegralOfTheLobe)
{
    for (const float roughness : {0.15f, 0.3f, 0.5f, 0.8f, 1.0f})
        for (const double degrees : {0.0, 40.0, 70.0, 85.0}) {
            const SheenLobe lobe{Float(roughness)};
            const Vec3 wo = outgoing(degrees);
            const double total = integrate_sphere(
                [&](Direction d) { return d.z > 0 ? double(first(lobe.eval(wo, lane_direction(d)))) : 0.0; });
            EXPECT_NEAR(first(lobe.albedo(wo)), total, 0.01 * total + 0.002) << roughness << " " << degrees;
        }
}

/// The coat's lobe uses its own normal and roughness.
TEST(Layered, CoatFollowsItsFormula)
{
    LayeredMaterialPoint m = with_coat(layers(0, 0.3f, 0, 1), 0.8f, 0.4f);
    m.layers.specular = Float(0);
    const V n = unit({0.2, -0.1, 1});
    m.layers.coat_normal = Vec3(Float(float(n.x)), Float(float(n.y)), Float(float(n.z)));
    const double a2 = std::pow(0.4 * 0.4, 2);
    Random random(8);
    for (int i = 0; i < 100; ++i) {
        const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
        const V o = v_of(wo), l = v_of(wi), h = unit({o.x + l.x, o.y + l.y, o.z + l.z});
        const double no = dot(n, o), nl = dot(n, l), nh = dot(n, h);
        double expected = 0;
        if (no > 0 && nl > 0) {
            const double d = a2 / (std::numbers::pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
            const auto far = [&](double a, double b) { return b * std::sqrt(a * a * (1 - a2) + a2); };
            const double f = 0.04 + 0.96 * std::pow(1 - dot(o, h), 5);
            expected = 0.8 * f * d * 0.5 / (far(no, nl) + far(nl, no)) * nl;
        }
        EXPECT_NEAR(first(Opaque(m).eval(wo, wi).f_cos.c[0]), expected, 2e-3 * expected + 1e-5) << i;
    }
}
/// A coat over a colored base darkens it through internal reflections.
TEST(Layered, CoatDarkensByGeometricSeries)
{
    LayeredMaterialPoint m = with_coat(layers(0.5f, 1, 0, 1), 1, 0);
    m.layers.specular = Float(0);
    const double without = first(Opaque(m).eval(outgoing(20), outgoing(60)).f_cos.c[0]);
    m.layers.coat_darkening = Float(1);
    const double with = first(Opaque(m).eval(outgoing(20), outgoing(60)).f_cos.c[0]);
    double series = 0;
    for (int i = 0; i < 60; ++i) series += (1 - 0.6) * std::pow(0.6 * 0.5, i);
    EXPECT_NEAR(with / without, series, 1e-3);
    m.layers.coat_color = gray(0.25f);
    EXPECT_NEAR(first(Opaque(m).eval(outgoing(20), outgoing(60)).f_cos.c[0]) / with, 0.25, 2e-2);
}

/// A coat with the index of the outside has no boundary: it only applies its color, also at grazing angles.
TEST(Layered, CoatWithoutABoundaryReflectsNothing)
{
    const LayeredMaterialPoint bare = layers(0.5f, 0.3f, 1);
    LayeredMaterialPoint m = with_coat(bare, 1, 0.3f);
    m.layers.coat_f0 = Float(0), m.layers.coat_color = gray(0.25f);
    for (const double degrees : {0.0, 45.0, 80.0, 88.0}) {
        const Vec3 wo = outgoing(degrees), wi = outgoing(-degrees);
        const float without = first(Opaque(bare).eval(wo, wi).f_cos.c[0]);
        EXPECT_GT(without, 0);
        EXPECT_NEAR(first(Opaque(m).eval(wo, wi).f_cos.c[0]) / without, 0.25, 1e-5) << degrees;
    }
    // The coat's reflection vanishes monotonically with f0.
    double before = 1e9;
    for (const float f0 : {0.02f, 0.01f, 0.002f, 0.f}) {
        m.layers.coat_f0 = Float(f0), m.layers.coat_color = gray(0);
        const double now = first(Opaque(m).eval(outgoing(85), outgoing(-85)).f_cos.c[0]);
        EXPECT_LT(now, before) << f0;
        before = now;
    }
    EXPECT_EQ(before, 0);
}

/// A solid applies the root of its transmission color at each boundary, a thin sheet the whole color at once.
TEST(Layered, TransmissionColor)
{
    for (const bool thin : {false, true})
        for (const bool entering : {true, false}) {
            LayeredMaterialPoint m = with_transmission(layers(1, 0.5f), 0.7f, thin, entering);
            const Vec3 wo = outgoing(20), down = -outgoing(30);
            const float white = first(Passing(m).eval(wo, down).f_cos.c[0]);
            m.layers.transmission_color = gray(0.25f);
            EXPECT_GT(white, 0.01f);
            EXPECT_NEAR(first(Passing(m).eval(wo, down).f_cos.c[0]) / white, thin ? 0.25 : 0.5, 1e-5);
        }
}
/// Diffuse transmission may replace part of the diffuse reflection or be added to it.
TEST(Layered, DiffuseTransmissionMayBeAdded)
{
    LayeredMaterialPoint m = with_diffuse_transmission(layers(0.6f, 1), 0.25f);
    m.layers.specular = Float(0);
    const Vec3 wo = outgoing(50), wi = outgoing(20);
    const auto reflected = [&] { return first(Passing(m).eval(wo, wi).f_cos.c[0]) * std::numbers::pi / first(wi.z); };
    const auto passed = [&] { return first(Passing(m).eval(wo, -wi).f_cos.c[0]) * std::numbers::pi / first(wi.z); };
    EXPECT_NEAR(reflected(), 0.75 * 0.6, 1e-5);
    EXPECT_NEAR(passed(), 0.25, 1e-5);
    m.layers.diffuse_transmission_added = Mask(true);
    EXPECT_NEAR(reflected(), 0.6, 1e-5);
    EXPECT_NEAR(passed(), 0.25, 1e-5);
    check_sampling(Passing(m), 50, "added");
    EXPECT_NEAR(unscaled_albedo(Passing(m), 50).first, 0.85, 0.01);
}
/// A thin surface has one boundary: only the reflected part is removed from straight transmission.
TEST(Layered, ThinReflectsOnce)
{
    LayeredMaterialPoint m = with_transmission(layers(1, 0.5f), 1, true);
    m.layers.compensation = Float(0);
    const Vec3 wo = outgoing(50), straight = -wo, mirrored{-wo.x, wo.y, wo.z};
    const double beyond = first(Passing(m).eval(wo, straight).f_cos.c[0]),
                 back = first(Passing(m).eval(wo, mirrored).f_cos.c[0]);
    const double c = first(wo.z), t = std::sqrt(1 - (1 - c * c) / 2.25);
    const double p = (1.5 * c - t) / (1.5 * c + t), s = (c - 1.5 * t) / (c + 1.5 * t), r = (p * p + s * s) / 2;
    EXPECT_NEAR(back / (back + beyond), r, 1e-3 * r);
}
/// Coat, sheen and thin film are outside a solid and have no effect inside it.
TEST(Layered, OuterLayersAreOutside)
{
    for (const bool entering : {true, false}) {
        const LayeredMaterialPoint m = with_transmission(layers(1, 0.5f), 0.7f, false, entering);
        LayeredMaterialPoint more = with_film(with_sheen(with_coat(m, 1, 0.4f), 0.7f, 0.5f), 1);
        more.layers.coat_color = gray(0.5f);
        for (const Vec3& wi : {outgoing(35), -outgoing(35)}) {
            const float without = first(Passing(m).eval(outgoing(20), wi).f_cos.c[0]),
                        with = first(Passing(more).eval(outgoing(20), wi).f_cos.c[0]);
            if (entering)
                EXPECT_GT(std::abs(with - without), 0.02f * without);
            else
                EXPECT_NEAR(with, without, 1e-5f * without);
        }
    }
}

/// A metal's reflectance is its color at 0 degrees, and Schlick's value times the edge color at 82 degrees.
TEST(Layered, EdgeColor)
{
    LayeredMaterialPoint m = layers(0.4f, 0.05f, 1);
    const double degrees = std::acos(1.0 / 7) * 180 / std::numbers::pi;
    const double before = unscaled_albedo(Opaque(m), degrees, 40000).first,
                 head_on = unscaled_albedo(Opaque(m), 0, 40000).first;
    m.layers.edge_color = gray(0.5f);
    EXPECT_NEAR(unscaled_albedo(Opaque(m), degrees, 40000).first / before, 0.5, 0.01);
    EXPECT_NEAR(unscaled_albedo(Opaque(m), 0, 40000).first, head_on, 1e-3);
}

/// Reflectance by Fresnel's equations for a complex index of refraction.
double fresnel_of(double degrees, std::complex<double> index)
{
    const double c = std::cos(degrees * std::numbers::pi / 180), s2 = 1 - c * c;
    const std::complex<double> square = index * index, t = std::sqrt(square - s2);
    return (std::norm((c - t) / (c + t)) + std::norm((square * c - t) / (square * c + t))) / 2;
}

/// With a complex index of refraction microfacets reflect by Fresnel's equations, and colors are ignored.
TEST(Layered, ConductorsReflectByTheirIndex)
{
    LayeredMaterialPoint white = layers(1, 0.3f, 1);
    white.layers.compensation = Float(0);
    for (const std::complex<double> index : {std::complex(2.5, 1.0), {0.2, 3.4}, {1.4, 7.6}, {3.2, 0.3}}) {
        LayeredMaterialPoint metal = white;
        metal.base_color = gray(0.3f), metal.layers.edge_color = gray(0.5f);
        metal.layers.features |= LayersRecord::with_conductor;
        metal.layers.conductor_eta = gray(float(index.real())), metal.layers.conductor_k = gray(float(index.imag()));
        for (const double degrees : {0.0, 30.0, 60.0, 75.0, 85.0}) {
            const Vec3 wo = outgoing(degrees), wi = outgoing(-degrees);
            const double share = double(first(Opaque(metal).eval(wo, wi).f_cos.c[1])) /
                                 double(first(Opaque(white).eval(wo, wi).f_cos.c[1]));
            EXPECT_NEAR(share, fresnel_of(degrees, index), 1e-4) << degrees << " " << index;
        }
        metal.layers.conductor_k = gray(0);
        EXPECT_NEAR(first(Opaque(metal).eval(outgoing(0), outgoing(0)).f_cos.c[1]) /
                        first(Opaque(white).eval(outgoing(0), outgoing(0)).f_cos.c[1]),
                    0.3, 1e-4)
            << "another lane's";
    }
}

/// Color matching functions: Wyman, Sloan and Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color
/// Matching Functions".
std::array<double, 3> sensitivity(double nm)
{
    const auto lobe = [&](double at, double left, double right) {
        const double t = (nm - at) * (nm < at ? left : right);
        return std::exp(-0.5 * t * t);
    };
    return {
        0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323) - 0.065 * lobe(501.1, 0.0490, 0.0382),
        0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
        1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725)};
}

/// Reflectance by Airy's formula at each wavelength, converted to RGB: the oscillating part is colored, the rest is
/// gray.
std::array<double, 3> film_by_wavelengths(double cosine, double f0, double thickness, double ior)
{
    const auto schlick = [](double r0, double c) { return r0 + (1 - r0) * std::pow(1 - c, 5); };
    const double cos_film = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double r12 = schlick(std::pow((ior - 1) / (ior + 1), 2), cosine);
    const double s = std::sqrt(f0 + 1e-4), base = (1 + s) / (1 - s);
    const double r23 = schlick(std::pow((base - ior) / (base + ior), 2), cos_film);
    // Air is optically thinner than the film, so that reflection has a phase shift of pi; so has the base's if it is
    // thinner.
    const double phase12 = std::numbers::pi, phase23 = base < ior ? std::numbers::pi : 0;
    const double grey_part = r12 + (1 - r12) * (1 - r12) * r23 / (1 - r12 * r23);
    double xyz[3] = {}, sums[3] = {};
    for (int nm = 370; nm <= 790; ++nm) {
        using C = std::complex<double>;
        // Reflection from air has the opposite sign of that from the film.
        const C from_film = std::polar(std::sqrt(r12), phase12), from_air = -from_film,
                from_base = std::polar(std::sqrt(r23), phase23);
        const C turn = std::polar(1.0, 2 * std::numbers::pi * 2 * ior * thickness * cos_film / nm);
        const C r = from_air + (1 - r12) * from_base * turn / (1.0 - from_film * from_base * turn);
        const auto eye = sensitivity(nm);
        for (int i = 0; i < 3; ++i) xyz[i] += eye[i] * (std::norm(r) - grey_part), sums[i] += eye[i];
    }
    for (int i = 0; i < 3; ++i) xyz[i] /= sums[1];
    const double to_rgb[3][3] = {
        {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};
    std::array<double, 3> rgb{};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) rgb[std::size_t(i)] += to_rgb[i][j] * xyz[j];
        rgb[std::size_t(i)] = std::clamp(rgb[std::size_t(i)] + grey_part, 0.0, 1.0);
    }
    return rgb;
}

TEST(ThinFilm, MatchesAirySummation)
{
    for (const double thickness : {250.0, 400.0, 550.0})
        for (const double cosine : {1.0, 0.7, 0.4})
            for (const auto [f0, ior] : {std::pair(0.04, 1.4), std::pair(0.3, 1.4), std::pair(0.04, 1.9)}) {
                const Spectrum got = thin_film_reflectance(Float(float(cosine)), gray(float(f0)),
                                                           Float(float(thickness)), Float(float(ior)));
                const auto expected = film_by_wavelengths(cosine, f0, thickness, ior);
                // The Gaussian fits deviate from the color matching functions by some percent.
                for (int c = 0; c < channels; ++c)
                    EXPECT_NEAR(first(got.c[c]), expected[std::size_t(c)], 0.03)
                        << thickness << " nm, cosine " << cosine << ", f0 " << f0 << ", ior " << ior << ", channel "
                        << c;
            }
}
TEST(Layered, FilmOfNoThicknessIsNone)
{
    LayeredMaterialPoint m = layers(0.4f, 0.3f, 0.5f);
    const float none = first(Opaque(m).eval(outgoing(20), outgoing(60)).f_cos.c[0]);
    m = with_film(m, 1);
    EXPECT_GT(std::abs(first(Opaque(m).eval(outgoing(20), outgoing(60)).f_cos.c[0]) - none), 0.01f * none);
    m.layers.thin_film_thickness = Float(0);
    EXPECT_NEAR(first(Opaque(m).eval(outgoing(20), outgoing(60)).f_cos.c[0]), none, 1e-6f);
}

/// With dispersion a path picks one channel at random, keeping the mean, and refracts by that channel's index.
TEST(Dispersion, ChoosesAChannelByChance)
{
    const int n = 30000;
    double sums[channels] = {}, counts[channels] = {};
    for (int i = 0; i < n; ++i) {
        LayeredMaterialPoint m = with_transmission(layers(1, 0), 1, false);
        set(m.layers, LayersRecord::disperses);
        m.layers.dispersion = Float(2);
        Spectrum throughput;
        for (int c = 0; c < channels; ++c) throughput.c[c] = Float(0.2f * float(c + 1));
        const SampleKey key{UInt(7u), UInt(std::uint32_t(i) * 2654435761u)};
        choose_channel(key, UInt(5u), m, throughput);
        int alive = 0;
        for (int c = 0; c < channels; ++c) {
            const double t = first(throughput.c[c]);
            sums[c] += t;
            if (t == 0) continue;
            ++alive, ++counts[c];
            // The offset is 0.025 * dispersion * (ior - 1) in either direction.
            EXPECT_NEAR(first(m.ior), 1.5 + (c - 1) * 0.025, 1e-6);
            // A path that follows one channel keeps it.
            choose_channel(key, UInt(9u), m, throughput);
            EXPECT_EQ(first(throughput.c[c]), t);
        }
        EXPECT_EQ(alive, 1);
    }
    for (int c = 0; c < channels; ++c) {
        EXPECT_NEAR(counts[c] / n, 1.0 / 3, 4 * std::sqrt(2.0 / 9 / n));
        EXPECT_NEAR(sums[c] / n, 0.2 * (c + 1), 0.6 * (c + 1) * 4 * std::sqrt(2.0 / 9 / n));
    }
}
TEST(Dispersion, LeavesOthersAlone)
{
    LayeredMaterialPoint m = with_transmission(layers(1, 0), 1, false);
    Spectrum throughput = gray(0.5f);
    choose_channel({UInt(7u), UInt(3u)}, UInt(5u), m, throughput);
    EXPECT_EQ(first(throughput.c[0]), 0.5f);
    EXPECT_EQ(first(m.ior), 1.5f);
}

}  // namespace
}  // namespace fathom::test
