// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "media/distance.h"
#include "media/records.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Media that contain a path's position: Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images".
///
/// Up to four 16-bit indices, by descending priority; of equal priorities the one entered last is first. Unused entries
/// are 0. The first entry is the medium that applies. If there are more than four, those of lowest priority are
/// dropped.
class MediumStack {
public:
    MediumStack() : low_(0u), high_(0u) {}
    MediumStack(UInt low, UInt high) : low_(low), high_(high) {}
    UInt low() const { return low_; }
    UInt high() const { return high_; }

    /// Index of the medium that applies.
    UInt current() const { return low_ & UInt(0xffffu); }

    /// Lanes inside the medium, even if another one of higher priority applies; false for index 0.
    Mask contains(UInt medium) const
    {
        UInt in[entries];
        read(in);
        Mask found(false);
        for (UInt one : in) found |= one == medium;
        return found & (medium != UInt(0u));
    }

    /// The stack after entering a medium.
    MediumStack entered(const MediaTables& tables, UInt medium, Mask m) const
    {
        const UInt priority = priority_of(tables, medium, m);
        UInt in[entries], out[entries];
        read(in);
        Mask stays[entries];
        for (int k = 0; k < entries; ++k) stays[k] = less(priority, priority_of(tables, in[k], m));
        out[0] = select(stays[0], in[0], medium);
        for (int k = 1; k < entries; ++k) out[k] = select(stays[k], in[k], select(stays[k - 1], medium, in[k - 1]));
        return made(out);
    }
    /// The stack after leaving a medium; unchanged if it does not contain the medium, because the path started inside.
    MediumStack left(UInt medium) const
    {
        UInt in[entries], out[entries];
        read(in);
        Mask gone(false);
        for (int k = 0; k < entries; ++k) {
            gone |= in[k] == medium;
            out[k] = select(gone, k + 1 < entries ? in[k + 1] : UInt(0u), in[k]);
        }
        return made(out);
    }

private:
    static constexpr int entries = 4;

    static UInt priority_of(const MediaTables& tables, UInt medium, Mask m)
    {
        return gather(tables.media, &MediumRecord::priority, medium, m);
    }
    void read(UInt* to) const
    {
        to[0] = low_ & UInt(0xffffu), to[1] = low_ >> 16;
        to[2] = high_ & UInt(0xffffu), to[3] = high_ >> 16;
    }
    static MediumStack made(const UInt* from) { return {from[0] | from[1] << 16, from[2] | from[3] << 16}; }

    UInt low_, high_;
};

inline MediumStack select(Mask m, const MediumStack& a, const MediumStack& b)
{
    return {select(m, a.low(), b.low()), select(m, a.high(), b.high())};
}

/// Index of refraction of a medium.
inline Float medium_ior(const MediaTables& tables, UInt medium, Mask m)
{
    return gather(tables.media, &MediumRecord::ior, medium, m);
}

/// The boundary of a solid for a path in the media of a stack.
struct MediumBoundary {
    MediumStack beyond;  ///< the stack beyond the boundary
    Float other_ior;     ///< index of refraction on the solid's other side
    Mask is_there;       ///< false if the same medium applies on both sides, so that the path passes unchanged

    /// medium: medium of the solid; entering: whether the path comes from outside. Both are for the lanes of m.
    MediumBoundary(const MediaTables& tables, const MediumStack& stack, UInt medium, Mask entering, Mask m)
        : beyond(select(entering, stack.entered(tables, medium, m), stack.left(medium)))
    {
        // A path that leaves a solid it never entered started inside: the stack is treated as if it contained the
        // medium.
        const Mask never = (beyond.low() == stack.low()) & (beyond.high() == stack.high());
        const MediumStack in = select(entering | never, stack.entered(tables, medium, m), stack);
        const MediumStack out = select(entering, stack, beyond);
        is_there = (in.current() == medium) & (out.current() != medium);
        other_ior = medium_ior(tables, out.current(), m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
