// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "fathom/render.h"
#include "fathom/threads.h"
#include "options/command.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Options that decide the bits of an image beside scene, camera and size; `render` and `view` share them.
struct SettingsOptions {
    std::optional<int> max_depth, roulette_depth;  ///< a max_depth of -1 is unlimited
    std::optional<bool> light_sampling;
    LightSelection light_selection = LightSelection::tree;
    std::optional<bool> guiding;   ///< none: the command decides
    std::optional<bool> caustics;  ///< none: the command decides
    bool merge_caustics = false;   ///< see RenderSettings
    std::optional<Filter> filter;
    std::optional<double> filter_radius;
    std::optional<Color> background;
    std::optional<double> clamp_indirect;
    bool transparent = false;
    std::uint32_t seed = 0;
    int threads = 0;  ///< 0: all that are available
};

void add_settings_options(Command& command, SettingsOptions& options);

/// Settings from the options, else from the scene's hints, else the defaults. Throws Error for an invalid hint.
///
/// file  path of the scene, for messages
RenderSettings resolve_settings(const SettingsOptions& options, const RenderHints& hints, const std::string& file);

/// Limits the process to the threads that --threads asks for, and stores their number in `options`. Reports if the
/// system allows fewer.
ThreadLimit limit_threads(SettingsOptions& options, Reporter& reporter);

/// Names of filters, indexed by Filter.
extern const std::vector<std::string> filter_names;

}  // namespace fathom::cli
