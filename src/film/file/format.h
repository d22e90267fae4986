// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fathom/render.h"

/// Layout of a film file: headers, a table of scanline offsets, and the scanlines. Each scanline is its y coordinate,
/// its length, and its channels one after another, as in an uncompressed EXR file.
namespace fathom::film_format {

inline constexpr const char* version_attribute = "fathom.sums.version";
inline constexpr const char* key_attribute = "fathom.sums.key";
inline constexpr const char* samples_attribute = "fathom.sums.samples";
inline constexpr const char* dropped_attribute = "fathom.sums.dropped";
inline constexpr const char* packing_attribute = "fathom.sums.packing";
inline constexpr const char* checksum_attribute = "fathom.sums.checksum";
inline constexpr const char* version = "1";

/// Bytes before a scanline's channels: its y coordinate and the length of its data.
inline constexpr std::size_t line_header_bytes = 8;

/// Name of the channel that holds a word of the sums: "sums.007".
std::string sums_channel(int word);
/// Sample ranges as text such as "0:16,32:48", and the inverse. Parsing throws Error unless the ranges are in order.
std::string text_of(const std::vector<SampleRange>& samples);
std::vector<SampleRange> parse_samples(const std::string& text);
/// Throws Error if the text is not a number.
std::uint64_t parse_number(const std::string& text);

/// Bytes of one value of a channel.
std::size_t value_size(Imf::PixelType type);
/// Bytes of all channels of one scanline.
std::size_t line_bytes(const Imf::Header& header);

/// Offset of the checksum digits in the headers. The checksum counts these digits as zeros. Throws Error if there are
/// none.
inline constexpr std::size_t checksum_digits = 16;
std::size_t checksum_offset(std::span<const unsigned char> headers);
/// Checksum of one scanline, from its y coordinate to its end.
std::uint64_t line_checksum(const unsigned char* line, std::size_t size);
/// Checksum of the file: over all bytes before the scanlines, and the checksums of the scanlines in order.
std::string file_checksum(std::span<const unsigned char> start, const std::vector<std::uint64_t>& lines);

}  // namespace fathom::film_format
