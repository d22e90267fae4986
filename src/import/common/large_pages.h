#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <vector>

namespace fathom {

/// vector::reserve, on large pages where the system has them: to touch a hundred megabytes for the first time by pages
/// of 4 KB takes longer than to read them from a file.
template <class T>
void reserve_large(std::vector<T>& values, std::size_t count)
{
    values.reserve(count);
    const auto page = std::uintptr_t(sysconf(_SC_PAGESIZE));
    const auto begin = (reinterpret_cast<std::uintptr_t>(values.data()) + page - 1) / page * page;
    const auto end = reinterpret_cast<std::uintptr_t>(values.data() + count) / page * page;
    // Advice: whether it is taken does not matter.
    if (end > begin + (std::uintptr_t(4) << 20)) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace fathom
