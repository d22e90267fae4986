#pragma once
/// Sampling of lights by lanes, and the density with which a light's point would have been sampled.
#include "geometry/ray.h"
#include "light/records.h"
#include "light/rectangle.h"
#include "math/gather_member.h"
#include "sampling/warp.h"
#include "shading/spectrum.h"

namespace fathom::inline FATHOM_LANES {

/// Below this solid angle a rectangle is sampled by area: it is then nearly flat as seen from the point, and float
/// angles would no longer tell its parts apart.
inline constexpr float min_solid_angle = 1e-3f;

/// Lanes that see a rectangle from nearer than its diagonal is long. From farther away its parts look nearly alike, and
/// sampling it by area is as good as by solid angle for a third of the work (docs/performance.md).
template <class Light>
Mask sees_rectangle_large(const Light& light, Vec3 p)
{
    const Vec3 to_center = light.center() - p;
    return dot(to_center, to_center) < light.radius() * light.radius();
}

/// A light of each lane, read from the table.
///
/// one  all lanes have light 0: nothing is gathered
template <bool one>
class LightReader {
public:
    LightReader(const LightRecord* table, UInt index)
        : base_(reinterpret_cast<const float*>(table)), offset_(index << 5)
    {
    }
    UInt kind() const { return integer(&LightRecord::kind); }
    Float pmf() const { return value(&LightRecord::pmf); }
    Vec3 position() const { return vector(&LightRecord::position); }
    Vec3 edge_u() const { return vector(&LightRecord::edge_u); }
    Vec3 edge_v() const { return vector(&LightRecord::edge_v); }
    Vec3 normal() const { return vector(&LightRecord::normal); }
    Vec3 center() const { return vector(&LightRecord::center); }
    Vec3 motion() const { return vector(&LightRecord::motion); }
    Float length_u() const { return value(&LightRecord::length_u); }
    Float length_v() const { return value(&LightRecord::length_v); }
    Float area() const { return value(&LightRecord::area); }
    Float radius() const { return value(&LightRecord::radius); }
    Float outer() const { return value(&LightRecord::outer); }
    Float falloff() const { return value(&LightRecord::falloff); }
    UInt two_sided() const { return integer(&LightRecord::two_sided); }
    UInt material() const { return integer(&LightRecord::material); }
    UInt primitive() const { return integer(&LightRecord::primitive); }
    Spectrum radiance() const
    {
        const std::size_t first = detail::word_of(&LightRecord::radiance);
        Spectrum s;
        for (std::size_t i = 0; i < channels; ++i) s.c[i] = word(first + i);
        return s;
    }

private:
    Float word(std::size_t number) const
    {
        if constexpr (one)
            return Float(base_[number]);
        else
            return gather(base_ + number, offset_);
    }
    Float value(float LightRecord::* member) const { return word(detail::word_of(member)); }
    UInt integer(std::uint32_t LightRecord::* member) const { return float_bits(word(detail::word_of(member))); }
    Vec3 vector(float (LightRecord::*member)[3]) const
    {
        const std::size_t first = detail::word_of(member);
        return {word(first), word(first + 1), word(first + 2)};
    }

    const float* base_;
    UInt offset_;
};

struct LightSample {
    Vec3 wi;  ///< unit, from the point towards the light
    Float distance;
    Float inverse_pdf;  ///< of the direction, per solid angle, without the choice of the light; 1 for delta lights;
                        ///< 0: nothing arrives
    Spectrum radiance;  ///< that arrives if nothing blocks it (delta lights: irradiance at normal incidence)
    Mask is_delta;      ///< no direction that a surface chooses meets it: the sample counts in full
};

inline Mask is_kind(UInt kind, LightRecordKind wanted)
{
    return kind == UInt(std::uint32_t(wanted));
}

namespace detail {

/// A point of a flat light: `to` is the vector to it. Its inverse density per solid angle is inverse_pdf if given, else
/// that of uniform sampling of the area.
struct FlatLightPoint {
    Vec3 wi;
    Float distance, inverse_pdf, cosine;

    [[gnu::always_inline]] FlatLightPoint(Vec3 to, Vec3 n, Float area)
    {
        const Float distance2 = dot(to, to), inverse = inverse_sqrt(distance2);
        distance = distance2 * inverse;
        wi = to * inverse;
        cosine = -dot(wi, n);
        inverse_pdf = abs(cosine) * area * inverse * inverse;
    }
    void put(Mask m, LightSample& s, Float& cos_light) const
    {
        s.wi = select(m, wi, s.wi);
        s.distance = select(m, distance, s.distance);
        s.inverse_pdf = select(m, inverse_pdf, s.inverse_pdf);
        cos_light = select(m, cosine, cos_light);
    }
};

/// The part of sample_rectangle for lanes that see it large; what it returns is right for all lanes.
template <class Light>
[[gnu::noinline]] FlatLightPoint sample_large_rectangle(const Light& light, Vec3 corner, Sample2 random, Mask large)
{
    const Vec3 u = light.edge_u(), v = light.edge_v(), n = light.normal();
    const Float length_u = light.length_u(), length_v = light.length_v();
    const SphericalRectangle seen(corner, u, v, n, length_u, length_v);
    const SphericalRectangle::Point point = seen.sample(random);
    const Mask by_angle = large & (seen.solid_angle >= Float(min_solid_angle));
    const Float du = select(by_angle, point.x - seen.x0, random.x * length_u);
    const Float dv = select(by_angle, point.y - seen.y0, random.y * length_v);
    FlatLightPoint s(fma(u, du, fma(v, dv, corner)), n, light.area());
    s.inverse_pdf = select(by_angle, seen.solid_angle, s.inverse_pdf);
    return s;
}

template <class Light>
[[gnu::always_inline]] inline FlatLightPoint sample_rectangle(const Light& light, Vec3 p, Sample2 random, Mask active)
{
    const Vec3 n = light.normal();
    const Vec3 corner = light.position() - p;
    // Those behind a light that shines to one side need no good sample.
    const Mask large =
        active & sees_rectangle_large(light, p) & ((light.two_sided() != UInt(0)) | (dot(corner, n) < Float(0)));
    if (any(large)) return sample_large_rectangle(light, corner, random, large);
    const Vec3 to =
        fma(light.edge_u(), random.x * light.length_u(), fma(light.edge_v(), random.y * light.length_v(), corner));
    return FlatLightPoint(to, n, light.area());
}

}  // namespace detail

/// 1 - cos of the half angle under which a sphere is seen: r^2 / d^2 = sin^2, kept exact for small ones.
inline Float one_minus_cos_of(Float sin2)
{
    return sin2 / (Float(1) + sqrt(max(Float(1) - sin2, Float(0))));
}

/// sample_light for lights that are not all rectangles.
template <class Light>
[[gnu::noinline]] LightSample sample_any_light(const Light& light, Vec3 p, Float time, Sample2 random, Mask active)
{
    LightSample s;
    s.radiance = light.radiance();
    s.is_delta = Mask(false);
    const UInt kind = light.kind();
    const Mask two_sided = light.two_sided() != UInt(0);
    const Mask rectangle = is_kind(kind, LightRecordKind::rectangle);
    s.wi = {Float(0), Float(0), Float(1)};
    s.distance = Float(1);
    s.inverse_pdf = Float(1);
    Float cos_light = Float(1);
    if (any(rectangle)) detail::sample_rectangle(light, p, random, active & rectangle).put(rectangle, s, cos_light);
    const Mask parallelogram = is_kind(kind, LightRecordKind::parallelogram);
    if (any(parallelogram)) {
        const Vec3 q = fma(light.edge_u(), random.x, fma(light.edge_v(), random.y, light.position()));
        detail::FlatLightPoint(q - p, light.normal(), light.area()).put(parallelogram, s, cos_light);
    }
    const Mask triangle = is_kind(kind, LightRecordKind::triangle);
    if (any(triangle)) {
        // Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
        const Mask upper = random.y > random.x;
        const Float half = Float(0.5f) * select(upper, random.x, random.y);
        const Float u = select(upper, half, random.x - half), v = select(upper, random.y - half, half);
        const Vec3 q = fma(light.edge_u(), u, fma(light.edge_v(), v, light.position()));
        detail::FlatLightPoint(q - p, light.normal(), light.area()).put(triangle, s, cos_light);
    }
    const Mask disk = is_kind(kind, LightRecordKind::disk);
    if (any(disk)) {
        const DiskPoint d = sample_disk(random);
        const Frame frame(light.normal());
        const Vec3 q = fma(frame.s, d.x * light.radius(), fma(frame.t, d.y * light.radius(), light.position()));
        detail::FlatLightPoint(q - p, light.normal(), light.area()).put(disk, s, cos_light);
    }
    const Mask sphere = is_kind(kind, LightRecordKind::sphere);
    if (any(sphere)) {
        const Vec3 to_center = fma(light.motion(), time, light.position()) - p;
        const Float d2 = dot(to_center, to_center), r = abs(light.radius());
        const Float sin2 = r * r / d2;
        const Mask outside = sin2 < Float(1);
        // From inside the whole sphere of directions is uniform.
        const Float spread = select(outside, one_minus_cos_of(min(sin2, Float(1))), Float(2));
        const Vec3 local = sample_cone(random, spread);
        const Vec3 wi = Frame(normalize(to_center)).to_world(local);
        // Distance to the sphere along wi.
        const Float b = dot(to_center, wi);
        const Vec3 foot = to_center - wi * b;
        const Float root = sqrt(max(fma(r, r, -dot(foot, foot)), Float(0)));
        s.wi = select(sphere, wi, s.wi);
        s.distance = select(sphere, select(outside, b - root, b + root), s.distance);
        s.inverse_pdf = select(sphere, Float(2 * pi) * spread, s.inverse_pdf);
        // The normal points outwards for a positive radius: seen from outside, it faces the point.
        const Float side = select(outside, Float(1), Float(-1));
        cos_light = select(sphere, flip_sign(side, light.radius()), cos_light);
    }
    const Mask point = is_kind(kind, LightRecordKind::point), spot = is_kind(kind, LightRecordKind::spot);
    if (any(point | spot)) {
        const Vec3 to = light.position() - p;
        const Float distance2 = dot(to, to), distance = sqrt(distance2);
        const Vec3 wi = to * (Float(1) / distance);
        Float strength = Float(1) / distance2;
        // Linear in the cosine from the outer to the inner cone, squared as KHR_lights_punctual suggests. 1 - cos is
        // half the square of the chord, which keeps its digits where the cosine is nearly 1.
        const Vec3 chord = wi + light.edge_u();
        const Float inside = fma(dot(chord, chord), Float(-0.5f), light.outer());
        const Float x = clamp(inside / max(light.falloff(), Float(1e-30f)), Float(0), Float(1));
        strength = select(spot, strength * x * x, strength);
        s.wi = select(point | spot, wi, s.wi);
        s.distance = select(point | spot, distance, s.distance);
        s.radiance = select(point | spot, s.radiance * strength, s.radiance);
        s.is_delta |= point | spot;
    }
    const Mask directional = is_kind(kind, LightRecordKind::directional);
    if (any(directional)) {
        // radius holds 1 - cos of the disk's half angle; 0 is a delta. radiance holds irradiance or radiance
        // accordingly. The disk is nothing that a ray can hit.
        const Float spread = light.radius();
        const Vec3 wi = Frame(-light.edge_u()).to_world(sample_cone(random, spread));
        const Mask delta = spread <= Float(0);
        s.wi = select(directional, wi, s.wi);
        s.distance = select(directional, Float(infinity), s.distance);
        s.inverse_pdf = select(directional, select(delta, Float(1), Float(2 * pi) * spread), s.inverse_pdf);
        s.is_delta |= directional;
    }
    s.inverse_pdf = select((cos_light > Float(0)) | two_sided, s.inverse_pdf, Float(0));
    return s;
}

/// Samples a point of the light as seen from p, at shutter time `time`. What other lanes than the active ones get is of
/// no use.
template <class Light>
[[gnu::always_inline]] inline LightSample sample_light(const Light& light, Vec3 p, Float time, Sample2 random,
                                                       Mask active)
{
    if (!all(is_kind(light.kind(), LightRecordKind::rectangle)))
        return sample_any_light(light, p, time, random, active);
    const auto point = detail::sample_rectangle(light, p, random, active);
    LightSample s;
    s.wi = point.wi;
    s.distance = point.distance;
    s.inverse_pdf = select((point.cosine > Float(0)) | (light.two_sided() != UInt(0)), point.inverse_pdf, Float(0));
    s.radiance = light.radiance();
    s.is_delta = Mask(false);
    return s;
}

namespace detail {

/// The densities of those lanes that see a rectangle or sphere by solid angle; of the others, `by_area`.
template <class Light>
[[gnu::noinline]] Float pdf_by_angle(const Light& light, Vec3 p, Float time, Float by_area, Mask large, Mask sphere)
{
    Float pdf = by_area;
    if (any(large)) {
        const SphericalRectangle seen(light.position() - p, light.edge_u(), light.edge_v(), light.normal(),
                                      light.length_u(), light.length_v());
        const Mask by_angle = large & (seen.solid_angle >= Float(min_solid_angle));
        pdf = select(by_angle, reciprocal(seen.solid_angle), pdf);
    }
    if (any(sphere)) {
        const Vec3 to_center = fma(light.motion(), time, light.position()) - p;
        const Float r = light.radius();
        const Float sin2 = r * r / dot(to_center, to_center);
        const Float spread = select(sin2 < Float(1), one_minus_cos_of(min(sin2, Float(1))), Float(2));
        pdf = select(sphere, Float(0.5f * inv_pi) / spread, pdf);
    }
    return pdf;
}

}  // namespace detail

/// The density per solid angle, seen from p, with which sample_light would have found the point at p + distance * wi of
/// an emissive surface; without the probability of choosing the light. For the active lanes.
template <class Light>
[[gnu::always_inline]] inline Float pdf_light(const Light& light, Vec3 p, Float time, Vec3 wi, Float distance,
                                              Mask active)
{
    const UInt kind = light.kind();
    const Float cosine = abs(dot(wi, light.normal()));
    const Float pdf = distance * distance * reciprocal(max(cosine * light.area(), Float(1e-30f)));
    const Mask large = active & is_kind(kind, LightRecordKind::rectangle) & sees_rectangle_large(light, p);
    const Mask sphere = active & is_kind(kind, LightRecordKind::sphere);
    return any(large | sphere) ? detail::pdf_by_angle(light, p, time, pdf, large, sphere) : pdf;
}

}  // namespace fathom::inline FATHOM_LANES
