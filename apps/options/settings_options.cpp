#include "options/settings_options.h"

#include <fmt/format.h>
#include <algorithm>

#include "fathom/error.h"

namespace fathom::cli {

const std::vector<std::string> filter_names = {"box", "gaussian", "blackman-harris", "tent"};

void add_settings_options(Command& command, SettingsOptions& o)
{
    constexpr std::uint64_t max_int = 1u << 30;
    command.add_value("--seed", "N", "another seed, other noise (default 0)",
                      [&](const std::string& text) { o.seed = std::uint32_t(parse_integer(text, 0, 0xffffffffu)); });
    command.add_value("--threads", "N",
                      "threads (default: all cores that this process may use); the picture doesn't depend on it",
                      [&](const std::string& text) { o.threads = int(parse_integer(text, 1, 4096)); });
    command.add_value("--filter", "NAME", "box, gaussian, blackman-harris (default) or tent",
                      [&](const std::string& text) { o.filter = Filter(parse_word(text, filter_names)); });
    command.add_value(
        "--filter-radius", "PIXELS",
        "how far the filter reaches (default: box 0.5, gaussian 2, four times its deviation, blackman-harris 1.65, "
        "tent 1)",
        [&](const std::string& text) { o.filter_radius = parse_number(text, 0.01, max_filter_radius); });
    command.add_value(
        "--max-depth", "N|none", "longest path in bounces (default none: a limit makes the picture darker)",
        [&](const std::string& text) { o.max_depth = text == "none" ? -1 : int(parse_integer(text, 0, max_int)); });
    command.add_value("--roulette-depth", "N", "bounces before Russian roulette (default 5)",
                      [&](const std::string& text) { o.roulette_depth = int(parse_integer(text, 0, max_int)); });
    command.add_value("--light-sampling", "on|off", "off: lights are only found by chance (default on)",
                      [&](const std::string& text) { o.light_sampling = parse_word(text, {"off", "on"}) == 1; });
    command.add_value("--light-selection", "tree|power|uniform",
                      "which light a surface samples: those more often that may bring more there (default), brighter "
                      "ones more often, "
                      "or all alike, to compare with",
                      [&](const std::string& text) {
                          o.light_selection = LightSelection(parse_word(text, {"power", "uniform", "tree"}));
                      });
    command.add_value(
        "--clamp-indirect", "X",
        "the most that a sample brings of light by two surfaces or more, in each channel, before exposure: fewer "
        "fireflies, but biased: caustics and bright corners get darker (default: no limit)",
        [&](const std::string& text) { o.clamp_indirect = parse_number(text, 1e-6, 1e30); });
    command.add_value("--guiding", "auto|on|off",
                      "paths learn first where light comes from, then go there: less noise indoors (default auto: on "
                      "where that is worth the time it takes)",
                      [&](const std::string& text) {
                          if (const int word = parse_word(text, {"off", "on", "auto"}); word < 2) o.guiding = word == 1;
                      });
    command.add_value("--loop", "general|fast",
                      "general: rooms of quads, too, by the loop for all scenes, to debug (default fast)",
                      [&](const std::string& text) { o.general_loop = parse_word(text, {"fast", "general"}) == 1; });
    command.add_value("--background", "COLOUR",
                      "what the camera sees behind the scene (lights nothing): #rrggbb, linear r,g,b, black, white, or "
                      "transparent (alpha in EXR and PNG; black in a window)",
                      [&](const std::string& text) {
                          o.transparent = text == "transparent";
                          o.background = o.transparent ? Color{0, 0, 0} : parse_color(text);
                      });
}

RenderSettings settings_of(const SettingsOptions& o, const RenderHints& hints, const std::string& file)
{
    RenderSettings settings;
    settings.max_depth = o.max_depth.value_or(hints.max_depth.value_or(settings.max_depth));
    settings.roulette_depth = o.roulette_depth.value_or(hints.roulette_depth.value_or(settings.roulette_depth));
    settings.light_sampling = o.light_sampling.value_or(hints.light_sampling.value_or(settings.light_sampling));
    if (hints.filter) {
        const auto name = std::find(filter_names.begin(), filter_names.end(), *hints.filter);
        if (name == filter_names.end())
            throw Error(file, "filter",
                        fmt::format("expected {}, found '{}'", fmt::join(filter_names, " or "), *hints.filter));
        settings.filter = Filter(name - filter_names.begin());
    }
    // That of the file is its filter's.
    settings.filter_radius = o.filter_radius.value_or(o.filter ? 0 : hints.filter_radius.value_or(0));
    settings.filter = o.filter.value_or(settings.filter);
    settings.light_selection = o.light_selection;
    settings.guiding = o.guiding.value_or(false);
    settings.general_loop = o.general_loop;
    settings.background = o.background ? o.background : hints.background;
    settings.alpha = o.transparent;
    if (o.clamp_indirect) settings.clamp_indirect = float(*o.clamp_indirect);
    settings.seed = o.seed;
    settings.threads = o.threads;
    return settings;
}

ThreadLimit limit_threads(SettingsOptions& options, Reporter& reporter)
{
    const int wanted = options.threads > 0 ? options.threads : available_threads();
    ThreadLimit limit(wanted);
    options.threads = limit.threads();
    if (options.threads < wanted)
        reporter.note(fmt::format("only {} of {} threads can be started here", options.threads, wanted));
    return limit;
}

std::optional<std::uint64_t> hinted_samples(const RenderHints& hints, const std::string& file)
{
    if (!hints.samples) return {};
    if (*hints.samples < 1) throw Error(file, "samples", "expected 1 at least");
    return std::uint64_t(*hints.samples);
}

}  // namespace fathom::cli
