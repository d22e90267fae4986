#pragma once
#include <cstdint>
#include <optional>

#include "fathom/render.h"
#include "fathom/threads.h"
#include "options/arguments.h"
#include "report/reporter.h"

namespace fathom::cli {

/// What decides the bits of a picture beside scene, camera and size: the same for `render` and `view`.
struct SettingsOptions {
    std::optional<int> max_depth, roulette_depth;  ///< a max_depth of -1 is none
    std::optional<bool> light_sampling;
    LightSelection light_selection = LightSelection::tree;
    std::optional<bool> guiding;
    bool general_loop = false;
    std::optional<Filter> filter;
    std::optional<double> filter_radius;
    std::optional<Color> background;
    std::optional<double> clamp_indirect;
    bool transparent = false;
    std::uint32_t seed = 0;
    int threads = 0;
};

void add_settings_options(Command& command, SettingsOptions& options);

/// Options first, then what the scene asks for. Throws Error if that is no sensible value.
///
/// file  the scene's, for messages
RenderSettings settings_of(const SettingsOptions& options, const RenderHints& hints, const std::string& file);

/// The limit on threads that --threads asks for; settings then have the number of them. Says so where the system allows
/// fewer.
ThreadLimit limit_threads(SettingsOptions& options, Reporter& reporter);

/// How many samples a pixel the scene asks for, if it does.
std::optional<std::uint64_t> hinted_samples(const RenderHints& hints, const std::string& file);

/// Position is Filter's value.
extern const std::vector<std::string> filter_names;

}  // namespace fathom::cli
