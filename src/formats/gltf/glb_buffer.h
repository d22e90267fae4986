#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/json/json_text.h"

namespace fathom {

/// The binary chunk of a GLB file, with the views into it and the accessors to those, as glTF's JSON has them.
class GlbBuffer {
public:
    /// What a view is for, by glTF's numbers.
    enum class Use { anything = 0, vertices = 34962, indices = 34963 };

    /// Returns the view's index. Throws Error if the chunk would be too large for a GLB file.
    int add_view(const void* bytes, std::size_t size, Use use);
    /// Columns of floats of vertices: 2 to 4 of each. with_bounds: as positions must have. Returns the accessor's
    /// index.
    int add_vertices(const float* values, std::size_t count, int components, bool with_bounds = false);
    int add_indices(const std::vector<std::uint32_t>& indices);

    const std::string& bytes() const { return bytes_; }
    const Json& views() const { return views_; }
    const Json& accessors() const { return accessors_; }

private:
    std::string bytes_;
    Json views_ = Json::array(), accessors_ = Json::array();
};

}  // namespace fathom
