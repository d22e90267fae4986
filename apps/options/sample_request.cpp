// SPDX-License-Identifier: Apache-2.0
#include "options/sample_request.h"

#include <fmt/format.h>

#include "fathom/error.h"
#include "options/arguments.h"

namespace fathom::cli {

void add_spp_option(Command& command, SampleOptions& options, const std::string& help, std::uint64_t default_samples)
{
    command.begin_group("Sampling");
    command.add_value({"--spp", "N", help, fmt::format("the scene's, else {}", default_samples)},
                      [&](const std::string& text) { options.samples = parse_integer(text, 1, max_samples); });
}

void check_samples(const SampleOptions& o)
{
    if (o.range && (o.samples || o.time_s)) throw UsageError("--samples: leave out --spp and --time");
    if (o.part && (o.range || o.time_s))
        throw UsageError("--part: takes its share of --spp; leave out --samples and --time");
    if (o.error.goal && (o.range || o.part))
        throw UsageError("--error: needs the whole image; `fathom merge` reports the error of merged parts");
}

SampleRequest resolve_samples(const SampleOptions& o, const RenderHints& hints, const std::string& file,
                              std::uint64_t default_samples)
{
    SampleRequest request{o.samples, {}, o.time_s, o.part, o.error};
    const bool has_limit = o.time_s || o.error.goal;
    request.is_partial = o.range || o.part;
    if (!o.samples && !has_limit && hints.samples) {
        if (*hints.samples < 1) throw Error(file, "samples", "expected at least 1");
        request.planned = std::uint64_t(*hints.samples);
    }
    if (!request.planned && !has_limit && !o.range) {
        request.planned = default_samples;
        request.is_default = true;
    }
    if (o.range) {
        request.range = *o.range;
    } else if (o.part) {
        if (o.part->count > *request.planned)
            throw UsageError(
                fmt::format("--part: {} samples can't be split into {} parts", *request.planned, o.part->count));
        request.range = samples_of_part(*o.part, *request.planned);
    } else {
        request.range = {0, request.planned.value_or(o.time_s ? max_samples : max_error_samples)};
    }
    return request;
}

}  // namespace fathom::cli
