// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "fathom/image_error.h"
#include "options/sample_request.h"

namespace fathom::cli {

/// Follows the error of an image while it is rendered, decides when it is small enough, and forecasts it.
class ErrorWatch {
public:
    /// goal  none: the error is only followed
    explicit ErrorWatch(ErrorOptions options) : options_(options) {}

    bool has_goal() const { return options_.goal.has_value(); }
    const ErrorOptions& options() const { return options_; }
    /// Whether the last look found the error below the goal with 95 % confidence.
    bool is_reached() const { return is_reached_; }
    /// Number of samples per pixel at which the error is estimated next. It follows from the looks so far, so each run
    /// of a render looks at the same numbers of samples, and stops at the same one.
    std::uint64_t next_look() const { return next_look_; }
    /// Number of samples per pixel that the goal needs as far as is known; 0: unknown.
    std::uint64_t expected_samples() const { return expected_samples_; }

    /// Estimates the error of a film that has reached next_look().
    void look(const Film& film);

    /// The final report: by probes that did not decide when to stop.
    std::optional<ImageError> final_error(const Film& film) const;
    /// The error to expect after `factor` times as many samples as the film has, whose error is `error`.
    double forecast(const Film& film, double error, double factor) const;

private:
    struct Look {
        double samples, error;
    };
    /// The exponent b of the law error ~ samples^-b that fits looks.
    static double rate(const std::vector<Look>& looks);

    ErrorOptions options_;
    std::vector<Look> looks_;
    bool is_reached_ = false;
    std::uint64_t next_look_ = 8, expected_samples_ = 0;
};

}  // namespace fathom::cli
