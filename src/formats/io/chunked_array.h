// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "formats/io/large_pages.h"

namespace fathom {

/// Allocator that maps large blocks directly, so that freeing them returns their memory to the system.
template <class T>
struct PageAllocator {
    using value_type = T;
    PageAllocator() = default;
    template <class U>
    PageAllocator(const PageAllocator<U>&)
    {
    }
    T* allocate(std::size_t n)
    {
        if (n * sizeof(T) < least) return std::allocator<T>().allocate(n);
        void* const data = mmap(nullptr, n * sizeof(T), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (data == MAP_FAILED) throw std::bad_alloc();
        return static_cast<T*>(data);
    }
    void deallocate(T* p, std::size_t n)
    {
        if (n * sizeof(T) < least)
            std::allocator<T>().deallocate(p, n);
        else
            munmap(p, n * sizeof(T));
    }
    bool operator==(const PageAllocator&) const { return true; }

private:
    static constexpr std::size_t least = 128 << 10;
};

/// An array that grows without reallocation: unlike std::vector it never holds twice its size in memory.
template <class T>
class ChunkedArray {
public:
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T& operator[](std::size_t i) { return chunks_[i >> bits][i & (chunk - 1)]; }
    const T& operator[](std::size_t i) const { return chunks_[i >> bits][i & (chunk - 1)]; }

    void push_back(const T& value)
    {
        if (size_ % chunk == 0) add_chunk();
        chunks_.back().push_back(value);
        ++size_;
    }
    void append(std::span<const T> values)
    {
        while (!values.empty()) {
            if (size_ % chunk == 0) add_chunk();
            const auto part = values.first(std::min(values.size(), chunk - chunks_.back().size()));
            chunks_.back().insert(chunks_.back().end(), part.begin(), part.end());
            size_ += part.size();
            values = values.subspan(part.size());
        }
    }
    void resize(std::size_t size, const T& value)
    {
        while (size_ < size) push_back(value);
    }
    /// Moves the contents into one contiguous vector and leaves this array empty.
    std::vector<T> take()
    {
        std::vector<T> result;
        reserve_large(result, size_);
        for (Chunk& part : chunks_) {
            result.insert(result.end(), part.begin(), part.end());
            part = {};
        }
        chunks_.clear();
        size_ = 0;
        return result;
    }

private:
    using Chunk = std::vector<T, PageAllocator<T>>;
    static constexpr unsigned bits = 16;
    static constexpr std::size_t chunk = std::size_t(1) << bits;

    void add_chunk()
    {
        chunks_.emplace_back();
        // The first chunk grows geometrically, because many arrays are short.
        if (chunks_.size() > 1) chunks_.back().reserve(chunk);
    }

    std::vector<Chunk> chunks_;  ///< all chunks are full except the last
    std::size_t size_ = 0;
};

}  // namespace fathom
