#pragma once
#include <cstdint>

#include "fathom/export.h"

namespace fathom {

/// Bytes that this process can still take without swapping or being killed: what the machine has free, limited by the
/// process's own limits and its container's. The largest number if that can't be known.
FATHOM_API std::uint64_t available_memory_bytes();

}  // namespace fathom
