// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstring>

#include "kernel/tables.h"

namespace fathom {

/// A 64-bit hash of bytes, equal on all machines of one byte order; not cryptographic.
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

/// Hashes of all scene data that affect the image, apart from camera and settings. They are kept by part, so that an
/// edit hashes only what changed.
struct Fingerprints {
    std::uint64_t vertices = 0;   ///< positions, normals and tangents
    std::uint64_t contents = 0;   ///< other geometry, in object space and world space
    std::uint64_t materials = 0;  ///< including all images
    std::uint64_t places = 0;     ///< instances and lights, including the environment

    std::uint64_t all() const;
};
/// Hash of positions, normals, tangents and vertex times.
std::uint64_t fingerprint_vertices(const GeometryTables& tables);
/// Hash of all other geometry.
std::uint64_t fingerprint_geometry(const GeometryTables& tables);
/// Hash of materials, media, textures and images.
std::uint64_t fingerprint_materials(const SceneTables& tables);
/// Hash of shapes, instances, poses, lights and environment parameters.
std::uint64_t fingerprint_instances(const SceneTables& tables);

}  // namespace fathom
