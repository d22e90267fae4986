// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "fathom/image_error.h"

namespace fathom::cli {

/// The estimated error of an image with its context, as users see it.
struct ErrorReport {
    ImageError error;
    ErrorMetric metric = ErrorMetric::relative;
    std::uint64_t samples = 0;              ///< per pixel
    std::optional<double> after_twice{};    ///< error to expect after twice the samples
    std::optional<double> goal{};           ///< value of --error
    bool is_reached = false;                ///< whether the render ended because the error was below the goal
    std::string end{};                      ///< why the render ended otherwise: "the time is up"
    std::optional<std::uint64_t> needed{};  ///< samples per pixel that the goal needs
};

/// One or two sentences in a line, such as `error 2.1 % (1.9 to 2.3 % with 95 % confidence)`.
std::string error_text(const ErrorReport& report);
/// The event "error" of --progress json.
nlohmann::json error_json(const ErrorReport& report);

}  // namespace fathom::cli
