// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tables of the parameters of materials, textures and lights. Reading, checking and writing of files, their schema,
/// appending of scenes and compiling are derived from these tables (material_table.h, texture_table.h).
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

#include "fathom/description.h"

namespace fathom {

/// Accessor of a value inside of an Owner, which may be nested in a group of it. field<> makes one.
template <class Owner, class T>
struct Field {
    T& (*mutable_value)(Owner&);
    const T& (*const_value)(const Owner&);

    T& operator()(Owner& owner) const { return mutable_value(owner); }
    const T& operator()(const Owner& owner) const { return const_value(owner); }
    bool operator==(const Field&) const = default;
};

/// Makes the Field of a member: field<&Material::roughness>, or field<&Material::coat, &Material::Coat::roughness>.
template <auto Member, auto... Inner>
inline constexpr auto field = []<class Owner, class T>(T Owner::*) {
    using Value = std::remove_cvref_t<decltype(((std::declval<Owner&>().*Member).*....*Inner))>;
    return Field<Owner, Value>{[](Owner& owner) -> Value& { return ((owner.*Member).*....*Inner); },
                               [](const Owner& owner) -> const Value& { return ((owner.*Member).*....*Inner); }};
}(Member);

/// A parameter that refers to a texture by index; -1 refers to none.
template <class Owner>
struct TextureReference : Field<Owner, int> {};
/// A parameter that refers to an image by index; -1 refers to none.
template <class Owner>
struct ImageReference : Field<Owner, int> {};
/// A parameter that refers to a material by index; -1 refers to none.
template <class Owner>
struct MaterialReference : Field<Owner, int> {};
/// A parameter that refers to a measured BRDF by index; -1 refers to none.
template <class Owner>
struct MeasuredReference : Field<Owner, int> {};

/// A parameter of materials, textures or lights (Owner) that some of their kinds have.
template <class Owner>
struct Parameter {
    using Member =
        std::variant<Field<Owner, ColorInput>, Field<Owner, FloatInput>, Field<Owner, Color>, Field<Owner, float>,
                     Field<Owner, double>, Field<Owner, int>, Field<Owner, bool>, Field<Owner, Vec2f>,
                     Field<Owner, Vec3d>, Field<Owner, Transform>, Field<Owner, AlphaMode>, Field<Owner, Wrap>,
                     Field<Owner, ColorSpace>, Field<Owner, TextureMapping>, Field<Owner, SpotFalloff>,
                     Field<Owner, FovAxis>, Field<Owner, std::vector<RampStop>>, TextureReference<Owner>,
                     ImageReference<Owner>, MaterialReference<Owner>, MeasuredReference<Owner>>;
    static constexpr double unbounded = std::numeric_limits<double>::infinity();

    const char* key;      ///< key in scene files
    std::uint32_t kinds;  ///< one bit for each kind that has the parameter
    Member member;
    const char* meaning;                          ///< description in one line, with the unit if there is one
    double least = -unbounded, most = unbounded;  ///< range of the number, or of each channel
    double unit = 1;                              ///< factor from the unit in files to that of the description
    std::span<const char* const> words = {};      ///< names of enumerators or choices in scene files, in order
    const char* excess = nullptr;                 ///< reason why a value above `most` is wrong, for the message
    bool required = false,
         default_by_use = false;   ///< default_by_use: whether the default depends on where the owner is used
    bool excludes_limits = false;  ///< whether `least` and `most` themselves are invalid

    bool is_of(std::uint32_t kind) const { return kinds >> kind & 1; }
    /// Whether a number of the file is in range. Angles that were converted from floats may exceed it by rounding.
    bool allows(double value) const
    {
        if (excludes_limits) return value > least && value < most;
        return value >= least && value <= (unit == 1 ? most : most * (1 + 1e-6));
    }
};

/// A kind of material, texture or light with its name in scene files.
template <class Kind>
struct KindName {
    Kind kind;
    const char* name;
    const char* meaning;
};

/// Bit set of some kinds, for Parameter::kinds.
template <class... Kind>
constexpr std::uint32_t kind_bits(Kind... kinds)
{
    return ((1u << std::uint32_t(kinds)) | ... | 0u);
}

/// A copy of the owner in which parameters that its kind lacks have their defaults: the part that a file can express.
template <class Owner>
Owner parameters_of_kind(const Owner& owner, std::span<const Parameter<Owner>> parameters)
{
    Owner own;
    own.name = owner.name;
    own.kind = owner.kind;
    for (const Parameter<Owner>& p : parameters)
        if (p.is_of(std::uint32_t(owner.kind))) std::visit([&](auto member) { member(own) = member(owner); }, p.member);
    return own;
}

/// Calls f(int& index, key) once for each texture that a material or texture refers to, whatever its kind.
template <class Owner, class F>
void for_each_texture(Owner& owner, std::span<const Parameter<std::remove_const_t<Owner>>> parameters, F&& f)
{
    using Plain = std::remove_const_t<Owner>;
    for (const Parameter<Plain>& p : parameters) {
        // Kinds may list the same member separately under different names.
        const auto is_same = [&](const Parameter<Plain>& q) { return q.member == p.member; };
        if (std::any_of(parameters.data(), &p, is_same)) continue;
        if (const auto* color = std::get_if<Field<Plain, ColorInput>>(&p.member))
            f((*color)(owner).texture, p.key);
        else if (const auto* number = std::get_if<Field<Plain, FloatInput>>(&p.member))
            f((*number)(owner).texture, p.key);
        else if (const auto* texture = std::get_if<TextureReference<Plain>>(&p.member))
            f((*texture)(owner), p.key);
    }
}

}  // namespace fathom
