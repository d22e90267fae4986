// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// The candidate nearest to `word` in edit distance (insertion, deletion, substitution, transposition); empty if none
/// is near.
std::string suggest(std::string_view word, const std::vector<std::string>& candidates);

/// Text for messages: "; did you mean 'color'?", or the list of candidates if they are few and none is near, or empty.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

/// Text for messages as by suggestion(), with the keys of a map as candidates.
template <class Map>
std::string suggestion_of(std::string_view word, const Map& by_name)
{
    const auto names = std::views::keys(by_name);
    return suggestion(word, std::vector<std::string>(names.begin(), names.end()));
}

/// Index of the choice with this name or number; nothing if there is none.
std::optional<std::size_t> find_choice(std::string_view wanted, const std::vector<std::string>& names);

/// Text for messages about a missing choice: " among 'a', 'b'; did you mean 'a'?".
std::string choices(std::string_view wanted, const std::vector<std::string>& names);

}  // namespace fathom
