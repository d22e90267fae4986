// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "formats/gltf/container.h"

namespace fathom {

/// Memory for converted elements; components that the file lacks become `fill`.
struct FloatElements {
    float* values;
    int components;
    float fill;
};

/// An accessor of a glTF file. The constructor checks all its ranges, so that reading elements can't leave the buffer.
class Accessor {
public:
    /// index  the value in the file that refers to the accessor
    Accessor(GltfFile& file, const JsonValue& index);

    std::size_t count() const { return count_; }
    int components() const { return columns_ * rows_; }

    /// Reads elements [first, first + count) as `to_components` floats each. Missing components become `fill`, and
    /// excess components are dropped. Normalized integers become [0, 1] or [-1, 1].
    void read(std::size_t first, std::size_t count, int to_components, float fill, float* out) const;
    /// Reads all elements as unsigned integers. Throws Error if they have another type.
    std::vector<std::uint32_t> read_indices() const;

    /// Throws Error naming the accessor.
    [[noreturn]] void fail(const std::string& message) const;

private:
    struct Source {
        const char* data = nullptr;  ///< null if all elements are zero
        std::size_t stride = 0;
    };
    void use(const DecodedAccessor& decoded, const JsonValue& v);
    void check_range(const JsonValue& v, GltfFile::View view, std::size_t offset, std::size_t count, std::size_t size,
                     Source& out) const;
    void read_sparse(GltfFile& file, const JsonValue& v);
    void convert(Source source, std::size_t first, std::size_t count, FloatElements to) const;

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
