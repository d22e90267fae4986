// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "formats/io/chunked_array.h"
#include "formats/mesh/vertex_index.h"

namespace fathom {

/// Resolved indices of a face corner.
struct ObjVertex {
    static constexpr std::uint32_t none = ~0u;
    static constexpr std::uint32_t missing = ~0u - 1;  ///< index of a normal that the file refers to but doesn't define
    std::uint32_t position, uv, normal;
};

/// A growing mesh: the faces of one object with one material. Faces with and without normals are separate parts.
struct ObjPart {
    std::uint32_t number = 0;  ///< number of this part in the file
    std::string name;
    int material = -1;
    bool has_normals = false, has_uvs = false, has_colors = false;
    ChunkedArray<std::uint32_t> indices;

    /// Vertices are numbered in order of their first use.
    std::size_t vertices() const { return positions_.size(); }
    ObjVertex vertex(std::size_t i) const
    {
        if (i >= more_.size()) return {positions_[i], ObjVertex::none, ObjVertex::none};
        return {positions_[i], more_[i].uv, more_[i].normal};
    }

private:
    friend class VertexJoin;
    struct More {
        std::uint32_t uv = ObjVertex::none, normal = ObjVertex::none;
        std::uint32_t next = ObjVertex::none;  ///< the next vertex with the same position
    };

    ChunkedArray<std::uint32_t> positions_;
    ChunkedArray<More> more_;  ///< shorter than positions_ if the last vertices have positions only
    VertexIndex others_;       ///< vertices that a position alone doesn't identify
    ChunkedArray<std::uint32_t> other_vertices_;
};

/// Merges equal vertices. Each position remembers its first vertex, which keeps vertices in the order of the file; a
/// hash table is needed only for positions that are shared by several parts or have many vertices.
class VertexJoin {
public:
    /// Returns the number of the vertex within the part; new vertices are added.
    ///
    /// positions  number of positions defined so far
    std::uint32_t operator()(ObjPart& part, ObjVertex v, std::size_t positions)
    {
        if (v.position >= first_.size()) first_.resize(positions, {});
        First& first = first_[v.position];
        if (first.vertex == ObjVertex::none) {
            first = {part.number, add(part, v)};
            return first.vertex;
        }
        if (first.part != part.number) return find_by_hash(part, v);
        std::uint32_t at = first.vertex;
        for (int steps = 0; steps < max_steps; ++steps) {
            const ObjVertex there = part.vertex(at);
            if (there.uv == v.uv && there.normal == v.normal) return at;
            // Vertex `at` differs from v, so one of them has a uv or a normal: more_ covers `at`, or add() extends it
            // that far.
            const std::uint32_t next = at < part.more_.size() ? part.more_[at].next : ObjVertex::none;
            if (next == ObjVertex::none && steps + 1 < max_steps) {
                const std::uint32_t added = add(part, v);
                part.more_[at].next = added;
                return added;
            }
            if (next == ObjVertex::none) break;
            at = next;
        }
        return find_by_hash(part, v);
    }

private:
    struct First {
        std::uint32_t part = ObjVertex::none, vertex = ObjVertex::none;
    };
    /// Length limit of the linked list of vertices that share a position.
    static constexpr int max_steps = 8;

    static std::uint32_t add(ObjPart& part, ObjVertex v)
    {
        const std::size_t n = part.vertices();
        part.positions_.push_back(v.position);
        if (v.uv != ObjVertex::none || v.normal != ObjVertex::none) {
            part.more_.resize(n, {});
            part.more_.push_back({v.uv, v.normal, ObjVertex::none});
        }
        part.has_uvs |= v.uv != ObjVertex::none;
        return std::uint32_t(n);
    }
    static std::uint32_t find_by_hash(ObjPart& part, ObjVertex v)
    {
        const std::uint32_t key = part.others_({v.position, v.uv, v.normal});
        if (key == part.other_vertices_.size()) part.other_vertices_.push_back(add(part, v));
        return part.other_vertices_[key];
    }

    ChunkedArray<First> first_;  ///< first vertex of each position
};

}  // namespace fathom
