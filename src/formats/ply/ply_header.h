// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/input_window.h"

namespace fathom {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class PlyFormat { ascii, little_endian, big_endian };

/// Calls f.template operator()<T>() with the C++ type of a PLY type, and returns the result.
template <class F>
decltype(auto) visit_type(PlyType type, F&& f)
{
    switch (type) {
        case PlyType::i8:
            return f.template operator()<std::int8_t>();
        case PlyType::u8:
            return f.template operator()<std::uint8_t>();
        case PlyType::i16:
            return f.template operator()<std::int16_t>();
        case PlyType::u16:
            return f.template operator()<std::uint16_t>();
        case PlyType::i32:
            return f.template operator()<std::int32_t>();
        case PlyType::u32:
            return f.template operator()<std::uint32_t>();
        case PlyType::f32:
            return f.template operator()<float>();
        default:
            return f.template operator()<double>();
    }
}

/// Size of a number in a binary file, in bytes.
inline std::size_t size_of(PlyType type)
{
    return visit_type(type, []<class T>() { return sizeof(T); });
}

/// A property of an element: a number or a list of numbers.
struct PlyProperty {
    std::string name;
    PlyType type = PlyType::f32;
    bool is_list = false;
    PlyType count_type = PlyType::u8;
};

/// An element of a PLY file, such as `vertex` or `face`.
struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;

    /// Minimum size of an element in a binary file in bytes; lists may be empty.
    std::size_t min_size() const;
    bool has_lists() const;
};

/// The parsed header; `lines` counts its lines, for messages about an ASCII body.
struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t lines = 0;
};

/// Reads the header up to the beginning of the body. Throws Error with the line number.
PlyHeader read_ply_header(const std::string& file, InputWindow& window);

}  // namespace fathom
