// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interface of light kinds. A kind is a class with
///     static constexpr LightRecordKind kind
///     static LightPoint sample(light, p, time, random, active)   a point of it as seen from p, with its density
/// and, if rays can hit it and it is not sampled uniformly by area in all lanes,
///     static Mask by_solid_angle(light, p)            lanes that are sampled in another way
///     static Float pdf(light, p, time, by_area) density in those lanes, by_area in the others
/// light: a LightReader.
#include "geometry/ray.h"
#include "lights/records.h"
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
    Float pmf() const { return value(&LightRecord::pmf); }
    Vec3 position() const { return vector(&LightRecord::position); }
    Vec3 edge_u() const { return vector(&LightRecord::edge_u); }
    Vec3 edge_v() const { return vector(&LightRecord::edge_v); }
    Vec3 normal() const { return vector(&LightRecord::normal); }
    /// Center of a rectangle.
    Vec3 center() const { return vector(&LightRecord::motion_or_center); }
    /// Velocity of a sphere.
    Vec3 motion() const { return vector(&LightRecord::motion_or_center); }
    Float length_u() const { return value(&LightRecord::length_u); }
    Float length_v() const { return value(&LightRecord::length_v); }
    Float area() const { return value(&LightRecord::area); }
    Float radius() const { return value(&LightRecord::radius); }
    Float outer() const { return value(&LightRecord::outer); }
    Float falloff() const { return value(&LightRecord::falloff); }
    Mask has(LightRecord::Flags flag) const { return (integer(&LightRecord::flags) & UInt(flag)) != UInt(0); }
    UInt material() const { return integer(&LightRecord::material); }
    UInt primitive() const { return integer(&LightRecord::primitive); }
    UInt tree_place() const { return integer(&LightRecord::tree_place); }
    UInt instance() const { return integer(&LightRecord::instance); }
    UInt motion_flags() const { return integer(&LightRecord::motion); }
    Spectrum radiance() const
    {
        const std::size_t first = detail::word_of(&LightRecord::radiance);
        Spectrum s;
        words(first, s.c);
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
    template <int n>
    void words(std::size_t first, Float (&to)[n]) const
    {
        if constexpr (one)
            for (std::size_t i = 0; i < n; ++i) to[i] = Float(base_[first + i]);
        else
            gather_row(base_ + first, offset_, to);
    }
    Float value(float LightRecord::* member) const { return word(detail::word_of(member)); }
    UInt integer(std::uint32_t LightRecord::* member) const { return float_bits(word(detail::word_of(member))); }
    Vec3 vector(float (LightRecord::*member)[3]) const
    {
        const std::size_t first = detail::word_of(member);
        Float row[3];
        words(first, row);
        return {row[0], row[1], row[2]};
    }

    const float* base_;
    UInt offset_;
};

/// A point of a light, sampled by its kind.
struct LightPoint {
    Vec3 wi;  ///< unit, from the shading point towards the light
    Float distance;
    Float inverse_pdf;  ///< of wi, with respect to solid angle; 1 for delta lights
    Float cosine;       ///< positive where the light's front faces the shading point
    Float strength;     ///< factor of the light's radiance
    Mask is_delta;      ///< rays can't hit the light: MIS weight 1
};

namespace detail {

/// A point of a flat light, sampled uniformly by area. `to`: vector from the shading point to it.
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
    operator LightPoint() const { return {wi, distance, inverse_pdf, cosine, Float(1), Mask(false)}; }
};

}  // namespace detail

}  // namespace FATHOM_LANES
}  // namespace fathom
