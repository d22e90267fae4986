// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tables of the parameters of materials, textures and lights. Reading, checking and writing of files, their schema,
/// appending of scenes and compiling are derived from these tables (material_table.h, texture_table.h).
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <variant>

#include "fathom/description.h"

namespace fathom {

/// A parameter that refers to a texture by index; -1 refers to none.
template <class Owner>
struct TextureReference {
    int Owner::* index;
    bool operator==(const TextureReference&) const = default;
};
/// A parameter that refers to an image by index; -1 refers to none.
template <class Owner>
struct ImageReference {
    int Owner::* index;
    bool operator==(const ImageReference&) const = default;
};
/// A parameter that refers to a material by index; -1 refers to none.
template <class Owner>
struct MaterialReference {
    int Owner::* index;
    bool operator==(const MaterialReference&) const = default;
};

/// A parameter that refers to a measured BRDF by index; -1 refers to none.
template <class Owner>
struct MeasuredReference {
    int Owner::* index;
    bool operator==(const MeasuredReference&) const = default;
};

/// A parameter of materials, textures or lights (Owner) that some of their kinds have.
template <class Owner>
struct Parameter {
    using Member =
        std::variant<ColorInput Owner::*, FloatInput Owner::*, Color Owner::*, float Owner::*, double Owner::*,
                     int Owner::*, bool Owner::*, Vec2f Owner::*, Vec3d Owner::*, Transform Owner::*,
                     AlphaMode Owner::*, Wrap Owner::*, ColorSpace Owner::*, TextureMapping Owner::*,
                     SpotFalloff Owner::*, FovAxis Owner::*, std::vector<RampStop> Owner::*, TextureReference<Owner>,
                     ImageReference<Owner>, MaterialReference<Owner>, MeasuredReference<Owner>>;
    static constexpr double unbounded = std::numeric_limits<double>::infinity();

    const char* key;      ///< key in scene files
    std::uint32_t kinds;  ///< one bit for each kind that has the parameter
    Member member;
    const char* meaning;                            ///< one line, with the unit where there is one
    double least = -unbounded, most = unbounded;    ///< range of the number, or of each channel
    double unit = 1;                                ///< unit of the file, in units of the description
    std::span<const char* const> words = {};        ///< names of enumerators or choices in scene files, in order
    const char* excess = nullptr;                   ///< why a value above `most` is wrong, for the message
    bool required = false, default_by_use = false;  ///< default_by_use: the default depends on where it is used
    bool excludes_limits = false;                   ///< `least` and `most` themselves are not allowed

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
        if (p.is_of(std::uint32_t(owner.kind)))
            std::visit(
                [&](auto member) {
                    if constexpr (requires { member.index; })
                        own.*member.index = owner.*member.index;
                    else
                        own.*member = owner.*member;
                },
                p.member);
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
        if (const auto* color = std::get_if<ColorInput Plain::*>(&p.member))
            f((owner.*(*color)).texture, p.key);
        else if (const auto* number = std::get_if<FloatInput Plain::*>(&p.member))
            f((owner.*(*number)).texture, p.key);
        else if (const auto* texture = std::get_if<TextureReference<Plain>>(&p.member))
            f(owner.*(texture->index), p.key);
    }
}

}  // namespace fathom
