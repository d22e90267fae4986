// SPDX-License-Identifier: Apache-2.0
#include "report/cost_sheet.h"

#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

namespace fathom::cli {

namespace {

constexpr const char* ray_kind_names[] = {"camera", "bounce", "shadow"};
static_assert(std::size(ray_kind_names) == ray_kind_count);
constexpr const char* stage_names[] = {"camera", "trace",   "arrival", "sort", "surface", "material",
                                       "light",  "scatter", "shadow",  "film", "learn"};
static_assert(std::size(stage_names) == render_stage_count);

double ratio(double a, double b)
{
    return b > 0 ? a / b : 0;
}

/// Time summed over all threads.
double thread_seconds(const RenderCosts& c)
{
    return std::accumulate(c.seconds.begin(), c.seconds.end(), 0.0);
}
double lanes_in_use(const RenderCosts& c)
{
    return ratio(double(c.vertices), double(c.shaded_lanes));
}
/// Fraction of path vertices at which a light was sampled.
double light_share(const RenderCosts& c)
{
    return ratio(double(c.light_samples), double(c.vertices));
}
double unoccluded_share(const RenderCosts& c)
{
    return ratio(double(c.clear_shadow_rays), double(c.rays[std::size_t(RayKind::shadow)]));
}

}  // namespace

std::string with_prefix(double number)
{
    for (const auto& [unit, name] : {std::pair{1e9, "G"}, {1e6, "M"}, {1e3, "k"}})
        if (number >= unit) return fmt::format("{:.2f} {}", number / unit, name);
    return fmt::format("{:.0f} ", number);
}

std::string cost_sheet(const RenderCosts& c, double render_s)
{
    std::string text = fmt::format("{}rays, {}rays/s:", with_prefix(double(c.all_rays())),
                                   with_prefix(ratio(double(c.all_rays()), render_s)));
    for (std::size_t i = 0; i < ray_kind_count; ++i)
        text += fmt::format(" {} {:.1f} %{}", ray_kind_names[i], 100 * ratio(double(c.rays[i]), double(c.all_rays())),
                            i + 1 < ray_kind_count ? "," : "");
    text += fmt::format(" (of these {:.1f} % unoccluded)\n", 100 * unoccluded_share(c));
    text += fmt::format("{}path vertices, a light sampled at {:.1f} %, {:.1f} % of the lanes in use\n",
                        with_prefix(double(c.vertices)), 100 * light_share(c), 100 * lanes_in_use(c));
    text += "stage       share ns per vertex\n";
    for (std::size_t i = 0; i < render_stage_count; ++i)
        if (c.seconds[i] > 0)
            text +=
                fmt::format("{:<9}{:6.1f} %{:14.1f}\n", stage_names[i], 100 * ratio(c.seconds[i], thread_seconds(c)),
                            1e9 * ratio(c.seconds[i], double(c.vertices)));
    text += fmt::format("all      {:6.1f} %{:14.1f}", 100.0, 1e9 * ratio(thread_seconds(c), double(c.vertices)));
    return text;
}

nlohmann::json cost_sheet_json(const RenderCosts& c, double render_s)
{
    nlohmann::json rays, stages;
    for (std::size_t i = 0; i < ray_kind_count; ++i) rays[ray_kind_names[i]] = c.rays[i];
    for (std::size_t i = 0; i < render_stage_count; ++i)
        if (c.seconds[i] > 0)
            stages[stage_names[i]] = {{"thread_s", c.seconds[i]},
                                      {"share", ratio(c.seconds[i], thread_seconds(c))},
                                      {"ns_per_vertex", 1e9 * ratio(c.seconds[i], double(c.vertices))}};
    return {{"event", "stats"},
            {"rays", rays},
            {"rays_per_s", ratio(double(c.all_rays()), render_s)},
            {"shadow_rays_clear", c.clear_shadow_rays},
            {"vertices", c.vertices},
            {"light_samples", c.light_samples},
            {"lanes_in_use", lanes_in_use(c)},
            {"stages", stages}};
}

}  // namespace fathom::cli
