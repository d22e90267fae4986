// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "fathom/error.h"

namespace fathom {

namespace {

/// Limit on the count of accessors without data (all zeros), which the file's size doesn't bound.
constexpr std::size_t max_zeros = 100'000'000;

enum ComponentType { s8 = 5120, u8 = 5121, s16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

std::size_t component_size(const JsonValue& v, int type)
{
    switch (type) {
        case s8:
        case u8:
            return 1;
        case s16:
        case u16:
            return 2;
        case u32:
        case f32:
            return 4;
        default:
            v.fail(fmt::format("{} is not a component type", type));
    }
}

struct ElementShape {
    const char* name;
    int columns, rows;
};
constexpr ElementShape shapes[] = {{"SCALAR", 1, 1}, {"VEC2", 1, 2}, {"VEC3", 1, 3}, {"VEC4", 1, 4},
                                   {"MAT2", 2, 2},   {"MAT3", 3, 3}, {"MAT4", 4, 4}};

template <class T>
T load(const char* p)
{
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
}

/// Position of components in an element of the file.
struct ElementLayout {
    int columns, rows;
    std::size_t column_stride;  ///< distance in bytes
};

template <class T, bool normalized>
float to_unit_float(T stored)
{
    const auto value = float(stored);
    if constexpr (normalized) return std::max(value / float(std::numeric_limits<T>::max()), -1.0f);
    return value;
}

/// Converts elements; the type is a template parameter to keep the loop free of branches.
template <class T, bool normalized>
void convert_elements(const char* data, std::size_t stride, std::size_t count, ElementLayout layout, FloatElements to)
{
    const int have = std::min(layout.columns * layout.rows, to.components);
    for (std::size_t i = 0; i < count; ++i, data += stride, to.values += to.components) {
        for (int k = 0; k < have; ++k) {
            const char* p =
                data + std::size_t(k / layout.rows) * layout.column_stride + std::size_t(k % layout.rows) * sizeof(T);
            to.values[k] = to_unit_float<T, normalized>(load<T>(p));
        }
        for (int k = have; k < to.components; ++k) to.values[k] = to.fill;
    }
}

/// Specialization for vectors, whose components are adjacent: the common case, unrolled.
template <class T, bool normalized, int have>
void convert_vectors(const char* data, std::size_t stride, std::size_t count, FloatElements to)
{
    for (std::size_t i = 0; i < count; ++i, data += stride, to.values += to.components) {
        T values[have];
        std::memcpy(values, data, sizeof values);
        for (int k = 0; k < have; ++k) to.values[k] = to_unit_float<T, normalized>(values[k]);
        for (int k = have; k < to.components; ++k) to.values[k] = to.fill;
    }
}

}  // namespace

Accessor::Accessor(GltfFile& file, const JsonValue& index)
{
    const JsonValue v = file.follow("accessors", index);
    file_ = file.name();
    place_ = v.place();
    for (const char* key : {"componentType", "count", "type"})
        if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    component_type_ = v["componentType"].integer();
    const std::size_t size = component_size(v["componentType"], component_type_);
    count_ = v["count"].count();
    if (count_ == 0) v["count"].fail("must be at least 1");

    const JsonValue type = v["type"];
    const ElementShape* shape = std::find_if(std::begin(shapes), std::end(shapes),
                                             [&](const ElementShape& s) { return s.name == type.string(); });
    if (shape == std::end(shapes)) type.fail("must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    columns_ = shape->columns;
    rows_ = shape->rows;
    // Matrix columns are aligned to 4 bytes.
    column_stride_ = std::size_t(rows_) * size;
    if (columns_ > 1) column_stride_ = (column_stride_ + 3) / 4 * 4;
    element_size_ = std::size_t(columns_ - 1) * column_stride_ + std::size_t(rows_) * size;
    if (const auto normalized = v.get("normalized")) normalized_ = normalized->boolean();
    if (component_type_ == f32 || component_type_ == u32) normalized_ = false;

    if (const DecodedAccessor* decoded = file.decoded(index.count())) {
        use(*decoded, v);
        return;
    }
    const std::size_t offset = v.has("byteOffset") ? v["byteOffset"].count() : 0;
    if (const auto view = v.get("bufferView")) {
        check_range(v, file.buffer_view(*view), offset, count_, element_size_, elements_);
    } else if (count_ > max_zeros) {
        v["count"].fail(fmt::format("{} elements without a bufferView are too many", count_));
    }
    if (const auto sparse = v.get("sparse")) read_sparse(file, *sparse);
}

void Accessor::use(const DecodedAccessor& decoded, const JsonValue& v)
{
    if (decoded.count != count_ || decoded.components != components())
        v.fail(fmt::format("has {} elements of {} components, but its compressed data has {} of {}", count_,
                           components(), decoded.count, decoded.components));
    const bool is_index = decoded.values.empty();
    component_type_ = is_index ? u32 : f32;
    normalized_ = false;
    columns_ = 1, rows_ = decoded.components;
    element_size_ = 4 * std::size_t(rows_);
    const void* data = is_index ? static_cast<const void*>(decoded.indices.data()) : decoded.values.data();
    elements_ = {static_cast<const char*>(data), element_size_};
}

void Accessor::check_range(const JsonValue& v, GltfFile::View view, std::size_t offset, std::size_t count,
                           std::size_t size, Source& out) const
{
    const std::size_t stride = view.stride ? view.stride : (columns_ > 1 ? (size + 3) / 4 * 4 : size);
    const std::size_t bytes = view.bytes.size();
    if (view.stride != 0 && view.stride < size)
        v.fail(fmt::format("elements of {} bytes overlap: the view's stride is {}", size, view.stride));
    // The comparison is arranged so that it can't overflow.
    if (offset > bytes || size > bytes - offset || (count - 1) > (bytes - offset - size) / stride)
        v.fail(fmt::format("{} elements of {} bytes from offset {} on do not fit into the view's {} bytes", count, size,
                           offset, bytes));
    out = {view.bytes.data() + offset, stride};
}

void Accessor::read_sparse(GltfFile& file, const JsonValue& v)
{
    for (const char* key : {"count", "indices", "values"})
        if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    const std::size_t count = v["count"].count();
    if (count == 0 || count > count_) v["count"].fail(fmt::format("must be 1 to {}, found {}", count_, count));

    const JsonValue indices = v["indices"], values = v["values"];
    for (const JsonValue* part : {&indices, &values})
        if (!part->has("bufferView")) part->fail("key 'bufferView' is missing");
    const auto offset = [](const JsonValue& part) { return part.has("byteOffset") ? part["byteOffset"].count() : 0; };
    check_range(values, file.buffer_view(values["bufferView"]), offset(values), count, element_size_, sparse_values_);

    if (!indices.has("componentType")) indices.fail("key 'componentType' is missing");
    const int type = indices["componentType"].integer();
    if (type != u8 && type != u16 && type != u32) indices["componentType"].fail("must be an unsigned integer");
    const std::size_t size = component_size(indices["componentType"], type);
    Source source;
    check_range(indices, file.buffer_view(indices["bufferView"]), offset(indices), count, size, source);
    sparse_indices_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const char* p = source.data + i * source.stride;
        const std::uint32_t index = type == u8    ? load<std::uint8_t>(p)
                                    : type == u16 ? load<std::uint16_t>(p)
                                                  : load<std::uint32_t>(p);
        if (index >= count_)
            indices.fail(fmt::format("index {} is out of range: there are {} elements", index, count_));
        sparse_indices_[i] = index;
    }
}

void Accessor::convert(Source source, std::size_t first, std::size_t count, FloatElements to) const
{
    if (!source.data) {
        const int have = std::min(components(), to.components);
        for (std::size_t i = 0; i < count; ++i, to.values += to.components) {
            std::fill(to.values, to.values + have, 0.0f);
            std::fill(to.values + have, to.values + to.components, to.fill);
        }
        return;
    }
    const char* data = source.data + first * source.stride;
    if (component_type_ == f32 && columns_ == 1 && rows_ == to.components && source.stride == element_size_) {
        std::memcpy(to.values, data, count * element_size_);
        return;
    }
    const auto run = [&]<class T, bool normalized>() {
        if (columns_ != 1 || rows_ > to.components)
            return convert_elements<T, normalized>(data, source.stride, count, {columns_, rows_, column_stride_}, to);
        switch (rows_) {
            case 1:
                return convert_vectors<T, normalized, 1>(data, source.stride, count, to);
            case 2:
                return convert_vectors<T, normalized, 2>(data, source.stride, count, to);
            case 3:
                return convert_vectors<T, normalized, 3>(data, source.stride, count, to);
            default:
                return convert_vectors<T, normalized, 4>(data, source.stride, count, to);
        }
    };
    const auto run_integer = [&]<class T>() {
        if (normalized_)
            run.template operator()<T, true>();
        else
            run.template operator()<T, false>();
    };
    switch (component_type_) {
        case s8:
            return run_integer.operator()<std::int8_t>();
        case u8:
            return run_integer.operator()<std::uint8_t>();
        case s16:
            return run_integer.operator()<std::int16_t>();
        case u16:
            return run_integer.operator()<std::uint16_t>();
        case u32:
            return run.operator()<std::uint32_t, false>();
        default:
            return run.operator()<float, false>();
    }
}

void Accessor::read(std::size_t first, std::size_t count, int to_components, float fill, float* out) const
{
    convert(elements_, first, count, {out, to_components, fill});
    for (std::size_t i = 0; i < sparse_indices_.size(); ++i) {
        const std::size_t index = sparse_indices_[i];
        if (index < first || index - first >= count) continue;
        convert(sparse_values_, i, 1, {out + (index - first) * std::size_t(to_components), to_components, fill});
    }
}

std::vector<std::uint32_t> Accessor::read_indices() const
{
    if (components() != 1) fail("indices must be SCALAR");
    if (normalized_) fail("indices can't be normalized");
    std::vector<std::uint32_t> indices(count_);
    const auto copy = [&]<class T>(Source source, std::size_t i) {
        return source.data ? std::uint32_t(load<T>(source.data + i * source.stride)) : 0u;
    };
    const auto run = [&]<class T>() {
        for (std::size_t i = 0; i < count_; ++i) indices[i] = copy.template operator()<T>(elements_, i);
        for (std::size_t i = 0; i < sparse_indices_.size(); ++i)
            indices[sparse_indices_[i]] = copy.template operator()<T>(sparse_values_, i);
    };
    switch (component_type_) {
        case u8:
            run.operator()<std::uint8_t>();
            break;
        case u16:
            run.operator()<std::uint16_t>();
            break;
        case u32:
            run.operator()<std::uint32_t>();
            break;
        default:
            fail("indices must be unsigned integers");
    }
    return indices;
}

void Accessor::fail(const std::string& message) const
{
    throw Error(file_, place_, message);
}

}  // namespace fathom
