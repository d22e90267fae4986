// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "fathom/costs.h"

namespace fathom::cli {

/// "1.23 M": a number with a metric prefix, to be followed by a unit.
std::string with_prefix(double number);
/// Report of the cost of rendering, as lines of text: rays by kind, light samples, lanes in use, and time per path
/// vertex by stage.
///
/// render_s  wall-clock time
std::string cost_sheet(const RenderCosts& costs, double render_s);
/// The report as an event of --progress json.
nlohmann::json cost_sheet_json(const RenderCosts& costs, double render_s);

}  // namespace fathom::cli
