// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/gather_member.h"
#include "math/rgb.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Radiance, or a factor such as throughput, with `channels` channels in each lane.
struct Spectrum {
    Float c[channels];

    Spectrum() = default;
    explicit Spectrum(Float v)
    {
        for (Float& x : c) x = v;
    }
    explicit Spectrum(const float* table)
    {
        for (int i = 0; i < channels; ++i) c[i] = Float(table[i]);
    }
    explicit Spectrum(const Rgb& table) : Spectrum(table.data()) {}
};

inline Spectrum operator+(Spectrum a, const Spectrum& b)
{
    for (int i = 0; i < channels; ++i) a.c[i] = a.c[i] + b.c[i];
    return a;
}
inline Spectrum operator*(Spectrum a, const Spectrum& b)
{
    for (int i = 0; i < channels; ++i) a.c[i] = a.c[i] * b.c[i];
    return a;
}
inline Spectrum operator*(Spectrum a, Float s)
{
    for (Float& x : a.c) x = x * s;
    return a;
}
/// a * s + b with one rounding per channel.
inline Spectrum fma(Spectrum a, Float s, const Spectrum& b)
{
    for (int i = 0; i < channels; ++i) a.c[i] = fma(a.c[i], s, b.c[i]);
    return a;
}
inline Spectrum select(Mask m, Spectrum a, const Spectrum& b)
{
    for (int i = 0; i < channels; ++i) a.c[i] = select(m, a.c[i], b.c[i]);
    return a;
}
/// Gathers a color of records[index] for the lanes of m; 0 in other lanes.
template <class Record>
[[gnu::always_inline]] inline Spectrum gather(const std::vector<Record>& records, Rgb Record::* member, UInt index,
                                              Mask m)
{
    const float* base = reinterpret_cast<const float*>(records.data()) + detail::word_of(member);
    const UInt at = index * UInt(detail::record_words<Record>);
    Spectrum s;
    gather_row(base, at, m, s.c);
    return s;
}
/// Gathers a color that is part of a member record, for the lanes of m; 0 in other lanes.
template <class Record, class Member>
[[gnu::always_inline]] inline Spectrum gather(const std::vector<Record>& records, Member Record::* member,
                                              Rgb Member::* part, UInt index, Mask m)
{
    const float* base =
        reinterpret_cast<const float*>(records.data()) + detail::word_of(member) + detail::word_of(part);
    const UInt at = index * UInt(detail::record_words<Record>);
    Spectrum s;
    gather_row(base, at, m, s.c);
    return s;
}
inline Float min_component(const Spectrum& a)
{
    Float m = a.c[0];
    for (int i = 1; i < channels; ++i) m = min(m, a.c[i]);
    return m;
}
inline Float max_component(const Spectrum& a)
{
    Float m = a.c[0];
    for (int i = 1; i < channels; ++i) m = max(m, a.c[i]);
    return m;
}
inline Float mean(const Spectrum& a)
{
    Float sum = a.c[0];
    for (int i = 1; i < channels; ++i) sum = sum + a.c[i];
    return sum * Float(1.f / channels);
}
inline Mask any_positive(const Spectrum& a) { return max_component(a) > Float(0); }

}  // namespace FATHOM_LANES
}  // namespace fathom
