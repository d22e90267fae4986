#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "fathom/costs.h"

namespace fathom::cli {

/// "1.23 M", to be followed by a unit.
std::string with_unit(double number);
/// What rendering took: rays by kind, light samples, lanes in use, and the time of the stages for each vertex of a
/// path; lines of text. render_s: by the clock.
std::string cost_sheet(const RenderCosts& costs, double render_s);
/// The same, for programs.
nlohmann::json cost_sheet_json(const RenderCosts& costs, double render_s);

}  // namespace fathom::cli
