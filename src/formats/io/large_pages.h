// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <memory>
#include <vector>

namespace fathom {

/// Reserves memory on large pages where the system has them: the page faults of 100 MB in pages of 4 KB take longer
/// than reading the file.
template <class T>
void reserve_large(std::vector<T>& values, std::size_t count)
{
    values.reserve(count);
    void* begin = values.data();
    std::size_t bytes = count * sizeof(T);
    if (!std::align(std::size_t(sysconf(_SC_PAGESIZE)), std::size_t(4) << 20, begin, bytes)) return;
    // The kernel may ignore this advice, so the result is not checked.
    madvise(begin, bytes, MADV_HUGEPAGE);
}

}  // namespace fathom
