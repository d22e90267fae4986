// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace fathom {

/// A set of values of an enum class whose values are below 32. Testing a value takes one instruction.
template <class E>
struct EnumSet {
    std::uint32_t bits = 0;  ///< bit n: the value n is in the set

    constexpr EnumSet() = default;
    constexpr EnumSet(E value) : bits(1u << std::uint32_t(value)) {}

    constexpr bool has(E value) const { return has_any(value); }
    constexpr bool has_any(EnumSet of) const { return (bits & of.bits) != 0; }
    /// Adds the value if `wanted` is true.
    constexpr void add(E value, bool wanted = true) { bits |= wanted ? EnumSet(value).bits : 0; }
    constexpr void remove(E value) { bits &= ~EnumSet(value).bits; }

    constexpr EnumSet& operator|=(EnumSet other)
    {
        bits |= other.bits;
        return *this;
    }
    friend constexpr EnumSet operator|(EnumSet a, EnumSet b) { return a |= b; }
    friend constexpr EnumSet operator&(EnumSet a, EnumSet b)
    {
        a.bits &= b.bits;
        return a;
    }
    friend constexpr bool operator==(EnumSet a, EnumSet b) = default;
};

}  // namespace fathom
