#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "chi_square.h"
#include "lane_helpers.h"
#include "light/light.h"

namespace fathom {
namespace {

using test::first;

void put(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}

LightRecord rectangle_light(Vec3d corner, Vec3d u, Vec3d v)
{
    LightRecord l;
    l.kind = std::uint32_t(LightRecordKind::rectangle);
    l.pmf = 1;
    put(l.position, corner), put(l.edge_u, normalize(u)), put(l.edge_v, normalize(v));
    put(l.normal, normalize(cross(u, v)));
    l.length_u = float(length(u)), l.length_v = float(length(v));
    l.area = l.length_u * l.length_v;
    put(l.center, corner + (u + v) * 0.5);
    l.radius = float(length(u + v));
    l.two_sided = 1;
    for (float& r : l.radiance) r = 1;
    return l;
}

/// Solid angle of a rectangle, by adding its parts' cosines over squared distances.
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
    {{0, 0, 0}, {-1, -1, 2}, {2, 0, 0}, {0, 2, 0}},                // in front
    {{0, 0, 0}, {1, 2, 0.5}, {3, 0, 0}, {0, 0.5, 0}},              // aside and near
    {{0, 0, 0}, {-5, -5, 0.3}, {10, 0, 0}, {0, 10, 0}},            // nearly half of all directions
    {{1, 2, 3}, {2, 2, 4}, {1, 1, 0}, {0, 0, 2}},                  // turned
    {{278, 0, 200}, {213, 554, 227}, {130, 0, 0}, {0, 0, 105}},    // the Cornell box's lamp from its floor: far
    {{278, 450, 200}, {213, 554, 227}, {130, 0, 0}, {0, 0, 105}},  // and from near below
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
        // Cells of the rectangle; each expects its share of the solid angle, or of the area.
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

/// The mean of inverse_pdf * cosine-free light over samples is the solid angle; checks kinds sampled by area.
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
    LightRecord l = rectangle_light({1, -1, 2}, {2, 0, 0}, {0, 1, 1});
    l.kind = std::uint32_t(LightRecordKind::parallelogram);
    put(l.edge_u, {2, 0, 0}), put(l.edge_v, {0, 1, 1});
    EXPECT_NEAR(estimate_solid_angle(l, p) / solid_angle({0, 0, 0}, {1, -1, 2}, {2, 0, 0}, {0, 1, 1}), 1, 0.005);

    LightRecord triangle = l;
    triangle.kind = std::uint32_t(LightRecordKind::triangle);
    triangle.area = l.area / 2;
    // Van Oosterom and Strackee 1983.
    const Vec3d a{1, -1, 2}, b{3, -1, 2}, c{1, 0, 3};
    const double la = length(a), lb = length(b), lc = length(c);
    const double exact =
        2 * std::atan2(std::abs(dot(a, cross(b, c))), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(a, c) * lb);
    EXPECT_NEAR(estimate_solid_angle(triangle, p) / exact, 1, 0.005);

    LightRecord disk;
    disk.kind = std::uint32_t(LightRecordKind::disk);
    put(disk.position, {0, 0, 2}), put(disk.normal, {0, 0, -1});
    disk.radius = 1.5f;
    disk.area = float(std::numbers::pi * 2.25);
    EXPECT_NEAR(estimate_solid_angle(disk, p) / (2 * std::numbers::pi * (1 - 2 / 2.5)), 1, 0.005);

    LightRecord sphere;
    sphere.kind = std::uint32_t(LightRecordKind::sphere);
    put(sphere.position, {0, 3, 4});
    sphere.radius = 3;
    EXPECT_NEAR(estimate_solid_angle(sphere, p) / (2 * std::numbers::pi * (1 - 0.8)), 1, 1e-5);
}

TEST(Sphere, SamplesLieOnItAndInTheConeOfDirections)
{
    LightRecord table;
    table.kind = std::uint32_t(LightRecordKind::sphere);
    put(table.position, {0, 3, 4});
    const LightReader<false> light(&table, UInt(0u));
    for (float radius : {1e-3f, 0.5f, 4.9f}) {
        table.radius = radius;
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

TEST(Sphere, FromInsideEveryDirectionIsAlikeAndTheRightSideShows)
{
    LightRecord table;
    table.kind = std::uint32_t(LightRecordKind::sphere);
    table.radius = -10;  // shines inwards
    const LightReader<false> light(&table, UInt(0u));
    EXPECT_NEAR(estimate_solid_angle(table, Vec3(Float(1), Float(2), Float(3))), 4 * std::numbers::pi, 1e-3);
    table.radius = 10;  // shines outwards only: dark inside
    EXPECT_EQ(estimate_solid_angle(table, Vec3(Float(1), Float(2), Float(3))), 0);
}

}  // namespace
}  // namespace fathom
