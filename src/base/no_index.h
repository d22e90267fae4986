#pragma once
#include <cstdint>

namespace fathom {

/// What stands in the place of an index where there is nothing.
inline constexpr std::uint32_t no_index = 0xffffffffu;

}  // namespace fathom
