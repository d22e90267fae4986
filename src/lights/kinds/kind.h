// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interface of light kinds. A kind is a class with
///     using Record                                                its record (records.h)
///     static LightPoint sample(light, p, time, random, active)    a point of it as seen from p, with its density
/// and, if rays can hit it and it is not sampled uniformly by area in all lanes,
///     static Mask by_solid_angle(light, p)                        lanes that are sampled in another way
///     static Float pdf(light, p, time, by_area)                   density in those lanes, by_area in the others
/// and, if it can move with an instance of its primitive or with its node,
///     static void place(MovingLight&, const LightPlace&, Mask m)  transforms its record to render space
/// light: a LightReader, or a MovingLight in scenes where lights move.
#include <cstddef>

#include "geometry/motion.h"
#include "geometry/ray.h"
#include "lights/kinds/records.h"
#include "math/gather_member.h"
#include "math/spectrum.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Reads the light of each lane from the table.
///
/// one  all lanes have light 0: members are broadcast instead of gathered
template <bool one>
class LightReader {
public:
    LightReader(const LightRecord* table, UInt index)
        : base_(reinterpret_cast<const float*>(table)), offset_(index << 5)
    {
    }
    UInt kind() const { return integer(&LightRecord::kind); }
    Float pmf() const { return word(detail::word_of(&LightRecord::pmf)); }
    Mask has(LightRecord::Flags flag) const { return (integer(&LightRecord::flags) & UInt(flag)) != UInt(0); }
    UInt material() const { return integer(&LightRecord::material); }
    UInt primitive() const { return integer(&LightRecord::primitive); }
    UInt tree_place() const { return integer(&LightRecord::tree_place); }
    UInt instance() const { return integer(&LightRecord::instance); }
    UInt motion_flags() const { return integer(&LightRecord::motion); }
    Spectrum radiance() const
    {
        Spectrum s;
        words(detail::word_of(&LightRecord::radiance), s.c);
        return s;
    }

    /// Returns a member of the record of a kind. In lanes of other kinds, the value is meaningless.
    template <class Own>
    Float get(float Own::* member) const
    {
        return word(own_word + detail::word_of(member));
    }
    template <class Own>
    UInt get(std::uint32_t Own::* member) const
    {
        return float_bits(word(own_word + detail::word_of(member)));
    }
    template <class Own>
    Vec3 get(float (Own::*member)[3]) const
    {
        Float row[3];
        words(own_word + detail::word_of(member), row);
        return {row[0], row[1], row[2]};
    }

protected:
    /// Loads the record of each lane's kind.
    void load_own(Float (&to)[LightRecord::own_words]) const
    {
        constexpr int row_words = 3;
        static_assert(LightRecord::own_words % row_words == 0);
        for (std::size_t i = 0; i < LightRecord::own_words; i += row_words) {
            Float row[row_words];
            words(own_word + i, row);
            for (std::size_t k = 0; k < row_words; ++k) to[i + k] = row[k];
        }
    }

private:
    static constexpr std::size_t own_word = offsetof(LightRecord, own) / sizeof(float);

    Float word(std::size_t number) const
    {
        if constexpr (one)
            return Float(base_[number]);
        else
            return gather(base_ + number, offset_);
    }
    template <int n>
    void words(std::size_t first, Float (&to)[n]) const
    {
        if constexpr (one)
            for (std::size_t i = 0; i < n; ++i) to[i] = Float(base_[first + i]);
        else
            gather_row(base_ + first, offset_, to);
    }
    UInt integer(std::uint32_t LightRecord::* member) const { return float_bits(word(detail::word_of(member))); }

    const float* base_;
    UInt offset_;
};

/// Transform of a moving light from the space of its record to render space, at a shutter time.
struct LightPlace {
    Affine to_render;
    Affine to_object;  ///< inverse of the transform; set for instances of primitives only
    Float time;
};

/// A point of a light, sampled by its kind.
struct LightPoint {
    Vec3 wi;  ///< unit, from the shading point towards the light
    Float distance;
    Float inverse_pdf;  ///< inverse density of wi, with respect to solid angle; 1 for delta lights
    Float cosine;       ///< positive where the light's front faces the shading point
    Float strength;     ///< factor of the light's radiance
    Mask is_delta;      ///< rays can't hit the light: MIS weight 1
};

/// Normalizes a vector. Zero stays zero, since a light without a normal emits nothing.
inline Vec3 unit_or_zero(const Vec3& v)
{
    return v * inverse_sqrt(max(dot(v, v), Float(1e-37f)));
}

/// A ray that a light emits, sampled by its kind.
struct EmittedRay {
    Vec3 o, d;
    Vec3 n;       ///< normal of the surface on the side that emits; 0 for lights without a surface
    Float scale;  ///< factor of the light's radiance: power per inverse density; 0: nothing is emitted
    Float pdf;    ///< density of d with respect to solid angle, for kinds that can be aimed
};
/// Densities of the rays that a kind emits.
struct EmissionDensity {
    /// With respect to area and solid angle, divided by the cosine at the light; for lights without a surface with
    /// respect to area across the ray where it arrives.
    Float ray;
    /// EmittedRay::pdf, for kinds that can be aimed. Curved surfaces assume a mean cosine.
    Float direction;
};

/// Factor of the cosine in the density of directions from one side of a surface or from both.
inline Float inverse_range(Mask two_sided)
{
    return select(two_sided, Float(0.5f * inv_pi), Float(inv_pi));
}
/// A ray from a point of a surface, by a density proportional to the cosine; from either side if two_sided.
inline EmittedRay emit_from_surface(const Vec3& p, const Vec3& normal, Float area, Mask two_sided, Sample2 direction)
{
    const Mask back = two_sided & (direction.x < Float(0.5f));
    const Float doubled = direction.x * Float(2);
    direction.x = select(two_sided, select(back, doubled, doubled - Float(1)), direction.x);
    const Vec3 n = flip_sign(normal, select(back, Float(-1), Float(1)));
    const Vec3 d = Frame(n).to_world(sample_cosine_hemisphere(direction));
    return {p, d, n, area * select(two_sided, Float(2 * pi), Float(pi)), dot(n, d) * inverse_range(two_sided)};
}
inline EmittedRay select(Mask m, const EmittedRay& a, const EmittedRay& b)
{
    return {select(m, a.o, b.o), select(m, a.d, b.d), select(m, a.n, b.n), select(m, a.scale, b.scale),
            select(m, a.pdf, b.pdf)};
}
/// Whether a kind has aim(light, ray, d), which changes the direction of a ray of emit().
template <class Kind, class Light>
concept can_be_aimed = requires(const Light& light, EmittedRay& ray, const Vec3& d) { Kind::aim(light, ray, d); };

/// Changes the direction of a ray of emit_from_surface().
inline void aim_from_surface(EmittedRay& ray, const Vec3& d, Mask two_sided)
{
    ray.d = d;
    ray.n = select(two_sided, flip_sign(ray.n, dot(ray.n, d)), ray.n);
    const Float cosine = dot(ray.n, d);
    ray.scale = select(cosine > Float(0), ray.scale, Float(0));
    ray.pdf = max(cosine, Float(0)) * inverse_range(two_sided);
}
/// Cosine at the light in EmissionDensity::direction of curved surfaces, in place of that of the ray.
inline constexpr float mean_cosine = 0.5f;
/// Densities of emit_from_surface(). cosine: at the light.
inline EmissionDensity surface_emission_density(Float area, Mask two_sided, Float cosine)
{
    const Float inverse = inverse_range(two_sided);
    return {inverse / max(area, Float(1e-30f)), abs(cosine) * inverse};
}

namespace detail {

/// Transforms the normal of a flat light.
template <class Moving>
void place_normal(Moving& light, const LightPlace& at, Mask m)
{
    light.set(&FlatLightRecord::normal,
              unit_or_zero(at.to_object.transposed_vector(light.get(&FlatLightRecord::normal))), m);
}

/// A point of a flat light, sampled uniformly by area. `to`: vector from the shading point to it.
struct FlatLightPoint {
    Vec3 wi;
    Float distance, inverse_pdf, cosine;

    template <class Light>
    [[gnu::always_inline]] FlatLightPoint(Vec3 to, const Light& light)
        : FlatLightPoint(to, light.get(&FlatLightRecord::normal), light.get(&FlatLightRecord::area))
    {
    }
    [[gnu::always_inline]] FlatLightPoint(Vec3 to, Vec3 n, Float area)
    {
        const Float distance2 = dot(to, to), inverse = inverse_sqrt(distance2);
        distance = distance2 * inverse;
        wi = to * inverse;
        cosine = -dot(wi, n);
        inverse_pdf = abs(cosine) * area * inverse * inverse;
    }
    operator LightPoint() const { return {wi, distance, inverse_pdf, cosine, Float(1), Mask(false)}; }
};

/// Emission of a flat light from a point of it.
template <class Light>
EmittedRay emit_from_flat(const Light& light, const Vec3& p, Sample2 direction)
{
    return emit_from_surface(p, light.get(&FlatLightRecord::normal), light.get(&FlatLightRecord::area),
                             light.has(LightRecord::two_sided), direction);
}
template <class Light>
EmissionDensity flat_emission_density(const Light& light, const Vec3& wi)
{
    return surface_emission_density(light.get(&FlatLightRecord::area), light.has(LightRecord::two_sided),
                                    dot(light.get(&FlatLightRecord::normal), wi));
}
template <class Light>
void aim_from_flat(const Light& light, EmittedRay& ray, const Vec3& d)
{
    aim_from_surface(ray, d, light.has(LightRecord::two_sided));
}

}  // namespace detail

}  // namespace FATHOM_LANES
}  // namespace fathom
