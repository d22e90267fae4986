// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Writes a binary PLY file of vertices with triangles or curves. It refers to the vectors given to it, which must
/// outlive it.
class PlyFile {
public:
    /// Adds one property for each name, from the components of the vectors; an empty vector adds none.
    void add_vertices(std::vector<const char*> names, const std::vector<Vec2f>& v) { add(std::move(names), v); }
    void add_vertices(std::vector<const char*> names, const std::vector<Vec3f>& v) { add(std::move(names), v); }
    void add_vertices(std::vector<const char*> names, const std::vector<Vec4f>& v) { add(std::move(names), v); }
    void add_vertices(std::vector<const char*> names, const std::vector<float>& v) { add(std::move(names), v); }
    void set_triangles(const std::vector<std::uint32_t>& indices) { triangles_ = &indices; }
    void set_curves(const std::vector<std::uint32_t>& counts) { curves_ = &counts; }

    /// Writes the file. Throws Error.
    void write(const std::filesystem::path& file) const;

private:
    struct Column {
        const char* name;
        const char* data;
        std::size_t stride;
    };
    template <class T>
    void add(std::vector<const char*> names, const std::vector<T>& v)
    {
        if (v.empty()) return;
        count_ = v.size();
        for (std::size_t i = 0; i < names.size(); ++i)
            columns_.push_back({names[i], reinterpret_cast<const char*>(v.data()) + i * sizeof(float), sizeof(T)});
    }
    std::string header() const;

    std::size_t count_ = 0;
    std::vector<Column> columns_;
    const std::vector<std::uint32_t>* triangles_ = nullptr;
    const std::vector<std::uint32_t>* curves_ = nullptr;
};

}  // namespace fathom
