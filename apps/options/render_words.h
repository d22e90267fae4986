// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "options/render_options.h"

namespace fathom::cli {

/// Parses words of a command line as `fathom render` does, for programs that offer its options.
///
/// words    options with their values, and the name of the scene
/// options  receives the values; neither checked nor completed, see check_options()
///
/// Returns the given options that decide which scene is compiled, as words. Throws UsageError.
std::vector<std::string> parse_render_words(const std::vector<std::string>& words, RenderOptions& options);

/// The options of `fathom render`.
std::vector<OptionText> render_option_texts();

}  // namespace fathom::cli
