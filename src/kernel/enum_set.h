// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace fathom {

/// A set of values of an enum class whose values are below 32. Testing a value takes one instruction.
template <class E>
class EnumSet {
public:
    constexpr bool has(E value) const { return (bits_ & bit(value)) != 0; }
    /// Adds the value if `wanted` is true.
    constexpr void add(E value, bool wanted = true) { bits_ |= wanted ? bit(value) : 0; }
    constexpr void remove(E value) { bits_ &= ~bit(value); }

private:
    static constexpr std::uint32_t bit(E value) { return 1u << std::uint32_t(value); }

    std::uint32_t bits_ = 0;
};

}  // namespace fathom
