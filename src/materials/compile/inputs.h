// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Conversion of a material's inputs to members of records.
#include <algorithm>

#include "fathom/description.h"
#include "materials/records.h"

namespace fathom {

inline Rgb spectrum(Color c)
{
    return {c.r, c.g, c.b};
}
inline std::uint32_t texture_id(int index)
{
    return index < 0 ? no_index : std::uint32_t(index);
}
inline NumberRecord number(const FloatInput& input)
{
    return {input.value, texture_id(input.texture), std::uint32_t(input.channel)};
}
inline ColorRecord color(const ColorInput& input)
{
    return {spectrum(input.value), texture_id(input.texture)};
}

inline float max_of(const Color& c)
{
    return std::max({c.r, c.g, c.b});
}
inline bool is_positive(const FloatInput& input)
{
    return input.value > 0;
}
inline bool is_positive(const ColorInput& input)
{
    return max_of(input.value) > 0;
}
inline bool is_white(const ColorInput& input)
{
    return input.texture < 0 && input.value == Color{1, 1, 1};
}
inline bool is_one(const FloatInput& input)
{
    return input.texture < 0 && input.value == 1;
}
/// Whether any of the inputs has a texture.
inline bool is_textured(const auto&... inputs)
{
    return ((inputs.texture != no_index) || ...);
}

/// Sets the base color of a record.
inline void set_base_color(const ColorInput& input, MaterialRecord& t)
{
    t.base_color = spectrum(input.value);
    t.base_texture = texture_id(input.texture);
}
/// Sets a member of a closure's record and its texture.
inline void set_number(const FloatInput& input, float& value, NumberTexture& texture, MaterialRecord& t)
{
    value = input.value;
    texture = {texture_id(input.texture), std::uint32_t(input.channel)};
    t.features.add(MaterialFeature::textured, input.texture >= 0);
}
/// Bits of namespace facets for a material with microfacets.
inline std::uint32_t facet_flags(const Material& m)
{
    return (m.microfacets.beckmann ? facets::beckmann : 0) | (m.microfacets.separable_masking ? facets::separable : 0) |
           (m.microfacets.energy_compensation ? facets::compensated : 0);
}
/// Sets the color of reflections of a GlassRecord or PlasticRecord.
template <class Record>
void set_reflection_color(const ColorInput& input, Record& record, MaterialRecord& t)
{
    if (is_white(input)) return;
    record.flags |= Record::tinted;
    record.reflection_color = spectrum(input.value);
    record.reflection_color_texture = texture_id(input.texture);
    t.features.add(MaterialFeature::needs_uv, input.texture >= 0);
}

}  // namespace fathom
