#include "fathom/memory.h"

#include "scene/machine.h"

namespace fathom {

std::uint64_t available_memory_bytes()
{
    return memory_left("/");
}

}  // namespace fathom
