// SPDX-License-Identifier: Apache-2.0
#include "formats/ply/ply_colors.h"

#include <algorithm>

namespace fathom {

namespace {

/// Channel 0 to 3 of a name such as "r" or "red"; -1 for other names.
int rgba_channel(std::string_view word)
{
    constexpr std::string_view names[4][2] = {{"r", "red"}, {"g", "green"}, {"b", "blue"}, {"a", "alpha"}};
    for (int c = 0; c < 4; ++c)
        for (const std::string_view name : names[c])
            if (word == name) return c;
    return -1;
}

/// The letter after "prefix_", if it is one of `letters`; 0 otherwise.
char channel_suffix(std::string_view name, std::string_view prefix, std::string_view letters)
{
    const bool has_prefix = name.size() == prefix.size() + 2 && name.starts_with(prefix) && name[prefix.size()] == '_';
    return has_prefix && letters.find(name.back()) != std::string_view::npos ? name.back() : '\0';
}

/// Prefix of the channels of the attribute `color`: empty, or `diffuse_` if plain names are missing.
std::string_view color_prefix(const PlyElement& element)
{
    const auto is_color = [](const PlyProperty& p) { return !p.is_list && rgba_channel(p.name) >= 0; };
    return std::any_of(element.properties.begin(), element.properties.end(), is_color) ? "" : "diffuse_";
}

}  // namespace

std::vector<PlyChannel> channels_of(const PlyElement& element, std::string_view attribute)
{
    constexpr std::string_view color_end = "_color";
    const std::string_view of_letters =
        attribute.ends_with(color_end) ? attribute.substr(0, attribute.size() - color_end.size()) : std::string_view();
    const std::string_view prefix = color_prefix(element);
    std::vector<PlyChannel> channels;
    int next = 0;  // counts channels, since names may be numbered from 0 or from 1
    for (const PlyProperty& p : element.properties) {
        PlyChannel& channel = channels.emplace_back();
        if (p.is_list) continue;
        const std::string_view name = p.name;
        if (attribute == "color" && name.starts_with(prefix))
            channel = {rgba_channel(name.substr(prefix.size())), true};
        if (channel.index >= 0) continue;
        if (channel_suffix(p.name, attribute, "xyzw01234"))
            channel = {next < 4 ? next++ : -1, false};
        else if (const char letter = channel_suffix(p.name, of_letters, "rgba"); letter && !of_letters.empty())
            channel = {rgba_channel({&letter, 1}), false};
    }
    return channels;
}

}  // namespace fathom
