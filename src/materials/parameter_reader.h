// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/records.h"
#include "math/gather_member.h"
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The leading words of the material record of each lane.
using MaterialRow = RecordRow<MaterialRecord, MaterialRecord::row_words>;

/// Reads the parameters of a closure, with textures applied: the Record that MaterialRecord::parameters holds for the
/// material of each lane.
template <class Record>
class ParameterReader {
public:
    /// material: index, for the lanes of m; textured: lanes of m whose material has MaterialFeature::textured
    ParameterReader(const ShadingTables& tables, const MaterialRow& row, const TexturePoint& at, UInt material, Mask m,
                    Mask textured)
        : t_(tables), row_(row), at_(at), material_(material), m_(m), textured_(textured)
    {
    }

    /// Lanes that are read and whose `flags` have the bit.
    [[gnu::always_inline]] Mask has_flag(std::uint32_t flag) const
    {
        return m_ & ((get(&Record::flags) & UInt(flag)) != UInt(0u));
    }
    /// Returns a member. The first words of a record were loaded with the row; others cost a gather.
    [[gnu::always_inline]] Float get(float Record::* member) const { return word(place(member)); }
    [[gnu::always_inline]] UInt get(std::uint32_t Record::* member) const { return float_bits(word(place(member))); }
    /// Returns a member times one channel of its texture, if it has one.
    [[gnu::always_inline]] Float number(float Record::* member, NumberTexture Record::* texture) const
    {
        return textured(get(member), place(texture));
    }
    /// Returns a color times its texture in the lanes of m, else 1. Most materials lack such a color, so it is not part
    /// of the row.
    [[gnu::noinline]] Spectrum color(Rgb Record::* member, std::uint32_t Record::* texture, Mask m) const
    {
        const Texel t = evaluate_textures(t_, gathered(place(texture), m), at_, m);
        Spectrum color;
        for (std::size_t c = 0; c < channels; ++c)
            color.c[c] = select(m, bits_float(gathered(place(member) + c, m)) * t.c[c], Float(1));
        return color;
    }

private:
    /// Position of a member of Record in a material's record, in words.
    template <class Member>
    [[gnu::always_inline]] static std::size_t place(Member Record::* member)
    {
        return detail::word_of(&MaterialRecord::parameters) + detail::word_of(member);
    }
    [[gnu::always_inline]] Float word(std::size_t at) const
    {
        return at < MaterialRecord::row_words ? row_.word[at] : bits_float(gathered(at, m_));
    }
    UInt gathered(std::size_t at, Mask m) const
    {
        const auto* base = reinterpret_cast<const std::uint32_t*>(t_.materials.data());
        return gather(base + at, material_ * UInt(detail::record_words<MaterialRecord>), m);
    }
    Float textured(Float value, std::size_t texture) const
    {
        if (none(textured_)) return value;
        const UInt id = gathered(texture, textured_);
        const Mask has = textured_ & (id != UInt(no_index));
        if (none(has)) return value;
        const Texel t = evaluate_textures(t_, id, at_, has);
        return select(has, value * t.channel(gathered(texture + 1, textured_)), value);
    }

    const ShadingTables& t_;
    const MaterialRow& row_;
    const TexturePoint& at_;
    const UInt material_;
    const Mask m_, textured_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
