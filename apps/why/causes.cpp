// SPDX-License-Identifier: Apache-2.0
#include "why/causes.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace fathom::cli {

namespace {

/// A name in quotes; control characters, which could change the terminal, become question marks.
std::string quoted(const std::string& kind, std::string name, std::size_t index)
{
    if (name.empty()) return fmt::format("{} {}", kind, index + 1);
    for (char& c : name)
        if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
    // scene_objects() calls objects without a name "object 7".
    if (name.starts_with(kind + ' ')) return name;
    return fmt::format("{} '{}'", kind, name);
}

/// Share below which a cause is not worth a sentence.
constexpr double least_share = 0.05;

const ProfileRow& largest_by_time(const std::vector<ProfileRow>& rows)
{
    return *std::max_element(rows.begin(), rows.end(),
                             [](const ProfileRow& a, const ProfileRow& b) { return a.time < b.time; });
}

}  // namespace

std::string percent(double share)
{
    const double p = 100 * share;
    return fmt::format("{:.{}f} %", p, std::abs(p) < 9.95 ? 1 : 0);
}

std::vector<NamedTable> tables_of(const RenderProfile& p)
{
    return {
        {"lights", "light", p.lights},    {"materials", "material", p.materials},
        {"objects", "object", p.objects}, {"paths", "kind of path", p.paths},
        {"depths", "depth", p.depths},    {"combinations", "kind of path, light and material", p.combinations, false}};
}

CauseNames::CauseNames(const SceneDescription& scene, std::vector<SceneObject> objects) : objects_(std::move(objects))
{
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        materials_.push_back(quoted(material_kind_name(scene.materials[i].kind), scene.materials[i].name, i));
    for (std::size_t i = 0; i < scene.lights.size(); ++i)
        lights_.push_back(
            quoted(fmt::format("{} light", light_kind_name(scene.lights[i].kind)), scene.lights[i].name, i));
}

std::string CauseNames::cause_name(ProfileCause cause, int number) const
{
    const auto index = std::size_t(number);
    switch (cause) {
        case ProfileCause::light:
            return index < lights_.size() ? lights_[index] : "light";
        case ProfileCause::emitter:
        case ProfileCause::object:
            return index < objects_.size() ? quoted("object", objects_[index].name, index) : "object";
        case ProfileCause::environment:
            return "environment";
        case ProfileCause::no_light:
            return "no shadow rays";
        case ProfileCause::material:
            return index < materials_.size() ? materials_[index] : "default material";
        case ProfileCause::medium:
            return "inside of media";
        case ProfileCause::depth:
            return fmt::format("{}", number);
        default:
            return "seen directly";
    }
}

std::string CauseNames::name(const ProfileRow& row) const
{
    if (row.cause != ProfileCause::path && row.cause != ProfileCause::combination)
        return cause_name(row.cause, row.index);
    const std::string path =
        row.path == "EL" ? row.path : fmt::format("{} by {}", row.path, row.is_sampled ? "light samples" : "rays");
    if (row.cause == ProfileCause::path) return path;
    const std::string light = cause_name(row.light_cause, row.light_index);
    if (row.place_cause == ProfileCause::camera) return fmt::format("{}: {} seen directly", path, light);
    return fmt::format("{}: light of {} at {}", path, light, cause_name(row.place_cause, row.place_index));
}

std::vector<std::string> largest_causes(const RenderProfile& p, const CauseNames& names)
{
    if (p.combinations.empty() || !(p.error > 0)) return {"there is no noise"};
    struct Cause {
        double noise;
        std::string text;
    };
    std::vector<Cause> causes;
    const auto add = [&](const ProfileRow& row, const char* before) {
        if (row.noise >= least_share) causes.push_back({row.noise, before + names.name(row)});
    };
    const auto has_light = [](const ProfileRow& row) { return row.light > 0; };
    if (std::count_if(p.lights.begin(), p.lights.end(), has_light) > 1) add(p.lights.front(), "light of ");
    add(p.materials.front(), p.materials.front().cause == ProfileCause::camera ? "" : "light found at ");
    add(p.paths.front(), "paths ");
    add(p.combinations.front(), "");
    std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) { return a.noise > b.noise; });
    std::vector<std::string> lines;
    for (const Cause& c : causes) lines.push_back(fmt::format("{} of the noise: {}", percent(c.noise), c.text));
    const ProfileRow& slow = largest_by_time(p.materials);
    lines.push_back(fmt::format("{} of the time: {}", percent(slow.time),
                                slow.cause == ProfileCause::camera ? "rays from the camera" : names.name(slow)));
    return lines;
}

}  // namespace fathom::cli
