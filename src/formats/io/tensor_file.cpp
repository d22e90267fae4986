// SPDX-License-Identifier: Apache-2.0
#include "formats/io/tensor_file.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "fathom/error.h"
#include "formats/io/read_file.h"

namespace fathom {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view magic = "tensor_file\0"sv;
constexpr std::uint16_t max_dimensions = 8;

/// Bytes per number for each type code; 0 for invalid codes.
constexpr std::uint64_t type_bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

/// Reads little-endian numbers of the header; throws Error at the end of the file.
class HeaderReader {
public:
    HeaderReader(const TensorFile& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

    std::string_view text(std::size_t size)
    {
        if (size > bytes_.size() - at_) file_.fail("header", "the file ends within it");
        at_ += size;
        return bytes_.substr(at_ - size, size);
    }
    template <class T>
    T number()
    {
        const std::string_view part = text(sizeof(T));
        T value = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i) value = T(value | T(T(std::uint8_t(part[i])) << (8 * i)));
        return value;
    }

private:
    const TensorFile& file_;
    std::string_view bytes_;
    std::size_t at_ = 0;
};

}  // namespace

TensorFile::TensorFile(std::string name, std::string_view bytes) : name_(std::move(name))
{
    HeaderReader header(*this, bytes);
    if (!bytes.starts_with(magic)) fail("", "is not a tensor file, the format of the RGL material database");
    header.text(magic.size());
    const auto major = header.number<std::uint8_t>(), minor = header.number<std::uint8_t>();
    if (major != 1) fail("header", fmt::format("has version {}.{}: only 1.0 is supported", major, minor));
    const auto count = header.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string field_name(header.text(header.number<std::uint16_t>()));
        const std::string place = fmt::format("'{}'", printable(field_name));
        Field field;
        const auto dimensions = header.number<std::uint16_t>();
        field.type = header.number<std::uint8_t>();
        const auto offset = header.number<std::uint64_t>();
        if (dimensions > max_dimensions)
            fail(place, fmt::format("has {} dimensions: up to {} are supported", dimensions, max_dimensions));
        if (field.type >= std::size(type_bytes) || type_bytes[field.type] == 0)
            fail(place, fmt::format("has numbers of an unknown type, {}", field.type));
        // Sizes can't overflow, because no product may exceed the size of the file. Arrays with a dimension of 0 may
        // have any other dimensions.
        std::uint64_t size = type_bytes[field.type];
        for (int d = 0; d < dimensions; ++d) {
            field.shape.push_back(header.number<std::uint64_t>());
            if (size > 0 && field.shape.back() > bytes.size() / size)
                fail(place, "has more numbers than fit into the file");
            size *= field.shape.back();
        }
        if (offset > bytes.size() || size > bytes.size() - offset) fail(place, "ends beyond the end of the file");
        field.bytes = bytes.substr(offset, size);
        if (!fields_.emplace(field_name, std::move(field)).second) fail(place, "appears twice");
    }
}

const TensorFile::Field* TensorFile::find(const std::string& name) const
{
    const auto found = fields_.find(name);
    return found == fields_.end() ? nullptr : &found->second;
}

const TensorFile::Field& TensorFile::floats(const std::string& name, std::size_t dimensions) const
{
    const std::string place = fmt::format("'{}'", name);
    const Field* const field = find(name);
    if (!field) fail(place, "is missing");
    if (field->type != std::uint8_t(Type::float32)) fail(place, "must contain 32-bit floats");
    if (field->shape.size() != dimensions)
        fail(place, fmt::format("has {} dimensions, expected {}", field->shape.size(), dimensions));
    for (const std::uint64_t size : field->shape)
        if (size == 0) fail(place, "is empty");
    return *field;
}

std::vector<float> TensorFile::values(const Field& field)
{
    static_assert(std::endian::native == std::endian::little);
    std::vector<float> values(field.bytes.size() / sizeof(float));
    std::memcpy(values.data(), field.bytes.data(), values.size() * sizeof(float));
    return values;
}

void TensorFile::fail(const std::string& place, const std::string& message) const
{
    throw Error(name_, place, message);
}

}  // namespace fathom
