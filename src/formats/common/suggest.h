#pragma once
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// The candidate that `word` was probably meant to be: the one with the fewest typing mistakes (letters added, left
/// out, changed, or two swapped); empty if none is near.
std::string suggest(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean 'color'?", or the candidates if few and none is near, or nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

/// The same, among the names of a map.
template <class Map>
std::string suggestion_of(std::string_view word, const Map& by_name)
{
    const auto names = std::views::keys(by_name);
    return suggestion(word, std::vector<std::string>(names.begin(), names.end()));
}

/// Number of the one that is named or numbered so; nothing if there is none.
std::optional<std::size_t> find_choice(std::string_view wanted, const std::vector<std::string>& names);

/// " among 'a', 'b'; did you mean 'a'?": what to say of choices when none was found.
std::string choices(std::string_view wanted, const std::vector<std::string>& names);

}  // namespace fathom
