// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "fathom/image.h"
#include "why/causes.h"
#include "why/remedies.h"

namespace fathom::cli {

/// Results of `fathom why` for a scene: profile, names, display and remedies.
struct Analysis {
    std::string file;
    RenderProfile profile;
    CauseNames names;
    std::vector<Remedy> remedies;  ///< those that help first
    DisplayTransform display{};
};

/// The report for terminals.
std::string analysis_text(const Analysis& analysis);
/// The report as JSON. docs/why.md describes its members.
nlohmann::ordered_json analysis_json(const Analysis& analysis);
/// The report as a page of HTML that contains its images.
std::string analysis_page(const Analysis& analysis);

/// The gain of a remedy in words, such as "5.2 times less time for the same noise (4.1 to 6.6)".
std::string gain_text(const Gain& gain);

}  // namespace fathom::cli
