// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace fathom {

/// Allocates memory on large pages where the system has them; release it with std::free. Throws std::bad_alloc.
///
/// A BVH of hundreds of megabytes is accessed at random, and each small page costs a TLB miss. Large pages also make
/// the first touch of a film's buffers cheaper.
inline void* allocate_large(std::size_t bytes)
{
    constexpr std::size_t large_page = std::size_t(2) << 20;
    const std::size_t alignment = bytes >= large_page ? large_page : 64;
    void* const data = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (!data) throw std::bad_alloc();
#if defined(__linux__)
    if (bytes >= large_page) madvise(data, bytes, MADV_HUGEPAGE);
#endif
    return data;
}

/// Allocator for std::vector that uses allocate_large().
template <class T>
struct LargeAllocator {
    using value_type = T;
    LargeAllocator() = default;
    template <class U>
    LargeAllocator(const LargeAllocator<U>&)
    {
    }
    T* allocate(std::size_t n) { return static_cast<T*>(allocate_large(n * sizeof(T))); }
    void deallocate(T* p, std::size_t) { std::free(p); }
    bool operator==(const LargeAllocator&) const { return true; }
};

/// A vector on large pages, for tables that shading accesses at random.
template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

/// An allocator whose resize() leaves new elements uninitialized, so that many threads can touch the memory first.
template <class T>
struct UnsetAllocator : LargeAllocator<T> {
    template <class U>
    struct rebind {
        using other = UnsetAllocator<U>;
    };
    UnsetAllocator() = default;
    template <class U>
    UnsetAllocator(const UnsetAllocator<U>&)
    {
    }
    template <class U>
    void construct(U* p)
    {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... Arguments>
    void construct(U* p, Arguments&&... arguments)
    {
        ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
    }
};

/// A fixed-size array of trivial values on large pages; the values are not initialized.
template <class T>
class LargeArray {
public:
    LargeArray() = default;
    explicit LargeArray(std::size_t size) : size_(size)
    {
        if (size == 0) return;
        data_ = static_cast<T*>(allocate_large(bytes()));
    }
    ~LargeArray() { std::free(data_); }
    LargeArray(LargeArray&& other) noexcept { swap(other); }
    LargeArray& operator=(LargeArray&& other) noexcept
    {
        LargeArray(std::move(other)).swap(*this);
        return *this;
    }
    void swap(LargeArray& other) noexcept
    {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
    }

    T* data() { return data_; }
    const T* data() const { return data_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    std::size_t size() const { return size_; }
    std::size_t bytes() const { return size_ * sizeof(T); }
    /// Reduces the size without moving data. Pages behind the new end that were never touched take no physical memory.
    void truncate(std::size_t size) { size_ = size; }

private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace fathom
