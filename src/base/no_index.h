// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace fathom {

/// Marks an absent index in compiled tables.
inline constexpr std::uint32_t no_index = 0xffffffffu;

}  // namespace fathom
