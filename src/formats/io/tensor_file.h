// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// A file of named arrays in the format of the RGL material database: a header of names, types and shapes, then the
/// numbers.
class TensorFile {
public:
    /// Element types by their codes in the file.
    enum class Type : std::uint8_t { uint8 = 1, float32 = 10 };
    struct Field {
        std::uint8_t type = 0;
        std::vector<std::uint64_t> shape;
        std::string_view bytes;  ///< the numbers, a view into the file
    };

    /// Parses the header. `bytes` must outlive this object. Throws Error if the file is damaged or truncated.
    ///
    /// name  name of the file, for messages
    TensorFile(std::string name, std::string_view bytes);

    /// The array of that name; null if it is missing.
    const Field* find(const std::string& name) const;
    /// An array of 32-bit floats. Throws Error if it is missing, empty, or of another type or number of dimensions.
    const Field& floats(const std::string& name, std::size_t dimensions) const;
    /// The numbers of an array of 32-bit floats.
    static std::vector<float> values(const Field& field);

    [[noreturn]] void fail(const std::string& place, const std::string& message) const;

private:
    std::string name_;
    std::map<std::string, Field> fields_;
};

}  // namespace fathom
