// SPDX-License-Identifier: Apache-2.0
#include "film/file/format.h"

#include <ImfChannelList.h>
#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <string_view>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "fathom/error.h"

namespace fathom::film_format {

namespace {

/// Parses the number that `text` begins with, and removes it from `text`.
std::uint64_t parse_leading_number(std::string_view& text)
{
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) throw Error("", "", fmt::format("expected a number, found '{}'", text.substr(0, 40)));
    text.remove_prefix(std::size_t(end - text.data()));
    return number;
}

}  // namespace

std::string sums_channel(int word)
{
    return fmt::format("sums.{:03}", word);
}

std::string text_of(const std::vector<SampleRange>& samples)
{
    std::string text;
    for (const SampleRange& range : samples)
        text += fmt::format("{}{}:{}", text.empty() ? "" : ",", range.first, range.second);
    return text;
}

std::vector<SampleRange> parse_samples(const std::string& text)
{
    std::vector<SampleRange> samples;
    std::string_view rest = text;
    while (!rest.empty()) {
        if (!samples.empty()) {
            if (rest.front() != ',') throw Error("", "", "expected ranges as 0:16,32:48");
            rest.remove_prefix(1);
        }
        SampleRange range;
        range.first = parse_leading_number(rest);
        if (rest.empty() || rest.front() != ':') throw Error("", "", "expected ranges as 0:16,32:48");
        rest.remove_prefix(1);
        range.second = parse_leading_number(rest);
        const bool in_order = samples.empty() || samples.back().second < range.first;
        if (range.first >= range.second || range.second > max_samples || !in_order)
            throw Error("", "",
                        fmt::format("range {}:{} is empty, too large or out of order", range.first, range.second));
        samples.push_back(range);
    }
    return samples;
}

std::uint64_t parse_number(const std::string& text)
{
    std::string_view rest = text;
    const std::uint64_t number = parse_leading_number(rest);
    if (!rest.empty()) throw Error("", "", fmt::format("expected a number, found '{}' after it", rest.substr(0, 40)));
    return number;
}

std::size_t value_size(Imf::PixelType type)
{
    return type == Imf::HALF ? 2 : 4;
}

std::size_t line_bytes(const Imf::Header& header)
{
    std::size_t pixel = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) pixel += value_size(c.channel().type);
    const auto& window = header.dataWindow();
    return pixel * std::size_t(std::int64_t(window.max.x) - window.min.x + 1);
}

std::size_t checksum_offset(std::span<const unsigned char> headers)
{
    using namespace std::string_literals;
    const std::string before = checksum_attribute + "\0string\0\x10\0\0\0"s;
    const auto found = std::search(headers.begin(), headers.end(), before.begin(), before.end());
    const auto place = std::size_t(found - headers.begin()) + before.size();
    if (found == headers.end() || headers.size() - place < checksum_digits)
        throw Error("", checksum_attribute, "expected 16 digits");
    return place;
}

std::uint64_t line_checksum(const unsigned char* line, std::size_t size)
{
    return XXH3_64bits(line, size);
}

std::string file_checksum(std::span<const unsigned char> start, const std::vector<std::uint64_t>& lines)
{
    const std::size_t place = checksum_offset(start);
    const std::string zeros(checksum_digits, '0');
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, start.data(), place);
    XXH3_64bits_update(&state, zeros.data(), zeros.size());
    XXH3_64bits_update(&state, start.data() + place + zeros.size(), start.size() - place - zeros.size());
    XXH3_64bits_update(&state, lines.data(), lines.size() * sizeof lines[0]);
    return fmt::format("{:016x}", XXH3_64bits_digest(&state));
}

}  // namespace fathom::film_format
