// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Reads scalar and color parameters of the record of each lane, with textures applied.
template <class Record>
class RecordInputs {
public:
    /// index: index into `records`, for the lanes of m; at: the point at which textures are evaluated
    RecordInputs(const ShadingTables& tables, const std::vector<Record>& records, const TexturePoint& at, UInt index,
                 Mask m)
        : t_(tables), records_(records), at_(at), index_(index), m_(m)
    {
    }
    /// Tells whether any of the records has textures; reading is faster if none has.
    void set_textured(bool textured) { textured_ = textured; }

    /// Returns a member of the record of each lane.
    template <class Member>
    auto get(Member Record::* member) const
    {
        return gather(records_, member, index_, m_);
    }
    template <class Member, class Part>
    auto get(Member Record::* member, Part Member::* part) const
    {
        return gather(records_, member, part, index_, m_);
    }
    /// Always inlined, because clang 19 takes many minutes to compile a call of it in the AVX-512 kernel.
    [[gnu::always_inline]] Float number(NumberRecord Record::* member) const
    {
        const Float value = get(member, &NumberRecord::value);
        Texel t;
        const Mask has = texel(member, &NumberRecord::texture, t);
        if (none(has)) return value;
        return select(has, value * t.channel(get(member, &NumberRecord::channel)), value);
    }
    Spectrum color(ColorRecord Record::* member) const
    {
        Spectrum value = get(member, &ColorRecord::value);
        Texel t;
        const Mask has = texel(member, &ColorRecord::texture, t);
        if (none(has)) return value;
        for (int c = 0; c < channels; ++c) value.c[c] = select(has, value.c[c] * t.c[c], value.c[c]);
        return value;
    }

private:
    /// Evaluates the texture of a parameter; returns the lanes that have one.
    template <class Member>
    Mask texel(Member Record::* member, std::uint32_t Member::* texture_member, Texel& t) const
    {
        if (!textured_) return Mask(false);
        const UInt texture = get(member, texture_member);
        const Mask has = m_ & (texture != UInt(no_index));
        if (any(has)) t = evaluate_textures(t_, texture, at_, has);
        return has;
    }

    const ShadingTables& t_;
    const std::vector<Record>& records_;
    const TexturePoint& at_;
    const UInt index_;
    const Mask m_;
    bool textured_ = true;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
