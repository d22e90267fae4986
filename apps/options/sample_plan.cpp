// SPDX-License-Identifier: Apache-2.0
#include "options/sample_plan.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <string_view>

#include "options/arguments.h"

namespace fathom::cli {

PartNumber parse_part(const std::string& text)
{
    const std::vector<std::string> numbers = split(text, '/');
    if (numbers.size() != 2) throw UsageError(fmt::format("expected K/N such as 3/16, found '{}'", text));
    constexpr std::uint64_t max_parts = 1'000'000;
    const std::uint64_t count = parse_integer(numbers[1], 1, max_parts);
    // Many schedulers count tasks from 0, and not all run a shell that could add 1.
    constexpr std::string_view and_one = "+1";
    const std::string& number = numbers[0];
    if (number.ends_with(and_one))
        return {parse_integer(number.substr(0, number.size() - and_one.size()), 0, count - 1) + 1, count};
    return {parse_integer(number, 1, count), count};
}

SampleRange samples_of_part(PartNumber part, std::uint64_t samples)
{
    return {samples * (part.number - 1) / part.count, samples * part.number / part.count};
}

std::uint64_t planned_number(const std::map<std::string, std::string>& attributes, const char* attribute)
{
    const auto found = attributes.find(attribute);
    if (found == attributes.end()) return 0;
    const std::string& text = found->second;
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() && number <= max_samples ? number : 0;
}

std::uint64_t count_samples(const std::vector<SampleRange>& ranges)
{
    std::uint64_t count = 0;
    for (const SampleRange& range : ranges) count += range.second - range.first;
    return count;
}

std::string sample_ranges_text(const std::vector<SampleRange>& ranges)
{
    std::string text;
    for (const SampleRange& range : ranges)
        text += fmt::format("{}{}:{}", text.empty() ? "" : ",", range.first, range.second);
    return text;
}

std::vector<SampleRange> missing_samples(const std::vector<SampleRange>& present, std::uint64_t planned)
{
    std::vector<SampleRange> missing;
    std::uint64_t next = 0;
    for (const SampleRange& range : present) {
        if (range.first > next) missing.emplace_back(next, range.first);
        next = std::max(next, range.second);
    }
    if (planned > next) missing.emplace_back(next, planned);
    return missing;
}

std::vector<SampleRange> missing_samples(const std::vector<SampleRange>& present, SampleRange wanted)
{
    std::vector<SampleRange> missing = missing_samples(present, wanted.second);
    std::erase_if(missing, [&](const SampleRange& range) { return range.second <= wanted.first; });
    for (SampleRange& range : missing) range.first = std::max(range.first, wanted.first);
    return missing;
}

std::string missing_text(const std::vector<SampleRange>& missing, std::uint64_t planned_samples,
                         std::uint64_t planned_parts)
{
    std::string text = "samples " + sample_ranges_text(missing);
    std::vector<std::string> parts;
    for (std::uint64_t number = 1; planned_samples > 0 && number <= planned_parts; ++number) {
        const SampleRange part = samples_of_part({number, planned_parts}, planned_samples);
        const auto is_missing = [&](const SampleRange& r) { return r.first < part.second && part.first < r.second; };
        if (std::any_of(missing.begin(), missing.end(), is_missing)) parts.push_back(fmt::format("{}", number));
    }
    if (!parts.empty())
        text += fmt::format(" (part{} {} of {})", parts.size() > 1 ? "s" : "", fmt::join(parts, ", "), planned_parts);
    return text;
}

}  // namespace fathom::cli
