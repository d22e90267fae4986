// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "why/analysis.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

const char* name_of(ProfileCause cause)
{
    constexpr const char* names[] = {"camera", "light",  "emitter", "environment", "none", "material",
                                     "object", "medium", "path",    "combination", "depth"};
    static_assert(std::size(names) == std::size_t(ProfileCause::depth) + 1);
    return names[std::size_t(cause)];
}

ordered_json row_json(const ProfileRow& row, const CauseNames& names)
{
    ordered_json json{{"name", names.name(row)}, {"cause", name_of(row.cause)}};
    if (row.index >= 0) json["index"] = row.index;
    if (!row.path.empty()) json["path"] = row.path, json["sampled"] = row.is_sampled;
    json["noise"] = row.noise, json["noise_error"] = row.noise_error;
    json["light"] = row.light;
    if (row.cause == ProfileCause::combination) return json;
    json["time"] = row.time;
    json["rays"] = row.rays, json["shadow_rays"] = row.shadow_rays;
    return json;
}

ordered_json remedy_json(const Remedy& r)
{
    return {
        {"action", r.action},   {"cause", r.cause},       {"share", r.share},         {"price", r.price},
        {"gain", r.gain.value}, {"gain_low", r.gain.low}, {"gain_high", r.gain.high}, {"reliable", r.gain.is_reliable},
        {"helps", r.helps()}};
}

}  // namespace

ordered_json analysis_json(const Analysis& a)
{
    const RenderProfile& p = a.profile;
    ordered_json json{{"file", a.file},
                      {"width", p.width},
                      {"height", p.height},
                      {"samples_per_pixel", p.samples_per_pixel},
                      {"error", p.error},
                      {"top_noise", p.top_noise},
                      {"thread_s", p.seconds},
                      {"rays", p.rays},
                      {"largest_causes", largest_causes(p, a.names)}};
    for (const NamedTable& table : tables_of(p)) {
        ordered_json rows = ordered_json::array();
        for (const ProfileRow& row : table.rows) rows.push_back(row_json(row, a.names));
        json[table.key] = std::move(rows);
    }
    json["remedies"] = ordered_json::array();
    for (const Remedy& r : a.remedies) json["remedies"].push_back(remedy_json(r));
    return json;
}

}  // namespace fathom::cli
