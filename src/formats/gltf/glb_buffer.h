// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/json/json_text.h"

namespace fathom {

/// The binary chunk of a GLB file with its buffer views and accessors as glTF JSON.
class GlbBuffer {
public:
    /// The target of a buffer view, by glTF's codes.
    enum class Use { anything = 0, vertices = 34962, indices = 34963 };

    /// Appends a buffer view and returns its index. Throws Error if the chunk exceeds the size limit of GLB.
    int add_view(const void* bytes, std::size_t size, Use use);
    /// Appends a vertex attribute of 2 to 4 floats per vertex and returns the accessor's index.
    ///
    /// with_bounds  whether to store min and max, which positions must have
    int add_vertices(const float* values, std::size_t count, int components, bool with_bounds = false);
    /// Appends triangle indices and returns the accessor's index.
    int add_indices(const std::vector<std::uint32_t>& indices);

    const std::string& bytes() const { return bytes_; }
    const Json& views() const { return views_; }
    const Json& accessors() const { return accessors_; }

private:
    std::string bytes_;
    Json views_ = Json::array(), accessors_ = Json::array();
};

}  // namespace fathom
