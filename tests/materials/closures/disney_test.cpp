// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/disney.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

struct Surface {
    float roughness = 0.5f, metallic = 0, ior = 1.5f;
    bool is_thin = false;
    float anisotropy = 0, flatness = 0, specular_tint = 0, sheen = 0, sheen_tint = 0, coat = 0, coat_gloss = 0,
          transmission = 0, diffuse_transmission = 0;
};

DisneyMaterialPoint point(const Surface& s, bool entering = true)
{
    DisneyMaterialPoint m = material(0.6f, s.roughness, s.metallic, s.ior);
    m.base_color.c[1] = Float(0.3f), m.base_color.c[2] = Float(0.1f);
    m.entering = Mask(entering), m.thin = Mask(s.is_thin);
    m.disney = {Float(s.anisotropy),           Float(s.flatness),
                Float(s.specular_tint),        Float(s.sheen),
                Float(s.sheen_tint),           Float(s.coat),
                Float(s.coat_gloss),           Float(s.transmission),
                Float(s.diffuse_transmission), Vec3(Float(1), Float(0), Float(0))};
    return m;
}

enum Name { plain, metal, coat, sheen, tint, flat, trans, thin, thin_diffuse, mix };
constexpr const char* names[] = {"plain", "metal", "coat", "sheen",        "tint",
                                 "flat",  "trans", "thin", "thin_diffuse", "mix"};
constexpr Surface surfaces[] = {{},
                                {.roughness = 0.4f, .metallic = 1, .anisotropy = 0.8f},
                                {.coat = 1, .coat_gloss = 0.5f},
                                {.sheen = 1, .sheen_tint = 0.5f},
                                {.roughness = 0.4f, .specular_tint = 0.7f},
                                {.roughness = 0.6f, .flatness = 0.8f},
                                {.roughness = 0.4f, .ior = 1.4f, .transmission = 0.7f},
                                {.roughness = 0.4f, .ior = 1.4f, .is_thin = true, .sheen = 0.5f, .transmission = 0.6f},
                                {.roughness = 0.4f, .is_thin = true, .flatness = 0.3f, .diffuse_transmission = 0.6f},
                                {.metallic = 0.3f,
                                 .anisotropy = 0.5f,
                                 .flatness = 0.5f,
                                 .specular_tint = 0.4f,
                                 .sheen = 0.5f,
                                 .coat = 0.5f,
                                 .coat_gloss = 0.2f,
                                 .transmission = 0.4f}};

struct Row {
    Name surface;
    Direction wo, wi;
    double red, blue;  ///< f times the cosine of wi, in red and blue
};
/// Directions below the surface are inside.
constexpr Row mitsuba[] = {
    {plain, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.219706, 0.0664263},
    {plain, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0956604, 0.0170315},
    {plain, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0965809, 0.0171037},
    {metal, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.231247, 0.0385412},
    {metal, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.000611174, 0.00010261},
    {metal, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.00259539, 0.000434673},
    {coat, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.248504, 0.0952243},
    {coat, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0961492, 0.0175203},
    {coat, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0968301, 0.0173529},
    {sheen, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.219707, 0.0664264},
    {sheen, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0962501, 0.0173106},
    {sheen, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0969652, 0.0172856},
    {tint, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.263274, 0.0571116},
    {tint, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0946426, 0.0159302},
    {tint, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0924936, 0.0155654},
    {flat, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.154613, 0.0435598},
    {flat, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.108423, 0.0199297},
    {flat, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.135852, 0.0243074},
    {trans, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.0919567, 0.0459727},
    {trans, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0285796, 0.00512083},
    {trans, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0279231, 0.00499912},
    {trans, {0.31449, 0.10483, 0.94346}, {-0.35112, 0.00000, -0.93633}, 0.344266, 0.140546},
    {trans, {-0.68376, 0.45584, 0.56980}, {0.54944, -0.13736, -0.82416}, 0.12493, 0.0510026},
    {trans, {0.31449, 0.10483, -0.94346}, {-0.24077, 0.12039, -0.96309}, 0.026021, 0.026021},
    {trans, {0.31449, 0.10483, -0.94346}, {-0.44444, -0.11111, 0.88889}, 38.2745, 15.6255},
    {thin, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.09564, 0.034328},
    {thin, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0378783, 0.00659991},
    {thin, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0369835, 0.00641821},
    {thin, {0.31449, 0.10483, 0.94346}, {-0.35112, 0.00000, -0.93633}, 2.0731, 0.345516},
    {thin, {-0.68376, 0.45584, 0.56980}, {0.54944, -0.13736, -0.82416}, 0.0335204, 0.00558673},
    {thin, {0.31449, 0.10483, -0.94346}, {-0.24077, 0.12039, -0.96309}, 0.09564, 0.034328},
    {thin, {0.31449, 0.10483, -0.94346}, {-0.44444, -0.11111, 0.88889}, 1.31277, 0.218795},
    {thin_diffuse, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.0659735, 0.0109956},
    {thin_diffuse, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0393225, 0.00655374},
    {thin_diffuse, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0422934, 0.0070489},
    {thin_diffuse, {0.31449, 0.10483, 0.94346}, {-0.35112, 0.00000, -0.93633}, 0.107295, 0.0178826},
    {thin_diffuse, {-0.68376, 0.45584, 0.56980}, {0.54944, -0.13736, -0.82416}, 0.0944422, 0.0157404},
    {mix, {0.31449, 0.10483, 0.94346}, {-0.24077, 0.12039, 0.96309}, 0.22646, 0.0590284},
    {mix, {-0.68376, 0.45584, 0.56980}, {0.61546, 0.61546, 0.49237}, 0.0450534, 0.00802197},
    {mix, {0.97619, 0.00000, 0.21693}, {0.09667, -0.87006, 0.48337}, 0.0545621, 0.00965109},
    {mix, {0.31449, 0.10483, 0.94346}, {-0.35112, 0.00000, -0.93633}, 0.321452, 0.131232},
    {mix, {-0.68376, 0.45584, 0.56980}, {0.54944, -0.13736, -0.82416}, 0.060402, 0.024659},
    {mix, {0.31449, 0.10483, -0.94346}, {-0.24077, 0.12039, -0.96309}, 0.00782363, 0.00782363},
    {mix, {0.31449, 0.10483, -0.94346}, {-0.44444, -0.11111, 0.88889}, 5.18501, 2.11677}};

/// The closure agrees with Mitsuba 3's principled and principledthin.
TEST(Disney, IsThatOfMitsuba)
{
    for (const Row& row : mitsuba) {
        const bool enters = row.wo.z > 0;
        const DisneyBsdf<true> bsdf(point(surfaces[row.surface], enters));
        const auto on_side = [&](Direction d) { return lane_direction({d.x, d.y, enters ? d.z : -d.z}); };
        const Spectrum f = bsdf.eval(on_side(row.wo), on_side(row.wi)).f_cos;
        EXPECT_NEAR(first(f.c[0]), row.red, 5e-4 * row.red) << names[row.surface] << " " << row.wo.x << " " << row.wi.z;
        EXPECT_NEAR(first(f.c[2]), row.blue, 5e-4 * row.blue) << names[row.surface];
    }
}

/// The instantiation without transmission has less code and equal results.
TEST(Disney, OpaqueOnesAreTheSame)
{
    for (const Row& row : mitsuba) {
        if (row.surface >= trans || row.wi.z < 0) continue;
        const DisneyMaterialPoint m = point(surfaces[row.surface]);
        const Vec3 wo = lane_direction(row.wo), wi = lane_direction(row.wi);
        const BsdfEval less = DisneyBsdf<false>(m).eval(wo, wi), all = DisneyBsdf<true>(m).eval(wo, wi);
        EXPECT_EQ(first(less.f_cos.c[0]), first(all.f_cos.c[0]));
        EXPECT_EQ(first(less.pdf), first(all.pdf));
    }
}

/// An opaque material is not a solid, so its back has no total internal reflection: it acts like Mitsuba's `twosided`.
TEST(Disney, BacksOfOpaqueOnesAreAsFronts)
{
    for (const Name name : {plain, metal, coat, sheen, tint, flat})
        for (const double degrees : {10.0, 60.0, 80.0}) {
            const DisneyBsdf<false> front(point(surfaces[name])), back(point(surfaces[name], false));
            const Vec3 wo = outgoing(degrees), wi = outgoing(-40);
            const BsdfEval a = front.eval(wo, wi), b = back.eval(wo, wi);
            EXPECT_EQ(first(a.f_cos.c[0]), first(b.f_cos.c[0])) << names[name] << ' ' << degrees;
            EXPECT_EQ(first(a.pdf), first(b.pdf)) << names[name] << ' ' << degrees;
        }
}

TEST(Disney, Sampling)
{
    for (const double degrees : {10.0, 60.0})
        for (std::size_t i = 0; i < std::size(surfaces); ++i) {
            if (i < trans) check_sampling(DisneyBsdf<false>(point(surfaces[i])), degrees, names[i]);
            if (i >= trans) check_sampling(DisneyBsdf<true>(point(surfaces[i])), degrees, names[i]);
        }
    check_sampling(DisneyBsdf<true>(point(surfaces[trans], false)), 20, "from within");
}

/// Sampling covers all lobes of eval: the sampled albedo equals the integral.
TEST(Disney, SamplingGivesAll)
{
    for (const Name name : {coat, sheen, trans, thin, thin_diffuse, mix}) {
        const DisneyBsdf<true> bsdf(point(surfaces[name]));
        const Vec3 wo = outgoing(40);
        double sum = 0;
        constexpr int n = 400;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < n; ++k) {
                const double z = -1 + 2 * (i + 0.5) / n, phi = 2 * std::numbers::pi * (k + 0.5) / n,
                             s = std::sqrt(1 - z * z);
                sum += first(bsdf.eval(wo, lane_direction({s * std::cos(phi), s * std::sin(phi), z})).f_cos.c[0]);
            }
        const double albedo = sum * 4 * std::numbers::pi / (n * n);
        EXPECT_NEAR(albedo_of(bsdf, wo), albedo, 0.006 * albedo) << names[name];
    }
}

/// The coat's pdf integrates to 1 and its cosine to pi over the hemisphere.
TEST(Disney, CoatSamplesByItsDensity)
{
    const Gtr1Coat lobe(Float(0));
    const Vec3 wo = outgoing(40);
    Random random(3);
    double sum = 0;
    constexpr int n = 400000 / lanes;
    for (int k = 0; k < n; ++k) {
        const Vec3 wi = lobe.sample(wo, random.next2());
        Float f_cos, pdf;
        lobe.eval(wo, {wi.x, wi.y, max(wi.z, Float(0))}, f_cos, pdf);
        float each[lanes];
        store(each, select(wi.z > Float(0), wi.z / pdf, Float(0)));
        for (const float x : each) sum += double(x);
    }
    EXPECT_NEAR(sum / (n * lanes), std::numbers::pi, 0.04);
}

/// Microfacets that are treated as mirrors show no lights without extent.
TEST(Disney, MirrorsShowNoPoints)
{
    const DisneyBsdf<false> bsdf(point({.roughness = 0.02f, .metallic = 1}));
    const Vec3 wo = outgoing(30), wi = outgoing(-30);
    EXPECT_GT(first(bsdf.eval(wo, wi).f_cos.c[0]), 100);
    EXPECT_EQ(first(bsdf.eval(wo, wi, Mask(true)).f_cos.c[0]), 0);
}

}  // namespace
}  // namespace fathom::test
