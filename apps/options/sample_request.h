// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "fathom/image_error.h"
#include "fathom/render.h"
#include "options/command.h"
#include "options/sample_plan.h"

namespace fathom::cli {

/// Samples per pixel where neither an option nor the scene says it. A window gets more: it should become clear, but a
/// forgotten one should stop working at some point.
inline constexpr std::uint64_t default_render_samples = 256, default_view_samples = 4096;

/// Largest number of samples per pixel of a render that only --error limits.
inline constexpr std::uint64_t max_error_samples = 65536;

/// --error and --error-metric.
struct ErrorOptions {
    std::optional<double> goal;  ///< the error at which rendering stops
    ErrorMetric metric = ErrorMetric::relative;
    bool is_estimated = true;
};

/// --spp, --time, --samples, --part and --error.
struct SampleOptions {
    std::optional<std::uint64_t> samples;
    std::optional<double> time_s;
    std::optional<SampleRange> range;
    std::optional<PartNumber> part;
    ErrorOptions error;
};

/// Adds --spp. `help` says what the number means to the command.
void add_spp_option(Command& command, SampleOptions& options, const std::string& help, std::uint64_t default_samples);
/// Throws UsageError for options that contradict each other.
void check_samples(const SampleOptions& options);

/// The samples that a run renders: resolved once from options, scene and default.
struct SampleRequest {
    /// Samples per pixel of the whole image; none where a time limit, an error or a range decides alone.
    std::optional<std::uint64_t> planned;
    SampleRange range;  ///< samples that are wanted in the end
    std::optional<double> time_s;
    std::optional<PartNumber> part;
    ErrorOptions error;
    bool is_default = false;  ///< neither an option nor the scene gave a number
    bool is_partial = false;  ///< --samples or --part: to be merged with the films of other runs
};

/// Options first, then the scene's hint, then the default. Throws Error for an invalid hint, UsageError for more parts
/// than samples.
///
/// file  path of the scene, for messages
SampleRequest resolve_samples(const SampleOptions& options, const RenderHints& hints, const std::string& file,
                              std::uint64_t default_samples);

}  // namespace fathom::cli
