#pragma once
#include "media/distance.h"
#include "media/records.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The media that a path is in: Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images".
///
/// Up to four numbers of media, of 16 bits each, those of greater priority first, of equal ones the one that was
/// entered last; 0 where there are fewer. So the first is the medium that is there. Of more than four the last are
/// forgotten.
class MediumStack {
public:
    MediumStack() : low_(0u), high_(0u) {}
    MediumStack(UInt low, UInt high) : low_(low), high_(high) {}
    UInt low() const { return low_; }
    UInt high() const { return high_; }

    /// The medium that is there.
    UInt current() const { return low_ & UInt(0xffffu); }

    /// Lanes that are in the medium, whether or not another one is there; it is none of those numbered 0.
    Mask contains(UInt medium) const
    {
        UInt in[entries];
        read(in);
        Mask found(false);
        for (UInt one : in) found |= one == medium;
        return found & (medium != UInt(0u));
    }

    /// With one more medium.
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
    /// Without the medium, or the same if it is not among them: the path began inside.
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

inline Float medium_ior(const MediaTables& tables, UInt medium, Mask m)
{
    return gather(tables.media, &MediumRecord::ior, medium, m);
}

/// A boundary of a solid as a path meets it that is in the media of a stack.
struct MediumBoundary {
    MediumStack beyond;  ///< where the path is if it passes
    Float other_ior;     ///< of what lies on the solid's other side
    Mask is_there;       ///< else the medium is the same on both sides, and the path goes straight on

    /// medium: of the solid; entering: from outside. For the lanes of m.
    MediumBoundary(const MediaTables& tables, const MediumStack& stack, UInt medium, Mask entering, Mask m)
        : beyond(select(entering, stack.entered(tables, medium, m), stack.left(medium)))
    {
        // Whoever leaves what they never entered began inside: it is as if they were in it till now.
        const Mask never = (beyond.low() == stack.low()) & (beyond.high() == stack.high());
        const MediumStack in = select(entering | never, stack.entered(tables, medium, m), stack);
        const MediumStack out = select(entering, stack, beyond);
        is_there = (in.current() == medium) & (out.current() != medium);
        other_ior = medium_ior(tables, out.current(), m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
