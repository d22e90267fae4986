// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <charconv>

#include "fathom/error.h"
#include "film/film_data.h"

namespace fathom {

namespace {

constexpr int aov_count = 6;

/// The settings that determine an image, as (field name, value) pairs of a key's text.
std::vector<std::pair<std::string, std::string>> fields_of(const FilmKey& key)
{
    const RenderSettings& s = key.settings;
    std::string aovs;
    for (Aov aov : s.aovs) aovs += fmt::format("{}", int(aov));
    return {{"size", fmt::format("{}x{}", s.width, s.height)},
            {"aovs", aovs},
            {"alpha", fmt::format("{}", int(s.alpha))},
            {"seed", fmt::format("{}", s.seed)},
            {"max_depth", fmt::format("{}", s.max_depth)},
            {"roulette_depth", fmt::format("{}", s.roulette_depth)},
            {"light_sampling", fmt::format("{}", int(s.light_sampling))},
            {"light_selection", fmt::format("{}", int(s.light_selection))},
            {"guiding", fmt::format("{}", int(s.guiding))},
            {"light_paths", fmt::format("{:a}", s.light_paths) + (s.gathers_caustics() ? "+merged" : "")},
            {"error_probes", fmt::format("{}", int(s.error_probes))},
            {"filter",
             fmt::format("{}", int(s.filter)) + (s.filter_radius > 0 ? fmt::format("x{:a}", s.filter_radius) : "")},
            {"crop", s.crop ? fmt::format("{},{},{},{}", s.crop->x0, s.crop->y0, s.crop->x1, s.crop->y1) : "none"},
            {"background",
             s.background ? fmt::format("{:a},{:a},{:a}", s.background->r, s.background->g, s.background->b) : "none"},
            {"clamp_indirect", s.clamp_indirect ? fmt::format("{:a}", *s.clamp_indirect) : "none"},
            {"scene", key.scene}};
}

[[noreturn]] void fail(const std::string& what)
{
    throw Error("", "", "its sums belong to a film that this version can't read: " + what);
}

/// Parses the fields of a key in order.
class KeyParser {
public:
    explicit KeyParser(std::string_view text) : rest_(text) {}

    /// The value of the next field, which must have this name.
    std::string_view field(std::string_view name)
    {
        const std::string_view all = rest_.substr(0, rest_.find(';'));
        rest_.remove_prefix(std::min(rest_.size(), all.size() + 1));
        if (all.substr(0, name.size()) != name || all.substr(name.size(), 1) != "=")
            fail(fmt::format("found '{}' where {} was expected", all.substr(0, 40), name));
        return all.substr(name.size() + 1);
    }
    template <class T>
    T number(std::string_view name, double least, double most)
    {
        const std::array<T, 1> n = numbers<T, 1>(name, field(name), ',', least, most);
        return n[0];
    }
    template <class T, std::size_t n>
    static std::array<T, n> numbers(std::string_view name, std::string_view text, char separator, double least,
                                    double most)
    {
        std::array<T, n> result{};
        const char *at = text.data(), *const end = at + text.size();
        for (std::size_t i = 0; i < n; ++i) {
            if (i > 0) {
                if (at == end || *at != separator) fail(fmt::format("{} is '{}'", name, text.substr(0, 40)));
                ++at;
            }
            const auto [next, error] = read(at, end, result[i]);
            if (error != std::errc() || !(double(result[i]) >= least && double(result[i]) <= most))
                fail(fmt::format("{} is '{}'", name, text.substr(0, 40)));
            at = next;
        }
        if (at != end) fail(fmt::format("{} is '{}'", name, text.substr(0, 40)));
        return result;
    }
    bool at_end() const { return rest_.empty(); }

private:
    template <class T>
    static std::from_chars_result read(const char* at, const char* end, T& out)
    {
        if constexpr (std::is_floating_point_v<T>) {
            // fmt writes the prefix 0x, which from_chars does not accept.
            const bool negative = at != end && *at == '-';
            const char* digits = at + negative;
            if (end - digits > 2 && digits[0] == '0' && digits[1] == 'x') digits += 2;
            const auto result = std::from_chars(digits, end, out, std::chars_format::hex);
            if (negative) out = -out;
            return result;
        } else {
            return std::from_chars(at, end, out);
        }
    }
    std::string_view rest_;
};

}  // namespace

void check_settings(const RenderSettings& s)
{
    if (s.width < 1 || s.height < 1 || s.width > 65535 || s.height > 65535)
        throw Error("", "",
                    fmt::format("an image of {}x{} pixels can't be rendered: 1x1 to 65535x65535 are supported", s.width,
                                s.height));
    if (s.crop && (s.crop->x0 < 0 || s.crop->y0 < 0 || s.crop->x1 > s.width || s.crop->y1 > s.height ||
                   s.crop->x0 >= s.crop->x1 || s.crop->y0 >= s.crop->y1))
        throw Error("", "", "the crop is empty or not inside the image");
    if (!(s.light_paths >= 0 && s.light_paths <= max_light_paths))
        throw Error("", "", fmt::format("there can be at most {} light paths per pixel", max_light_paths));
    if (!(s.filter_radius >= 0 && s.filter_radius <= max_filter_radius))
        throw Error("", "", fmt::format("the filter radius must be at most {} pixels", max_filter_radius));
}

std::string FilmKey::text() const
{
    std::string text;
    for (const auto& [name, value] : fields_of(*this))
        text += fmt::format("{}{}={}", text.empty() ? "" : ";", name, value);
    return text;
}

std::string FilmKey::difference(const FilmKey& other) const
{
    const auto own = fields_of(*this), others = fields_of(other);
    std::string words;
    for (std::size_t i = 0; i < own.size(); ++i) {
        if (own[i].second == others[i].second) continue;
        if (!words.empty()) words += "; ";
        if (own[i].first == "scene")
            words += "it shows another scene or camera";
        else
            words += fmt::format("{} is {}, not {}", own[i].first, own[i].second, others[i].second);
    }
    return words;
}

FilmKey FilmKey::parse(const std::string& text)
{
    constexpr double max_int = 2147483647;
    KeyParser parser(text);
    FilmKey key;
    RenderSettings& s = key.settings;
    const auto size = KeyParser::numbers<int, 2>("size", parser.field("size"), 'x', 1, 65535);
    s.width = size[0], s.height = size[1];
    for (char digit : parser.field("aovs")) {
        if (digit < '0' || digit >= '0' + aov_count || s.aovs.size() >= aov_count) fail("its layers are unknown");
        s.aovs.push_back(Aov(digit - '0'));
    }
    s.alpha = parser.number<int>("alpha", 0, 1) == 1;
    s.seed = parser.number<std::uint32_t>("seed", 0, 4294967295.0);
    s.max_depth = parser.number<int>("max_depth", -1, max_int);
    s.roulette_depth = parser.number<int>("roulette_depth", 0, max_int);
    s.light_sampling = parser.number<int>("light_sampling", 0, 1) == 1;
    s.light_selection = LightSelection(parser.number<int>("light_selection", 0, 2));
    s.guiding = parser.number<int>("guiding", 0, 1) == 1;
    std::string_view light_paths = parser.field("light_paths");
    constexpr std::string_view merged = "+merged";
    s.merge_caustics = light_paths.ends_with(merged);
    if (s.merge_caustics) light_paths.remove_suffix(merged.size());
    s.light_paths = KeyParser::numbers<double, 1>("light_paths", light_paths, ',', 0, max_light_paths)[0];
    s.error_probes = parser.number<int>("error_probes", 0, 1) == 1;
    const std::string_view filter = parser.field("filter"), kind = filter.substr(0, filter.find('x'));
    s.filter = Filter(KeyParser::numbers<int, 1>("filter", kind, ',', 0, 3)[0]);
    if (kind.size() < filter.size())
        s.filter_radius =
            KeyParser::numbers<double, 1>("filter", filter.substr(kind.size() + 1), ',', 1e-300, max_filter_radius)[0];
    if (const std::string_view crop = parser.field("crop"); crop != "none") {
        const auto c = KeyParser::numbers<int, 4>("crop", crop, ',', 0, 65535);
        s.crop = Crop{c[0], c[1], c[2], c[3]};
    }
    if (const std::string_view background = parser.field("background"); background != "none") {
        const auto c = KeyParser::numbers<float, 3>("background", background, ',', -1e38, 1e38);
        s.background = Color{c[0], c[1], c[2]};
    }
    if (const std::string_view clamp = parser.field("clamp_indirect"); clamp != "none")
        s.clamp_indirect = KeyParser::numbers<float, 1>("clamp_indirect", clamp, ',', 0, 1e38)[0];
    key.scene = parser.field("scene");
    if (key.scene.size() != 32 || !parser.at_end()) fail("its scene has no fingerprint");
    check_settings(s);
    return key;
}

}  // namespace fathom
