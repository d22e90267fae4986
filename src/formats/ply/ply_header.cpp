// SPDX-License-Identifier: Apache-2.0
#include "formats/ply/ply_header.h"

#include <algorithm>

#include "formats/io/text_scanner.h"

namespace fathom {

namespace {

PlyType read_type(const TextScanner& scan, std::string_view word)
{
    static const std::pair<std::string_view, PlyType> types[] = {
        {"char", PlyType::i8},   {"int8", PlyType::i8},     {"uchar", PlyType::u8},   {"uint8", PlyType::u8},
        {"short", PlyType::i16}, {"int16", PlyType::i16},   {"ushort", PlyType::u16}, {"uint16", PlyType::u16},
        {"int", PlyType::i32},   {"int32", PlyType::i32},   {"uint", PlyType::u32},   {"uint32", PlyType::u32},
        {"float", PlyType::f32}, {"float32", PlyType::f32}, {"double", PlyType::f64}, {"float64", PlyType::f64}};
    for (const auto& [name, type] : types)
        if (word == name) return type;
    scan.fail(fmt::format("'{}' is not a type", printable(word)));
}

PlyProperty read_property(TextScanner& scan)
{
    PlyProperty property;
    std::string_view word = scan.word();
    if (word == "list") {
        property.is_list = true;
        property.count_type = read_type(scan, scan.word());
        if (property.count_type == PlyType::f32 || property.count_type == PlyType::f64)
            scan.fail("the length of a list must be an integer");
        word = scan.word();
    }
    property.type = read_type(scan, word);
    property.name = scan.word();
    if (property.name.empty()) scan.fail("the property has no name");
    return property;
}

PlyFormat read_format(TextScanner& scan)
{
    const std::string_view word = scan.word();
    if (word == "ascii") return PlyFormat::ascii;
    if (word == "binary_little_endian") return PlyFormat::little_endian;
    if (word == "binary_big_endian") return PlyFormat::big_endian;
    scan.fail(fmt::format("'{}' is not a PLY format", printable(word)));
}

/// Whether header lines end with CR alone. An LF after the last CR then is the first byte of the body.
bool ends_lines_with_cr(std::string_view text)
{
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    return end + 1 < text.size() && text[end] == '\r' && text[end + 1] != '\n';
}

/// Offset behind the line `end_header`; 0 if it is missing or incomplete.
std::size_t header_end(const std::string& file, std::string_view text)
{
    TextScanner scan(file, text);
    while (!scan.at_end() && scan.word() != "end_header") scan.next_line();
    if (scan.at_end()) return 0;
    const auto word = std::size_t(scan.position() - text.data());
    return text.find(ends_lines_with_cr(text) ? '\r' : '\n', word) + 1;
}

/// A part of the file that contains the header; the whole file if the header has no end.
std::string_view header_text(const std::string& file, InputWindow& window)
{
    for (std::size_t size = 4096;; size *= 2) {
        const bool is_all = size >= window.bytes_left();
        const std::string_view text = window.peek(is_all ? std::size_t(window.bytes_left()) : size);
        if (is_all || header_end(file, text) > 0) return text;
    }
}

}  // namespace

std::size_t PlyElement::min_size() const
{
    std::size_t size = 0;
    for (const PlyProperty& p : properties) size += size_of(p.is_list ? p.count_type : p.type);
    return size;
}

bool PlyElement::has_lists() const
{
    for (const PlyProperty& p : properties)
        if (p.is_list) return true;
    return false;
}

PlyHeader read_ply_header(const std::string& file, InputWindow& window)
{
    const std::string_view bytes = header_text(file, window);
    PlyHeader header;
    TextScanner scan(file, bytes);
    if (scan.word() != "ply") scan.fail("this is not a PLY file: it must begin with 'ply'");
    bool has_format = false;
    for (;;) {
        scan.next_line();
        if (scan.at_end()) scan.fail("the file ends within its header: there is no 'end_header'");
        const std::string_view key = scan.word();
        if (key == "end_header") break;
        if (key == "format") {
            header.format = read_format(scan);
            has_format = true;
        } else if (key == "element") {
            PlyElement element;
            element.name = scan.word();
            element.count = scan.to_integer<std::size_t>(scan.word());
            header.elements.push_back(std::move(element));
        } else if (key == "property") {
            if (header.elements.empty()) scan.fail("a property before the first element");
            header.elements.back().properties.push_back(read_property(scan));
        } else if (!key.empty() && key != "comment" && key != "obj_info") {
            scan.fail(fmt::format("'{}' is not allowed in the header of a PLY file", printable(key)));
        }
    }
    if (!has_format) scan.fail("the header does not specify the format");
    header.lines = scan.line();
    const std::size_t size = header_end(file, bytes);
    window.pass(size > 0 ? size : bytes.size());
    return header;
}

}  // namespace fathom
