// SPDX-License-Identifier: Apache-2.0
#include "options/arguments.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace fathom::cli {

namespace {

constexpr std::uint64_t max_side = 1 << 24;

template <class Number>
bool parse_all(const std::string& text, Number& number)
{
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

double linear_from_srgb_byte(int code)
{
    const double encoded = code / 255.0;
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

std::vector<std::string> split(const std::string& text, char separator)
{
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= text.size(); ++i)
        if (i == text.size() || text[i] == separator) {
            parts.push_back(text.substr(begin, i - begin));
            begin = i + 1;
        }
    return parts;
}

double parse_number(const std::string& text)
{
    double number = 0;
    const std::string digits = text.rfind('+', 0) == 0 ? text.substr(1) : text;
    if (!parse_all(digits, number) || !std::isfinite(number))
        throw UsageError(fmt::format("expected a number, found '{}'", text));
    return number;
}

double parse_number(const std::string& text, double min, double max)
{
    const double number = parse_number(text);
    if (number < min || number > max)
        throw UsageError(fmt::format("expected a number from {} to {}, found {}", min, max, text));
    return number;
}

std::uint64_t parse_integer(const std::string& text, std::uint64_t min, std::uint64_t max)
{
    std::uint64_t number = 0;
    if (!parse_all(text, number) || number < min || number > max)
        throw UsageError(fmt::format("expected a whole number from {} to {}, found '{}'", min, max, text));
    return number;
}

std::vector<double> parse_numbers(const std::string& text, std::size_t count)
{
    const std::vector<std::string> parts = split(text, ',');
    if (parts.size() != count)
        throw UsageError(fmt::format("expected {} numbers separated by commas, found '{}'", count, text));
    std::vector<double> numbers;
    numbers.reserve(parts.size());
    for (const std::string& part : parts) numbers.push_back(parse_number(part));
    return numbers;
}

Vec3d parse_vector(const std::string& text)
{
    const std::vector<double> n = parse_numbers(text, 3);
    return {n[0], n[1], n[2]};
}

std::string parse_extension(const std::string& text)
{
    const std::string extension = text.substr(text.starts_with('.') ? 1 : 0);
    const auto is_allowed = [](unsigned char c) { return std::islower(c) || std::isdigit(c); };
    if (extension.empty() || !std::all_of(extension.begin(), extension.end(), is_allowed))
        throw UsageError(fmt::format("expected an extension such as glb, found '{}'", text));
    return extension;
}

Size parse_size(const std::string& text)
{
    const std::vector<std::string> parts = split(text, 'x');
    if (parts.size() != 2) throw UsageError(fmt::format("expected a size such as 800x600, found '{}'", text));
    return {int(parse_integer(parts[0], 1, max_side)), int(parse_integer(parts[1], 1, max_side))};
}

double parse_duration(const std::string& text)
{
    std::string digits = text;
    double unit = 1;
    if (!text.empty()) {
        const char last = text.back();
        unit = last == 'h' ? 3600 : last == 'm' ? 60 : 1;
        if (last == 'h' || last == 'm' || last == 's') digits.pop_back();
    }
    const double seconds = parse_number(digits) * unit;
    if (!(seconds > 0))
        throw UsageError(fmt::format("expected a time above 0, such as 90, 90s, 10m or 1h, found '{}'", text));
    return seconds;
}

std::uint64_t parse_bytes(const std::string& text)
{
    constexpr double max_bytes = 1e18;
    const auto refuse = [&] {
        throw UsageError(fmt::format("expected a memory size such as 8G, 512M or 1.5GiB, found '{}'", text));
    };
    const std::size_t end = text.find_first_not_of("0123456789.");
    if (end == 0 || end == std::string::npos) refuse();
    std::string unit = text.substr(end);
    if (unit.ends_with('B')) unit.pop_back();
    const bool is_binary = unit.ends_with('i');
    if (is_binary) unit.pop_back();
    const std::size_t power = std::string_view("KMGT").find(unit);
    if (unit.size() != 1 || power == std::string_view::npos) refuse();
    const double bytes = parse_number(text.substr(0, end)) * std::pow(is_binary ? 1024.0 : 1000.0, double(power + 1));
    if (!(bytes >= 1 && bytes <= max_bytes)) refuse();
    return std::uint64_t(bytes);
}

double parse_time(const std::string& text)
{
    return parse_number(text.ends_with('s') ? text.substr(0, text.size() - 1) : text, 0, 1e9);
}

std::vector<std::uint64_t> parse_frames(const std::string& text)
{
    constexpr std::uint64_t last_frame = 99'999'999, max_frames = 1'000'000;
    const std::vector<std::string> parts = split(text, ':');
    if (parts.size() > 3) throw UsageError(fmt::format("expected A:B or A:B:STEP, found '{}'", text));
    const std::uint64_t first = parse_integer(parts[0], 0, last_frame);
    const std::uint64_t last = parts.size() > 1 ? parse_integer(parts[1], 0, last_frame) : first;
    const std::uint64_t step = parts.size() > 2 ? parse_integer(parts[2], 1, last_frame) : 1;
    if (last < first) throw UsageError(fmt::format("there are no frames in {}", text));
    if ((last - first) / step >= max_frames) throw UsageError(fmt::format("more than {} frames", max_frames));
    std::vector<std::uint64_t> frames;
    for (std::uint64_t frame = first; frame <= last; frame += step) frames.push_back(frame);
    return frames;
}

Crop parse_crop(const std::string& text)
{
    const std::vector<std::string> parts = split(text, ',');
    if (parts.size() != 4) throw UsageError(fmt::format("expected x0,y0,x1,y1, found '{}'", text));
    int n[4];
    for (int i = 0; i < 4; ++i) n[i] = int(parse_integer(parts[i], 0, max_side));
    if (n[0] >= n[2] || n[1] >= n[3]) throw UsageError(fmt::format("there are no pixels in {}", text));
    return {n[0], n[1], n[2], n[3]};
}

SampleRange parse_sample_range(const std::string& text)
{
    const std::vector<std::string> parts = split(text, ':');
    if (parts.size() != 2) throw UsageError(fmt::format("expected a sample range such as 0:64, found '{}'", text));
    const SampleRange range{parse_integer(parts[0], 0, 1ull << 32), parse_integer(parts[1], 0, 1ull << 32)};
    if (range.first >= range.second) throw UsageError(fmt::format("there are no samples in {}", text));
    return range;
}

Color parse_color(const std::string& text)
{
    if (text == "black") return {0, 0, 0};
    if (text == "white") return {1, 1, 1};
    if (text.size() == 7 && text[0] == '#') {
        float rgb[3];
        for (int i = 0; i < 3; ++i) {
            int code = 0;
            const char* digits = text.data() + 1 + 2 * i;
            const auto [end, error] = std::from_chars(digits, digits + 2, code, 16);
            if (error != std::errc() || end != digits + 2 || code < 0)
                throw UsageError(fmt::format("expected a color such as #rrggbb, found '{}'", text));
            rgb[i] = float(linear_from_srgb_byte(code));
        }
        return {rgb[0], rgb[1], rgb[2]};
    }
    std::vector<double> n;
    try {
        n = parse_numbers(text, text.find(',') == std::string::npos ? 1 : 3);
    } catch (const UsageError&) {
        throw UsageError(fmt::format("expected a color such as #rrggbb, r,g,b, black or white, found '{}'", text));
    }
    n.resize(3, n[0]);
    for (double v : n)
        if (v < 0 || v > 1e30) throw UsageError(fmt::format("a color can't be {}", v));
    return {float(n[0]), float(n[1]), float(n[2])};
}

int parse_choice(const std::string& text, const std::vector<std::string>& choices)
{
    for (std::size_t i = 0; i < choices.size(); ++i)
        if (text == choices[i]) return int(i);
    throw UsageError(fmt::format("expected {}, found '{}'", fmt::join(choices, " or "), text));
}

}  // namespace fathom::cli
