#pragma once
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fathom/render.h"

/// What stands where in a film file: headers, a table of the lines' places, and the lines, each of them a number, its
/// length and its channels one behind the other. That is an EXR without compression.
namespace fathom::film_format {

inline constexpr const char* version_attribute = "fathom.sums.version";
inline constexpr const char* key_attribute = "fathom.sums.key";
inline constexpr const char* samples_attribute = "fathom.sums.samples";
inline constexpr const char* dropped_attribute = "fathom.sums.dropped";
inline constexpr const char* packing_attribute = "fathom.sums.packing";
inline constexpr const char* checksum_attribute = "fathom.sums.checksum";
inline constexpr const char* version = "1";

/// In front of a line's channels: which it is, and how long they are.
inline constexpr std::size_t line_start = 8;

/// "sums.007"
std::string sums_channel(int word);
/// "0:16,32:48", and back. Throws Error if the text is no list of ranges in order.
std::string text_of(const std::vector<SampleRange>& samples);
std::vector<SampleRange> parse_samples(const std::string& text);
/// Throws Error if it is no number.
std::uint64_t parse_number(const std::string& text);

/// Bytes of a channel's value in one pixel.
std::size_t value_size(Imf::PixelType type);
/// Bytes of the channels of a line.
std::size_t line_bytes(const Imf::Header& header);

/// The place of the checksum's digits in the headers, which count as zeros in it; throws Error if there is none.
inline constexpr std::size_t checksum_digits = 16;
std::size_t checksum_place(std::span<const unsigned char> headers);
/// Of one line, from its number to its end.
std::uint64_t line_checksum(const unsigned char* line, std::size_t size);
/// Of the file: of all before the lines, and of the lines' checksums in order.
std::string file_checksum(std::span<const unsigned char> start, const std::vector<std::uint64_t>& lines);

}  // namespace fathom::film_format
