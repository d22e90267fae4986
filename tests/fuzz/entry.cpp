// SPDX-License-Identifier: Apache-2.0
// Runs one target; libFuzzer provides main().
#include <cstddef>
#include <cstdint>

#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    for (const fathom::fuzz::Target& target : fathom::fuzz::targets())
        if (target.name == FATHOM_FUZZ_TARGET) target.run({reinterpret_cast<const char*>(data), size});
    return 0;
}
