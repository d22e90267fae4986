// SPDX-License-Identifier: Apache-2.0
#include "report/error_report.h"

#include <fmt/format.h>
#include <array>
#include <nlohmann/json.hpp>

namespace fathom::cli {

namespace {

constexpr std::array metric_names{"relative", "absolute", "worst-block"};

/// An error with two or three significant digits; relative ones in percent, without the sign.
std::string number_text(double error, ErrorMetric metric)
{
    const double shown = metric == ErrorMetric::absolute ? error : 100 * error;
    return shown >= 100 ? fmt::format("{:.0f}", shown) : fmt::format("{:.2g}", shown);
}

std::string with_unit(const std::string& number, ErrorMetric metric)
{
    return metric == ErrorMetric::absolute ? number : number + " %";
}

std::string estimate_text(const ErrorReport& r)
{
    const auto text = [&](double error) { return number_text(error, r.metric); };
    const char* const name = r.metric == ErrorMetric::relative   ? "error"
                             : r.metric == ErrorMetric::absolute ? "absolute error"
                                                                 : "error of the worst block";
    if (r.error.is_reliable())
        return fmt::format("{} {} ({} to {} with 95 % confidence)", name, with_unit(text(r.error.error), r.metric),
                           text(r.error.low), with_unit(text(r.error.high), r.metric));
    const std::string about =
        fmt::format("{} about {}, which can't be trusted", name, with_unit(text(r.error.error), r.metric));
    if (r.metric == ErrorMetric::worst_block) return about;
    return fmt::format("{}: few bright samples decide it; {} without the noisiest 0.1 % of the pixels", about,
                       with_unit(text(r.error.rest), r.metric));
}

}  // namespace

std::string error_text(const ErrorReport& r)
{
    std::string text = estimate_text(r);
    const auto value = [&](double error) { return with_unit(number_text(error, r.metric), r.metric); };
    if (r.goal && !r.is_reached) {
        text += fmt::format("; --error {} was not reached: {}", value(*r.goal), r.end);
        if (r.needed) text += fmt::format(", and some {} samples per pixel are needed", *r.needed);
    } else if (!r.goal && r.after_twice && r.error.is_reliable() && r.error.error > 0) {
        text += fmt::format("; twice the samples would give {}", value(*r.after_twice));
    }
    return text;
}

nlohmann::json error_json(const ErrorReport& r)
{
    nlohmann::json event = {{"event", "error_estimate"},      {"metric", metric_names[std::size_t(r.metric)]},
                            {"error", r.error.error},         {"low", r.error.low},
                            {"high", r.error.high},           {"reliable", r.error.is_reliable()},
                            {"few_share", r.error.few_share}, {"tail_shape", r.error.tail_shape},
                            {"top_share", r.error.top_share}, {"rest", r.error.rest},
                            {"samples_per_pixel", r.samples}};
    if (r.after_twice) event["after_twice_the_samples"] = *r.after_twice;
    if (r.goal) event["goal"] = *r.goal, event["reached"] = r.is_reached;
    if (r.needed) event["samples_needed"] = *r.needed;
    return event;
}

}  // namespace fathom::cli
