#pragma once
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Numbers and colours that a table's records hold, textures applied.
template <class Record>
class RecordInputs {
public:
    /// index: into records, for the lanes of m; at: where on the surface
    RecordInputs(const ShadingTables& tables, const std::vector<Record>& records, const TexturePoint& at, UInt index,
                 Mask m)
        : t_(tables), records_(records), at_(at), index_(index), m_(m)
    {
    }
    /// Where none of the records has textures, all is read sooner.
    void set_textured(bool textured) { textured_ = textured; }

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
    /// Inlined, since clang 19 needs many minutes for a call of it in the kernel of AVX-512.
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
    /// Gives the lanes that have a texture.
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
