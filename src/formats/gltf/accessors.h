#pragma once
#include <cstdint>
#include <vector>

#include "formats/gltf/container.h"

namespace fathom {

/// One accessor of a glTF file, all its ranges checked: what reads elements after that cannot leave the buffer.
class Accessor {
public:
    /// index  the number in the file that refers to the accessor
    Accessor(GltfFile& file, const JsonValue& index);

    std::size_t count() const { return count_; }
    int components() const { return columns_ * rows_; }

    /// Elements [first, first + count) as `to_components` floats each; those that the accessor lacks are `fill`, those
    /// that it has beyond are left out. Normalised integers become 0 to 1 or -1 to 1.
    void read(std::size_t first, std::size_t count, int to_components, float fill, float* out) const;
    /// All elements, each cut to one unsigned integer. Throws Error if they are of another type.
    std::vector<std::uint32_t> read_indices() const;

    /// Throws Error that names the accessor.
    [[noreturn]] void fail(const std::string& message) const;

private:
    struct Source {
        const char* data = nullptr;  ///< null: zeros
        std::size_t stride = 0;
    };
    void use(const DecodedAccessor& decoded, const JsonValue& v);
    void check_range(const JsonValue& v, GltfFile::View view, std::size_t offset, std::size_t count, std::size_t size,
                     Source& out) const;
    void read_sparse(GltfFile& file, const JsonValue& v);
    void convert(Source source, std::size_t first, std::size_t count, int to_components, float fill, float* out) const;

    std::string file_, place_;
    std::size_t count_ = 0, element_size_ = 0;
    int component_type_ = 0, columns_ = 1, rows_ = 1;
    std::size_t column_stride_ = 0;
    bool normalized_ = false;
    Source elements_;
    std::vector<std::uint32_t> sparse_indices_;
    Source sparse_values_;
};

}  // namespace fathom
