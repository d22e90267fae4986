// SPDX-License-Identifier: Apache-2.0
#include "options/render_words.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace fathom::cli {

namespace {

constexpr CommandText no_text{"render", "", ""};

/// Values of options that add_scene_options() doesn't add, although they decide on ground and shutter.
std::vector<std::string> scene_values(const RenderOptions& o)
{
    std::vector<std::string> words = {std::to_string(o.series.fps), std::to_string(o.series.shutter),
                                      o.settings.transparent ? "transparent" : ""};
    if (const auto& c = o.settings.background)
        for (const float channel : {c->r, c->g, c->b}) words.push_back(std::to_string(channel));
    return words;
}

}  // namespace

std::vector<std::string> parse_render_words(const std::vector<std::string>& words, RenderOptions& options)
{
    CLI::App app("", "fathom");
    Command command(app, no_text);
    add_scene_options(command, options.scene);
    const std::size_t scene_end = command.option_count();
    add_other_render_options(command, options);
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    reversed.push_back(no_text.name);
    try {
        app.parse(reversed);
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    std::vector<std::string> scene = command.given_options(0, scene_end);
    for (std::string& value : scene_values(options)) scene.push_back(std::move(value));
    return scene;
}

std::vector<OptionText> render_option_texts()
{
    CLI::App app("", "fathom");
    RenderOptions options;
    Command command(app, no_text);
    add_all_render_options(command, options);
    return command.texts();
}

}  // namespace fathom::cli
