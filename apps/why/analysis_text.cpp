// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>

#include "report/cost_sheet.h"
#include "why/analysis.h"

namespace fathom::cli {

namespace {

/// Rows that a table prints, and the share of noise or time from which further rows are printed.
constexpr std::size_t usual_rows = 5;
constexpr double notable_share = 0.1;

std::string row_text(const ProfileRow& row, const std::string& name)
{
    return fmt::format("  {:>6} +-{:>5} {:>7} {:>7}  {}\n", percent(row.noise),
                       fmt::format("{:.1f}", 100 * row.noise_error), percent(row.light), percent(row.time), name);
}

std::string table_text(const NamedTable& table, const CauseNames& names)
{
    std::string text = fmt::format("   noise          light    time  by {}\n", table.title);
    ProfileRow others;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const ProfileRow& row = table.rows[i];
        if (i < usual_rows || row.noise >= notable_share || row.time >= notable_share) {
            text += row_text(row, names.name(row));
        } else {
            ++left_out;
            others.noise += row.noise, others.light += row.light, others.time += row.time;
        }
    }
    if (left_out > 0)
        text += fmt::format("  {:>6}         {:>7} {:>7}  {} more\n", percent(others.noise), percent(others.light),
                            percent(others.time), left_out);
    return text + "\n";
}

std::string remedies_text(const std::vector<Remedy>& remedies)
{
    std::string text;
    std::vector<std::string> useless;
    for (const Remedy& r : remedies) {
        if (!r.helps()) {
            useless.push_back(fmt::format("{} ({:.2g})", r.action, r.gain.value));
            continue;
        }
        text += fmt::format("  {}\n      {}\n      against {}\n", r.action, gain_text(r.gain), r.cause);
        if (!r.price.empty()) text += fmt::format("      {}\n", r.price);
    }
    if (!text.empty()) text = "What helps, as measured:\n" + text;
    if (!useless.empty()) text += fmt::format("Tried, without a gain that is certain: {}\n", fmt::join(useless, ", "));
    return text;
}

}  // namespace

std::string gain_text(const Gain& gain)
{
    return fmt::format("{:.2g} times less time for the same noise ({:.2g} to {:.2g}){}", gain.value, gain.low,
                       gain.high,
                       gain.is_reliable ? "" : "; few bright samples decide the noise, so the figure is uncertain");
}

std::string analysis_text(const Analysis& a)
{
    const RenderProfile& p = a.profile;
    std::string text =
        fmt::format("{}: {}x{} pixels, {} samples per pixel: error {}, {:.1f} s of processor time, {}rays\n", a.file,
                    p.width, p.height, p.samples_per_pixel, percent(p.error), p.seconds, with_prefix(double(p.rays)));
    for (const std::string& line : largest_causes(p, a.names)) text += "  " + line + "\n";
    if (p.top_noise >= notable_share)
        text += fmt::format("  {} of the noise is in 0.1 % of the pixels: shares may differ with more samples\n",
                            percent(p.top_noise));
    text += "\n";
    for (const NamedTable& table : tables_of(p))
        if (table.has_work) text += table_text(table, a.names);
    return text + remedies_text(a.remedies);
}

}  // namespace fathom::cli
