// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/comparison.h"

namespace fathom::cli {

/// A comparison as lines of text, the verdict last.
std::vector<std::string> difference_text(const Comparison& comparison);
/// A comparison as JSON. Numbers that are infinite are null.
nlohmann::ordered_json difference_json(const Comparison& comparison);

}  // namespace fathom::cli
