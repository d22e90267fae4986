#pragma once
#include <cstdint>
#include <cstring>

#include "kernel/tables.h"

namespace fathom {

/// A 64-bit hash of bytes, the same on every machine of one byte order; not for adversaries.
class Fingerprint {
public:
    void add(const void* bytes, std::size_t size)
    {
        const auto* p = static_cast<const unsigned char*>(bytes);
        for (; size >= 8; p += 8, size -= 8) {
            std::uint64_t word;
            std::memcpy(&word, p, 8);
            mix(word);
        }
        std::uint64_t rest = size;
        for (; size > 0; ++p, --size) rest = rest << 8 | *p;
        mix(rest);
    }
    template <class T, class Allocator>
    void add(const std::vector<T, Allocator>& v)
    {
        add(v.data(), v.size() * sizeof(T));
    }
    std::uint64_t value() const { return state_; }

private:
    void mix(std::uint64_t word)
    {
        state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
        state_ ^= state_ >> 32;
    }
    std::uint64_t state_ = 0x243f6a8885a308d3u;
};

/// Of all that decides a picture beside camera and settings, part by part: what has not changed need not be read again.
struct Fingerprints {
    std::uint64_t vertices = 0;   ///< where they are, normals and tangents
    std::uint64_t contents = 0;   ///< what else makes shapes, in spaces of their own and in the world
    std::uint64_t materials = 0;  ///< with all pictures
    std::uint64_t places = 0;     ///< instances and lights, the environment's among them

    std::uint64_t all() const;
};
std::uint64_t fingerprint_vertices(const GeometryTables& tables);
std::uint64_t fingerprint_contents(const GeometryTables& tables);
std::uint64_t fingerprint_materials(const SceneTables& tables);
std::uint64_t fingerprint_places(const SceneTables& tables);

}  // namespace fathom
