// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lights/light.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

void put(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}

/// A light of radiance 1 that emits to both sides.
template <class Own>
LightRecord light_of(const Own& own)
{
    LightRecord l;
    l.set(own);
    l.pmf = 1;
    l.flags = LightRecord::two_sided;
    for (float& r : l.radiance) r = 1;
    return l;
}

LightRecord rectangle_light(Vec3d corner, Vec3d u, Vec3d v)
{
    RectangleLightRecord r;
    put(r.corner, corner), put(r.u, normalize(u)), put(r.v, normalize(v));
    put(r.flat.normal, normalize(cross(u, v)));
    r.length_u = float(length(u)), r.length_v = float(length(v));
    r.flat.area = r.length_u * r.length_v;
    put(r.center, corner + (u + v) * 0.5);
    r.diagonal = float(length(u + v));
    return light_of(r);
}

/// A light that is a triangle or parallelogram.
template <class Own>
LightRecord edges_light(Vec3d corner, Vec3d u, Vec3d v)
{
    Own l;
    put(l.corner, corner), put(l.edge_u, u), put(l.edge_v, v), put(l.flat.normal, normalize(cross(u, v)));
    l.flat.area = float(length(cross(u, v)) * (std::is_same_v<Own, TriangleLightRecord> ? 0.5 : 1));
    return light_of(l);
}

LightRecord disk_light(Vec3d center, Vec3d normal, double radius)
{
    DiskLightRecord d;
    put(d.center, center), put(d.flat.normal, normal);
    d.radius = float(radius);
    d.flat.area = float(std::numbers::pi * radius * radius);
    return light_of(d);
}

/// A one-sided sphere light.
LightRecord sphere_light(Vec3d center, double radius, Vec3d velocity = {})
{
    SphereLightRecord s;
    put(s.center, center), put(s.velocity, velocity);
    s.radius = float(radius);
    LightRecord l = light_of(s);
    l.flags = 0;
    return l;
}

/// Solid angle of a rectangle by summing cosine over squared distance of its parts.
double solid_angle(Vec3d p, Vec3d corner, Vec3d u, Vec3d v)
{
    constexpr int n = 400;
    const Vec3d normal = cross(u, v);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec3d r = corner + u * ((i + 0.5) / n) + v * ((j + 0.5) / n) - p;
            sum += std::abs(dot(r, normal)) / std::pow(dot(r, r), 1.5);
        }
    return sum / (n * n);
}

struct Place {
    Vec3d p, corner, u, v;
};
const Place places[] = {
    {{0, 0, 0}, {-1, -1, 2}, {2, 0, 0}, {0, 2, 0}},                // a rectangle in front
    {{0, 0, 0}, {1, 2, 0.5}, {3, 0, 0}, {0, 0.5, 0}},              // a rectangle to the side and near
    {{0, 0, 0}, {-5, -5, 0.3}, {10, 0, 0}, {0, 10, 0}},            // nearly a hemisphere
    {{1, 2, 3}, {2, 2, 4}, {1, 1, 0}, {0, 0, 2}},                  // a rotated rectangle
    {{278, 0, 200}, {213, 554, 227}, {130, 0, 0}, {0, 0, 105}},    // the Cornell box's light from its floor: far
    {{278, 450, 200}, {213, 554, 227}, {130, 0, 0}, {0, 0, 105}},  // the Cornell box's light from near below
};

TEST(Rectangle, SolidAngleIsThatOfItsParts)
{
    for (const Place& place : places) {
        const Vec3d r = place.corner - place.p;
        const SphericalRectangle seen(
            Vec3(Vec3f{float(r.x), float(r.y), float(r.z)}),
            Vec3(Vec3f{float(normalize(place.u).x), float(normalize(place.u).y), float(normalize(place.u).z)}),
            Vec3(Vec3f{float(normalize(place.v).x), float(normalize(place.v).y), float(normalize(place.v).z)}),
            Vec3(Vec3f{float(normalize(cross(place.u, place.v)).x), float(normalize(cross(place.u, place.v)).y),
                       float(normalize(cross(place.u, place.v)).z)}),
            Float(float(length(place.u))), Float(float(length(place.v))));
        const double expected = solid_angle(place.p, place.corner, place.u, place.v);
        EXPECT_NEAR(first(seen.solid_angle) / expected, 1, 2e-4);
    }
}

TEST(Rectangle, IsSampledUniformlyByAngleFromNearAndByAreaFromFar)
{
    for (const Place& place : places) {
        const LightRecord table = rectangle_light(place.corner, place.u, place.v);
        const LightReader<false> light(&table, UInt(0u));
        const Vec3 p(Vec3f{float(place.p.x), float(place.p.y), float(place.p.z)});
        test::Random random;
        // The expected share of each cell of the rectangle is that of its solid angle or area.
        const bool far = length(place.corner + (place.u + place.v) * 0.5 - place.p) > length(place.u + place.v);
        constexpr int cells = 8;
        std::vector<double> observed(cells * cells), expected(cells * cells);
        int drawn = 0;
        for (; drawn < 100000; drawn += lanes) {
            const LightSample s = sample_light(light, p, Float(0), random.next2(), Mask(true));
            float x[3][lanes], t[lanes], inverse[lanes], pdf[lanes];
            store(x[0], s.wi.x), store(x[1], s.wi.y), store(x[2], s.wi.z), store(t, s.distance),
                store(inverse, s.inverse_pdf);
            store(pdf, pdf_light(light, p, Float(0), s.wi, s.distance, Mask(true)));
            for (int i = 0; i < lanes; ++i) {
                const Vec3d q = place.p + Vec3d{x[0][i], x[1][i], x[2][i]} * t[i] - place.corner;
                const double a = dot(q, place.u) / dot(place.u, place.u), b = dot(q, place.v) / dot(place.v, place.v);
                ASSERT_NEAR(a, std::clamp(a, 0.0, 1.0), 1e-4);
                ASSERT_NEAR(b, std::clamp(b, 0.0, 1.0), 1e-4);
                ASSERT_NEAR(dot(q, normalize(cross(place.u, place.v))), 0, 1e-4 * length(place.corner - place.p));
                ASSERT_NEAR(pdf[i] * inverse[i], 1, 1e-4);
                ++observed[std::size_t(std::clamp(int(a * cells), 0, cells - 1) * cells +
                                       std::clamp(int(b * cells), 0, cells - 1))];
            }
        }
        const double total = solid_angle(place.p, place.corner, place.u, place.v);
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j)
                expected[std::size_t(i * cells + j)] =
                    far ? double(drawn) / (cells * cells)
                        : drawn / total *
                              solid_angle(place.p,
                                          place.corner + place.u * (double(i) / cells) + place.v * (double(j) / cells),
                                          place.u * (1.0 / cells), place.v * (1.0 / cells));
        EXPECT_EQ(test::chi_square(observed, expected), "");
    }
}

/// Estimates the solid angle by the mean of inverse_pdf without the cosine; for kinds sampled by area.
double estimate_solid_angle(const LightRecord& table, Vec3 p)
{
    const LightReader<false> light(&table, UInt(0u));
    test::Random random;
    double sum = 0;
    int n = 0;
    for (; n < 400000; n += lanes) {
        const LightSample s = sample_light(light, p, Float(0), random.next2(), Mask(true));
        float inverse[lanes];
        store(inverse, s.inverse_pdf);
        for (float v : inverse) sum += v;
    }
    return sum / n;
}

TEST(Lights, InverseDensitiesAverageToTheSolidAngle)
{
    const Vec3 p(Float(0), Float(0), Float(0));
    const LightRecord l = edges_light<ParallelogramLightRecord>({1, -1, 2}, {2, 0, 0}, {0, 1, 1});
    EXPECT_NEAR(estimate_solid_angle(l, p) / solid_angle({0, 0, 0}, {1, -1, 2}, {2, 0, 0}, {0, 1, 1}), 1, 0.005);

    const LightRecord triangle = edges_light<TriangleLightRecord>({1, -1, 2}, {2, 0, 0}, {0, 1, 1});
    // The solid angle of a triangle is that of Van Oosterom and Strackee 1983.
    const Vec3d a{1, -1, 2}, b{3, -1, 2}, c{1, 0, 3};
    const double la = length(a), lb = length(b), lc = length(c);
    const double exact =
        2 * std::atan2(std::abs(dot(a, cross(b, c))), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(a, c) * lb);
    EXPECT_NEAR(estimate_solid_angle(triangle, p) / exact, 1, 0.005);

    LightRecord disk = disk_light({0, 0, 2}, {0, 0, -1}, 1.5);
    disk.flags = 0;
    EXPECT_NEAR(estimate_solid_angle(disk, p) / (2 * std::numbers::pi * (1 - 2 / 2.5)), 1, 0.005);

    EXPECT_NEAR(estimate_solid_angle(sphere_light({0, 3, 4}, 3), p) / (2 * std::numbers::pi * (1 - 0.8)), 1, 1e-5);
}

TEST(Sphere, SamplesLieOnItAndInTheConeOfDirections)
{
    for (float radius : {1e-3f, 0.5f, 4.9f}) {
        const LightRecord table = sphere_light({0, 3, 4}, double(radius));
        const LightReader<false> light(&table, UInt(0u));
        test::Random random;
        for (int n = 0; n < 2000; n += lanes) {
            const LightSample s =
                sample_light(light, Vec3(Float(0), Float(0), Float(0)), Float(0), random.next2(), Mask(true));
            float x[3][lanes], t[lanes];
            store(x[0], s.wi.x), store(x[1], s.wi.y), store(x[2], s.wi.z), store(t, s.distance);
            for (int i = 0; i < lanes; ++i) {
                const Vec3d q = Vec3d{x[0][i], x[1][i], x[2][i]} * t[i] - Vec3d{0, 3, 4};
                ASSERT_NEAR(length(q), radius, 3e-5 + 1e-3 * radius);
                ASSERT_LE(t[i], 5 + 1e-4);
            }
        }
    }
}

/// Unit vectors perpendicular to a unit vector and to each other.
void perpendicular(Vec3d n, Vec3d& s, Vec3d& t)
{
    s = normalize(cross(n, std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    t = cross(n, s);
}

/// Calls f(direction, distance, inverse_pdf, pdf of pdf_light) for n samples of a light.
template <class F>
void for_samples(const LightRecord& table, Vec3d from, float time, int n, F&& f)
{
    const LightReader<false> light(&table, UInt(0u));
    const Vec3 p(Vec3f{float(from.x), float(from.y), float(from.z)});
    test::Random random;
    for (int k = 0; k < n; k += lanes) {
        const LightSample s = sample_light(light, p, Float(time), random.next2(), Mask(true));
        float x[3][lanes], t[lanes], inverse[lanes], pdf[lanes];
        store(x[0], s.wi.x), store(x[1], s.wi.y), store(x[2], s.wi.z), store(t, s.distance);
        store(inverse, s.inverse_pdf);
        store(pdf, pdf_light(light, p, Float(time), s.wi, s.distance, Mask(true)));
        for (int i = 0; i < lanes; ++i) f(Vec3d{x[0][i], x[1][i], x[2][i]}, double(t[i]), double(inverse[i]), pdf[i]);
    }
}

/// For a sphere the mean of inverse_pdf is right for any distribution of directions, so the distribution is tested,
/// too: cells of equal solid angle in cosine and azimuth about the center's direction.
TEST(Sphere, IsSampledUniformlyInTheConeThatItFills)
{
    struct Case {
        Vec3d center;
        double radius;
    };
    for (const Case& c :
         {Case{{0, 3, 4}, 0.05}, {{0, 3, 4}, 3}, {{-2, 1, 0.5}, 2.28}, {{1, 0, 0}, 1.5}, {{0, 0, -1}, -4}}) {
        const LightRecord table = sphere_light(c.center, c.radius);
        const double d = length(c.center), sin2 = c.radius * c.radius / (d * d);
        const bool outside = sin2 < 1;
        // The spread is 1 - cos of the cone, or 2 for all directions.
        const double spread = outside ? sin2 / (1 + std::sqrt(1 - sin2)) : 2;
        const Vec3d n = normalize(c.center);
        Vec3d s, t;
        perpendicular(n, s, t);
        constexpr int rings = 10, sectors = 12;
        std::vector<double> observed(rings * sectors), expected(rings * sectors);
        int drawn = 0;
        for_samples(table, {0, 0, 0}, 0, 60000, [&](Vec3d w, double distance, double inverse, double pdf) {
            ++drawn;
            ASSERT_NEAR(length(w), 1, 3e-6);
            const double x = dot(w, s), y = dot(w, t), z = dot(w, n), sine2 = x * x + y * y;
            const double lost = z > 0 ? sine2 / (1 + z) : 1 - z;
            ++observed[std::size_t(
                std::clamp(int(lost / spread * rings), 0, rings - 1) * sectors +
                std::clamp(int((std::atan2(y, x) / (2 * std::numbers::pi) + 0.5) * sectors), 0, sectors - 1))];
            // From outside, the nearer of both intersections is the hit; from inside, the one in front.
            const double b = z * d, root = std::sqrt(std::max(0.0, c.radius * c.radius - d * d * sine2));
            ASSERT_NEAR(distance, outside ? b - root : b + root, 2e-3 * d);
            // Only the side that faces the viewpoint emits: the outside if radius > 0, else the inside.
            const bool shines = outside == (c.radius > 0);
            ASSERT_NEAR(inverse, shines ? 2 * std::numbers::pi * spread : 0, 2e-5 * spread);
            ASSERT_NEAR(pdf * 2 * std::numbers::pi * spread, 1, 1e-5);
        });
        for (double& e : expected) e = double(drawn) / (rings * sectors);
        EXPECT_EQ(test::chi_square(observed, expected), "") << c.radius;
    }
}

TEST(Sphere, IsSampledWhereItIsByThen)
{
    const LightRecord table = sphere_light({0, 0, 4}, 0.5, {6, 2, 0});
    for (float time : {0.0f, 0.25f, 1.0f}) {
        const Vec3d center{6 * double(time), 2 * double(time), 4};
        const double d2 = dot(center, center), spread = 1 - std::sqrt(1 - 0.25 / d2);
        for_samples(table, {0, 0, 0}, time, 100, [&](Vec3d w, double distance, double inverse, double pdf) {
            EXPECT_NEAR(length(w * distance - center), 0.5, 2e-3);
            EXPECT_NEAR(inverse / (2 * std::numbers::pi * spread), 1, 1e-4);
            EXPECT_NEAR(pdf * inverse, 1, 1e-5);
        });
    }
}

/// Points are uniform over the area, with the pdf of uniform area sampling.
TEST(FlatLights, AreSampledUniformlyByArea)
{
    const Vec3d corner{1, -1, 2}, u{2, 0.5, 0}, v{0.3, 1, 1}, n = cross(u, v), from{0.2, 0.1, -0.5};
    for (const LightRecordKind kind :
         {LightRecordKind::parallelogram, LightRecordKind::triangle, LightRecordKind::disk}) {
        const LightRecord table = kind == LightRecordKind::disk ? disk_light(corner, normalize(n), 0.75)
                                  : kind == LightRecordKind::triangle
                                      ? edges_light<TriangleLightRecord>(corner, u, v)
                                      : edges_light<ParallelogramLightRecord>(corner, u, v);
        const double area = kind == LightRecordKind::disk       ? std::numbers::pi * 0.75 * 0.75
                            : kind == LightRecordKind::triangle ? length(n) / 2
                                                                : length(n);
        Vec3d s, t;
        perpendicular(normalize(n), s, t);
        constexpr int cells = 8;
        std::vector<double> observed(cells * cells), expected(cells * cells);
        int drawn = 0;
        for_samples(table, from, 0, 100000, [&](Vec3d w, double distance, double inverse, double pdf) {
            ++drawn;
            const Vec3d r = from + w * distance - corner;
            ASSERT_NEAR(dot(r, normalize(n)), 0, 1e-5);
            double a = dot(cross(r, v), n) / dot(n, n), b = dot(cross(u, r), n) / dot(n, n);
            if (kind == LightRecordKind::disk) {
                const double x = dot(r, s), y = dot(r, t);
                a = (x * x + y * y) / (0.75 * 0.75), b = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
            } else if (kind == LightRecordKind::triangle) {
                ASSERT_LE(a + b, 1 + 1e-5);
                // Area-preserving map of the triangle to the square, from the corner.
                const double share = (a + b) * (a + b);
                b = a + b > 0 ? b / (a + b) : 0, a = share;
            }
            ASSERT_NEAR(a, std::clamp(a, 0.0, 1.0), 1e-5);
            ASSERT_NEAR(b, std::clamp(b, 0.0, 1.0), 1e-5);
            ++observed[std::size_t(std::clamp(int(a * cells), 0, cells - 1) * cells +
                                   std::clamp(int(b * cells), 0, cells - 1))];
            const double solid = area * std::abs(dot(w, normalize(n))) / (distance * distance);
            ASSERT_NEAR(inverse / solid, 1, 2e-5);
            ASSERT_NEAR(pdf * inverse, 1, 2e-5);
        });
        for (double& e : expected) e = double(drawn) / (cells * cells);
        EXPECT_EQ(test::chi_square(observed, expected), "") << int(kind);
    }
}

/// Light arrives in front of a flat light only, unless it is two-sided.
TEST(FlatLights, ShineToTheSideOfTheirNormal)
{
    const Vec3d corner{-1, -1, 0}, u{2, 0, 0}, v{0, 2, 0};
    for (LightRecord table : {rectangle_light(corner, u, v), edges_light<ParallelogramLightRecord>(corner, u, v),
                              edges_light<TriangleLightRecord>(corner, u, v), disk_light({0, 0, 0}, {0, 0, 1}, 1)})
        for (const bool two_sided : {false, true})
            for (const double far : {1.0, 10.0}) {
                table.flags = two_sided;
                for (const double side : {1.0, -1.0})
                    for_samples(table, {0.1, 0.2, side * far}, 0, 16, [&](Vec3d w, double, double inverse, double) {
                        EXPECT_LT(w.z * side, 0);
                        EXPECT_EQ(inverse > 0, two_sided || side > 0) << table.kind << " " << far;
                    });
            }
}

LightSample sample_of(const LightRecord& table, Vec3d from)
{
    return sample_light(LightReader<false>(&table, UInt(0u)), Vec3(Vec3f{float(from.x), float(from.y), float(from.z)}),
                        Float(0), {Float(0.3f), Float(0.6f)}, Mask(true));
}

TEST(PointLight, FallsOffWithTheSquareOfTheDistance)
{
    PointLightRecord point;
    put(point.position, {1, 2, 3});
    LightRecord table = light_of(point);
    for (int c = 0; c < channels; ++c) table.radiance[c] = float(c + 2);
    for (const Vec3d& from : {Vec3d{1, 2, 0}, {4, -2, 3}, {-7, 2.5, 9}}) {
        const LightSample s = sample_of(table, from);
        const Vec3d to = Vec3d{1, 2, 3} - from;
        for (int c = 0; c < channels; ++c)
            EXPECT_NEAR(first(s.radiance.c[c]), (c + 2) / dot(to, to), 1e-6 * (c + 2) / dot(to, to));
        EXPECT_NEAR(first(s.distance), length(to), 1e-5);
        EXPECT_NEAR(first(s.wi.y), normalize(to).y, 1e-6);
        EXPECT_EQ(first(s.inverse_pdf), 1);
        EXPECT_TRUE(first(s.is_delta));
    }
}

/// By KHR_lights_punctual, intensity is full inside the inner cone and zero outside the outer one; between them it is
/// the squared fraction of the cosine.
TEST(SpotLight, FallsOffBetweenItsCones)
{
    const double inner = 0.4, outer = 0.9;
    SpotLightRecord spot;
    const Vec3d axis = normalize(Vec3d{1, -2, 0.5});
    put(spot.axis, axis);
    spot.outer = float(1 - std::cos(outer)), spot.falloff = float(std::cos(inner) - std::cos(outer));
    LightRecord table = light_of(spot);
    for (float& r : table.radiance) r = 3;
    Vec3d s, t;
    perpendicular(axis, s, t);
    for (const double angle : {0.0, 0.2, 0.399, 0.401, 0.5, 0.65, 0.8, 0.899, 0.901, 1.2, 2.0, 3.1})
        for (const double distance : {1.0, 2.5}) {
            const Vec3d from = (axis * std::cos(angle) + (s * 0.6 + t * 0.8) * std::sin(angle)) * distance;
            const double x =
                std::clamp((std::cos(angle) - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
            EXPECT_NEAR(first(sample_of(table, from).radiance.c[1]), 3 * x * x / (distance * distance), 2e-5) << angle;
        }
}

TEST(BeamLight, ShinesAlongItsNormalOnly)
{
    BeamLightRecord beam;
    put(beam.center, {1, 2, 3});
    put(beam.half_u, {2, 0, 0}), put(beam.half_v, {1, 1, 0}), put(beam.axis, {0, 0, -1});
    for (const bool round : {false, true}) {
        beam.is_round = round;
        LightRecord table = light_of(beam);
        for (float& r : table.radiance) r = 7;
        for (const double x : {-1.01, -0.99, -0.5, 0.0, 0.55, 0.9, 1.01})
            for (const double y : {-1.2, -0.8, 0.1, 0.7, 0.99})
                for (const double z : {3.0, 0.25, 1e-3, -0.5}) {
                    const LightSample s = sample_of(table, {1 + 2 * x + y, 2 + y, 3 - z});
                    const bool arrives = z > 0 && (round ? x * x + y * y < 1 : std::max(std::abs(x), std::abs(y)) < 1);
                    EXPECT_EQ(first(s.inverse_pdf), arrives ? 1 : 0) << x << ' ' << y << ' ' << z;
                    if (!arrives) continue;
                    EXPECT_EQ(first(s.radiance.c[0]), 7);
                    EXPECT_NEAR(first(s.distance), z, 1e-6);
                    EXPECT_NEAR(first(s.wi.z), 1, 1e-6);
                    EXPECT_TRUE(first(s.is_delta));
                }
    }
}

TEST(DirectionalLight, ComesFromOneDirectionOrADisk)
{
    const Vec3d travels = normalize(Vec3d{1, -2, 0.5});
    DirectionalLightRecord sun;
    put(sun.axis, travels);
    LightRecord table = light_of(sun);
    for (float& r : table.radiance) r = 7;
    for (const Vec3d& from : {Vec3d{0, 0, 0}, {100, 5, -3}}) {
        const LightSample s = sample_of(table, from);
        EXPECT_NEAR(first(dot(s.wi, Vec3(Vec3f{float(travels.x), float(travels.y), float(travels.z)}))), -1, 1e-6);
        EXPECT_EQ(first(s.radiance.c[0]), 7);
        EXPECT_EQ(first(s.inverse_pdf), 1);
        EXPECT_TRUE(std::isinf(first(s.distance)));
        EXPECT_TRUE(first(s.is_delta));
    }
    // The light is a disk, in whose cone directions are uniform, so inverse_pdf is the solid angle.
    sun.one_minus_cos = 0.2f;
    table.set(sun);
    Vec3d s, t;
    perpendicular(-travels, s, t);
    constexpr int rings = 8, sectors = 8;
    std::vector<double> observed(rings * sectors), expected(rings * sectors);
    int drawn = 0;
    for_samples(table, {1, 2, 3}, 0, 40000, [&](Vec3d w, double, double inverse, double) {
        ++drawn;
        EXPECT_NEAR(inverse, 2 * std::numbers::pi * 0.2, 1e-5);
        const double lost = 1 - dot(w, -travels),
                     turn = std::atan2(dot(w, t), dot(w, s)) / (2 * std::numbers::pi) + 0.5;
        ASSERT_LE(lost, 0.2 + 1e-6);
        ++observed[std::size_t(std::clamp(int(lost / 0.2 * rings), 0, rings - 1) * sectors +
                               std::clamp(int(turn * sectors), 0, sectors - 1))];
    });
    for (double& e : expected) e = double(drawn) / (rings * sectors);
    EXPECT_EQ(test::chi_square(observed, expected), "");
}

TEST(Sphere, FromInsideEveryDirectionIsAlikeAndTheRightSideShows)
{
    const Vec3 inside(Float(1), Float(2), Float(3));
    // A negative radius emits inwards.
    EXPECT_NEAR(estimate_solid_angle(sphere_light({}, -10), inside), 4 * std::numbers::pi, 1e-3);
    EXPECT_EQ(estimate_solid_angle(sphere_light({}, 10), inside), 0);
}

}  // namespace
}  // namespace fathom
