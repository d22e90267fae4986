#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// A file of named arrays, as the RGL's database has them: a header of names, types and shapes, and numbers behind it.
class TensorFile {
public:
    /// Types by the files' numbers.
    enum class Type : std::uint8_t { uint8 = 1, float32 = 10 };
    struct Field {
        std::uint8_t type = 0;
        std::vector<std::uint64_t> shape;
        std::string_view bytes;  ///< those of its numbers, within the file
    };

    /// name: for messages. `bytes` must outlive it. Throws Error if it is no such file, or a part of one.
    TensorFile(std::string name, std::string_view bytes);

    const Field* find(const std::string& name) const;
    /// Throws Error if it isn't there, is empty, has other dimensions or other numbers than floats of 32 bits.
    const Field& floats(const std::string& name, std::size_t dimensions) const;
    static std::vector<float> values(const Field& field);

    [[noreturn]] void fail(const std::string& place, const std::string& message) const;

private:
    std::string name_;
    std::map<std::string, Field> fields_;
};

}  // namespace fathom
