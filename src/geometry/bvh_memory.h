#pragma once
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace fathom {

/// An array of plain values that are not initialised, on large pages where the system has them: a tree of hundreds of
/// megabytes is read all over, and each small page costs a look-up.
template <class T>
class LargeArray {
public:
    LargeArray() = default;
    explicit LargeArray(std::size_t size) : size_(size)
    {
        if (size == 0) return;
        constexpr std::size_t large_page = std::size_t(2) << 20;
        const std::size_t alignment = bytes() >= large_page ? large_page : 64;
        data_ = static_cast<T*>(std::aligned_alloc(alignment, (bytes() + alignment - 1) / alignment * alignment));
        if (!data_) throw std::bad_alloc();
#if defined(__linux__)
        if (bytes() >= large_page) madvise(data_, bytes(), MADV_HUGEPAGE);
#endif
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

private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace fathom
