#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "fathom/description.h"

namespace fathom::mitsuba {

/// Mitsuba's own file of many meshes, each deflated by itself.
class SerializedFile {
public:
    /// Throws Error naming the file if it is none.
    SerializedFile(std::string file, std::string bytes);

    std::size_t count() const { return offsets_.size(); }
    /// v of uv grows as in the file. Throws Error if the file is damaged there.
    Mesh mesh(std::size_t index) const;

private:
    std::string file_, bytes_;
    std::vector<std::uint64_t> offsets_;  ///< of the deflated data of each
    std::vector<std::uint64_t> ends_;
    std::vector<int> versions_;
};

}  // namespace fathom::mitsuba
