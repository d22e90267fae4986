#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <memory>
#include <vector>

namespace fathom {

/// vector::reserve, on large pages where the system has them: to touch a hundred megabytes for the first time by pages
/// of 4 KB takes longer than to read them from a file.
template <class T>
void reserve_large(std::vector<T>& values, std::size_t count)
{
    values.reserve(count);
    void* begin = values.data();
    std::size_t bytes = count * sizeof(T);
    if (!std::align(std::size_t(sysconf(_SC_PAGESIZE)), std::size_t(4) << 20, begin, bytes)) return;
    // Advice: whether it is taken does not matter.
    madvise(begin, bytes, MADV_HUGEPAGE);
}

}  // namespace fathom
