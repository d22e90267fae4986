// SPDX-License-Identifier: Apache-2.0
#include "formats/common/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "formats/io/read_file.h"

namespace fathom {

namespace {

char lower(char c)
{
    return char(std::tolower(static_cast<unsigned char>(c)));
}

/// Optimal string alignment distance, ignoring case.
std::size_t edit_distance(std::string_view a, std::string_view b)
{
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

}  // namespace

std::string suggest(std::string_view word, const std::vector<std::string>& candidates)
{
    // Damaged files may contain names of megabytes, for which no suggestion makes sense.
    if (word.size() > 64) return {};
    const std::string* best = nullptr;
    // In words of two letters a single mistake makes any other word, so only the case may differ.
    std::size_t best_distance = word.size() < 3 ? 1 : std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        if (candidate.size() > 64) continue;
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) best = &candidate, best_distance = distance;
    }
    return best ? *best : std::string();
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates)
{
    const std::string near = suggest(word, candidates);
    if (!near.empty()) return fmt::format("; did you mean '{}'?", near);
    if (candidates.empty() || candidates.size() > 32) return {};
    return fmt::format("; known here: {}", fmt::join(candidates, ", "));
}

std::optional<std::size_t> find_choice(std::string_view wanted, const std::vector<std::string>& names)
{
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found != names.end()) return std::size_t(found - names.begin());
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (error == std::errc() && end == wanted.data() + wanted.size() && number < names.size()) return number;
    return {};
}

std::string choices(std::string_view wanted, const std::vector<std::string>& names)
{
    constexpr std::size_t most = 24;
    if (names.empty()) return ": there are none";
    std::string text = " among ";
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
        text += fmt::format("{}'{}'", i > 0 ? ", " : "", printable(names[i]));
    if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
    const std::string near = suggest(wanted, names);
    return near.empty() ? text : text + fmt::format("; did you mean '{}'?", near);
}

}  // namespace fathom
