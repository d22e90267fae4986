// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom::mitsuba {

/// Mitsuba's binary file of several meshes, each compressed with deflate.
class SerializedFile {
public:
    /// Throws Error naming the file if it has another format.
    SerializedFile(std::string file, std::string bytes);

    std::size_t count() const { return offsets_.size(); }
    /// Decompresses a mesh; v of uv is as in the file. Throws Error if this mesh is damaged.
    Mesh mesh(std::size_t index) const;

private:
    std::string file_, bytes_;
    std::vector<std::uint64_t> offsets_;  ///< offset of each mesh's compressed data
    std::vector<std::uint64_t> ends_;
    std::vector<int> versions_;
};

}  // namespace fathom::mitsuba
