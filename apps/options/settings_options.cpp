// SPDX-License-Identifier: Apache-2.0
#include "options/settings_options.h"

#include <fmt/format.h>
#include <algorithm>

#include "fathom/error.h"
#include "options/arguments.h"

namespace fathom::cli {

const std::vector<std::string> filter_names = {"box", "gaussian", "blackman-harris", "tent"};

namespace {

void add_path_options(Command& command, SettingsOptions& o)
{
    constexpr std::uint64_t max_int = 1u << 30;
    command.begin_group("Light transport");
    command.add_value(
        {"--max-depth", "N|none", "maximum path length in bounces; a limit darkens the image", "none"},
        [&](const std::string& text) { o.max_depth = text == "none" ? -1 : int(parse_integer(text, 0, max_int)); });
    command.add_value({"--roulette-depth", "N", "number of bounces before Russian roulette", "5"},
                      [&](const std::string& text) { o.roulette_depth = int(parse_integer(text, 0, max_int)); });
    command.add_value({"--light-sampling", "on|off",
                       "next event estimation; off disables direct light sampling (for debugging)", "on"},
                      [&](const std::string& text) { o.light_sampling = parse_choice(text, {"off", "on"}) == 1; });
    command.add_value(
        {"--light-selection", "tree|power|uniform",
         "how next event estimation chooses a light: by estimated contribution, by power, or uniformly", "tree"},
        [&](const std::string& text) {
            o.light_selection = LightSelection(parse_choice(text, {"power", "uniform", "tree"}));
        });
    command.add_value({"--guiding", "auto|on|off",
                       "path guiding: learns where light comes from and samples it more, which reduces noise indoors. "
                       "auto: in `fathom render` on from 8 samples per pixel and 4 million in all, from --time 10s, "
                       "and with --samples, --part, --mergeable or --checkpoint; in data sets and `fathom view` off",
                       "auto"},
                      [&](const std::string& text) {
                          const int choice = parse_choice(text, {"off", "on", "auto"});
                          if (choice < 2) o.guiding = choice == 1;
                      });
    command.add_value({"--caustics", "auto|on|merged|off",
                       "light tracing: paths from the lights find caustics, the light that glass and mirrors throw "
                       "onto other surfaces, which paths from the camera meet rarely or never. auto: in `fathom "
                       "render` on if a trial shows less noise for the time, which is made from 8 samples per pixel "
                       "and 2 million in all (a quick one below 33 million; with smooth glass from 1 million), from "
                       "--time 2s (1s), and with --samples, --part, --mergeable or --checkpoint; in shorter renders "
                       "on if glass refracts light of lights without a size; in `fathom view` off. merged: also finds "
                       "caustics that are seen through glass or in mirrors, such as those on the floor of a pool, from "
                       "photons. Biased: they are blurred, less with every sample",
                       "auto"},
                      [&](const std::string& text) {
                          const int choice = parse_choice(text, {"off", "on", "merged", "auto"});
                          if (choice < 3) o.caustics = choice > 0;
                          o.merge_caustics = choice == 2;
                      });
    command.add_value({"--clamp-indirect", "X",
                       "limit the light that each sample gets over two or more surfaces, per channel and before "
                       "exposure. Biased: removes fireflies, but darkens caustics and bright corners",
                       "no limit"},
                      [&](const std::string& text) { o.clamp_indirect = parse_number(text, 1e-6, 1e30); });
}

}  // namespace

void add_settings_options(Command& command, SettingsOptions& o)
{
    command.begin_group("Sampling");
    command.add_value({"--seed", "N", "random seed, which changes the noise", "0"},
                      [&](const std::string& text) { o.seed = std::uint32_t(parse_integer(text, 0, 0xffffffffu)); });
    command.add_value({"--filter", "NAME", "reconstruction filter: box, gaussian, blackman-harris or tent",
                       "the scene's, else blackman-harris"},
                      [&](const std::string& text) { o.filter = Filter(parse_choice(text, filter_names)); });
    command.add_value({"--filter-radius", "PIXELS", "radius of the filter",
                       "box 0.5, gaussian 2 (four standard deviations), blackman-harris 1.65, tent 1"},
                      [&](const std::string& text) { o.filter_radius = parse_number(text, 0.01, max_filter_radius); });
    add_path_options(command, o);
    command.begin_group("Light and background");
    command.add_value(
        {"--background", "COLOR",
         "background that the camera sees; it does not illuminate the scene. #rrggbb (sRGB), r,g,b (linear), "
         "black, white, or transparent (alpha in EXR and PNG, black in a window)",
         "the scene's, else its environment"},
        [&](const std::string& text) {
            o.transparent = text == "transparent";
            o.background = o.transparent ? Color{0, 0, 0} : parse_color(text);
        });
    command.begin_group("Machine");
    command.add_value({"--threads", "N", "number of threads; the image does not depend on it",
                       "all cores that the process may use, within the container's limit"},
                      [&](const std::string& text) { o.threads = int(parse_integer(text, 1, 4096)); });
}

RenderSettings resolve_settings(const SettingsOptions& o, const RenderHints& hints, const std::string& file)
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
    // The file's filter radius applies only to the file's filter.
    settings.filter_radius = o.filter_radius.value_or(o.filter ? 0 : hints.filter_radius.value_or(0));
    settings.filter = o.filter.value_or(settings.filter);
    settings.light_selection = o.light_selection;
    settings.guiding = o.guiding.value_or(false);
    settings.light_paths = o.caustics.value_or(false) ? usual_light_paths : 0;
    settings.merge_caustics = o.merge_caustics;
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
        reporter.note(fmt::format("the system allows only {} of {} threads", options.threads, wanted));
    return limit;
}

}  // namespace fathom::cli
