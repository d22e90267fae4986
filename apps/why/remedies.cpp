// SPDX-License-Identifier: Apache-2.0
#include "why/remedies.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace fathom::cli {

namespace {

/// Causes below these shares are left alone.
constexpr double least_noise = 0.1, least_time = 0.1;
/// Light that a limited path length may lose.
constexpr double max_lost_light = 0.005;
/// Radiance over white at which indirect light is clamped.
constexpr double clamp_over_white = 10;
/// Gains below this one are not worth a change.
constexpr double least_gain = 1.1;

/// A change of settings or of the scene that may help.
struct Idea {
    std::string cause;
    double share = 0;
    std::string action, price;
    std::function<void(RenderSettings&)> set{};
    std::function<void(EditableScene&)> change{}, restore{};  ///< of the scene; empty for settings
    bool is_biased = false;  ///< the image becomes darker, and the price says by how much
};

template <class Test>
double noise_of(const std::vector<ProfileRow>& rows, const Test& test)
{
    double sum = 0;
    for (const ProfileRow& row : rows)
        if (test(row)) sum += row.noise;
    return sum;
}

bool is_delta_or_narrow(char event)
{
    return event == 'S' || event == 'T' || event == 'G' || event == 'F';
}

/// Whether a path comes to its light from a rough surface over mirrors or through glass, as caustics do.
bool is_caustic(const std::string& path)
{
    const std::size_t diffuse = path.find('D');
    return diffuse != std::string::npos && path.size() > 3 && is_delta_or_narrow(path[path.size() - 2]);
}

std::string of_noise(double share)
{
    return percent(share) + " of the noise";
}

void add_settings_ideas(const ProfiledScene& scene, std::vector<Idea>& ideas)
{
    const RenderProfile& p = scene.profile;
    const RenderSettings& now = scene.job.settings();
    const double caustics = noise_of(p.paths, [](const ProfileRow& r) { return is_caustic(r.path); });
    if (now.light_paths == 0 && now.light_sampling && (caustics >= least_noise || scene.has_refracted_light))
        ideas.push_back({.cause = "caustics: " + of_noise(caustics),
                         .share = caustics,
                         .action = "--caustics on",
                         .price = scene.has_refracted_light ? "adds light that is missing without it" : "",
                         .set = [](RenderSettings& s) { s.light_paths = usual_light_paths; }});
    const double indirect = noise_of(p.depths, [](const ProfileRow& r) { return r.index >= 2; });
    if (!now.guiding && indirect >= least_noise)
        ideas.push_back({.cause = "indirect light: " + of_noise(indirect),
                         .share = indirect,
                         .action = "--guiding on",
                         .price = "",
                         .set = [](RenderSettings& s) { s.guiding = true; }});
    const double sampled = noise_of(p.paths, [](const ProfileRow& r) { return r.is_sampled; });
    const auto lights = std::count_if(p.lights.begin(), p.lights.end(),
                                      [](const ProfileRow& r) { return r.cause != ProfileCause::no_light; });
    if (now.light_sampling && lights > 1 && sampled >= least_noise)
        for (const auto& [name, selection] : {std::pair{"tree", LightSelection::tree},
                                              {"power", LightSelection::power},
                                              {"uniform", LightSelection::uniform}})
            if (selection != now.light_selection)
                ideas.push_back({.cause = "light samples: " + of_noise(sampled),
                                 .share = sampled,
                                 .action = fmt::format("--light-selection {}", name),
                                 .price = "",
                                 .set = [selection](RenderSettings& s) { s.light_selection = selection; }});
    const double chance = noise_of(
        p.paths, [](const ProfileRow& r) { return r.cause == ProfileCause::path && !r.is_sampled && r.path != "EL"; });
    if (!now.light_sampling && chance >= least_noise)
        ideas.push_back({.cause = "lights found by chance: " + of_noise(chance),
                         .share = chance,
                         .action = "--light-sampling on",
                         .price = "",
                         .set = [](RenderSettings& s) { s.light_sampling = true; }});
    if (!now.clamp_indirect && indirect >= least_noise && p.top_noise >= least_noise) {
        const double limit = clamp_over_white * std::exp2(-scene.exposure_ev);
        ideas.push_back(
            {.cause = fmt::format("fireflies: {} of the noise is in 0.1 % of the pixels", percent(p.top_noise)),
             .share = p.top_noise,
             .action = fmt::format("--clamp-indirect {:.4g}", limit),
             .price = "biased",
             .set = [limit](RenderSettings& s) { s.clamp_indirect = float(limit); },
             .is_biased = true});
    }
}

/// The smallest depth limit that loses hardly any light, if the depths beyond it take time.
void add_depth_idea(const ProfiledScene& scene, std::vector<Idea>& ideas)
{
    std::vector<ProfileRow> rows = scene.profile.depths;
    std::sort(rows.begin(), rows.end(), [](const ProfileRow& a, const ProfileRow& b) { return a.index > b.index; });
    double light = 0, time = 0;
    int limit = -1;
    for (const ProfileRow& row : rows) {
        if (light + row.light > max_lost_light || row.index < 2) break;
        light += row.light, time += row.time;
        limit = row.index - 1;
    }
    const int now = scene.job.settings().max_depth;
    if (limit < 1 || time < least_time || (now >= 0 && now <= limit)) return;
    ideas.push_back(
        {.cause = fmt::format("depths above {}: {} of the time, {} of the light", limit, percent(time), percent(light)),
         .share = time,
         .action = fmt::format("--max-depth {}", limit),
         .price = "biased",
         .set = [limit](RenderSettings& s) { s.max_depth = limit; },
         .is_biased = true});
}

bool is_solid_glass(const Material& m)
{
    return m.kind == MaterialKind::glass && !m.interior.thin;
}

void add_scene_ideas(const ProfiledScene& scene, std::vector<Idea>& ideas)
{
    const SceneDescription& description = scene.edit.description();
    const double caustics = noise_of(scene.profile.paths, [](const ProfileRow& r) { return is_caustic(r.path); });
    for (const ProfileRow& row : scene.profile.materials) {
        const auto index = std::size_t(row.index);
        if (row.cause != ProfileCause::material || index >= description.materials.size()) continue;
        const Material material = description.materials[index];
        if (!is_solid_glass(material) || std::max(row.noise, caustics) < least_noise || row.noise < 0.01) continue;
        Material thin = material;
        thin.interior.thin = true;
        ideas.push_back({.cause = fmt::format("{}: {}", scene.names.name(row), of_noise(row.noise)),
                         .share = row.noise,
                         .action = fmt::format("make {} `thin`", scene.names.name(row)),
                         .price = "for panes and shades only: it no longer bends light",
                         .change = [index, thin](EditableScene& e) { e.set_material(int(index), thin); },
                         .restore = [index, material](EditableScene& e) { e.set_material(int(index), material); }});
        break;  // only the noisiest glass
    }
}

/// Lights that take shadow rays and bring no light.
void add_light_ideas(const ProfiledScene& scene, std::vector<Idea>& ideas)
{
    double time = 0, light = 0;
    std::vector<int> useless;
    std::string name;
    for (const ProfileRow& row : scene.profile.lights) {
        if (row.cause != ProfileCause::light || row.light > 1e-4) continue;
        time += row.time, light += row.light;
        if (useless.empty()) name = scene.names.name(row);
        useless.push_back(row.index);
    }
    if (useless.empty() || time < 0.02) return;
    const std::vector<Node> nodes = scene.edit.description().nodes;
    ideas.push_back(
        {.cause = fmt::format("lights that bring {} of the light: {} of the time", percent(light), percent(time)),
         .share = time,
         .action = useless.size() == 1 ? fmt::format("remove {}", name)
                                       : fmt::format("remove {} and {} more lights", name, useless.size() - 1),
         .price = "",
         .change =
             [useless](EditableScene& e) {
                 for (Node& node : e.edit_description().nodes)
                     if (std::find(useless.begin(), useless.end(), node.light) != useless.end()) node.light = -1;
             },
         .restore =
             [nodes](EditableScene& e) {
                 for (std::size_t i = 0; i < nodes.size(); ++i) e.edit_description().nodes[i].light = nodes[i].light;
             }});
}

/// Renders with the change of an idea. Nothing if that can't be measured.
std::optional<Trial> run_idea(const Idea& idea, ProfiledScene& scene, int samples, const std::atomic<bool>& cancel)
{
    RenderSettings settings = scene.job.settings();
    if (idea.set) idea.set(settings);
    if (!idea.change) return run_trial(RenderJob(scene.job.scene(), scene.job.camera(), settings), samples, cancel);
    Warnings warnings;
    idea.change(scene.edit);
    const Scene changed = scene.edit.compile(warnings);
    const std::optional<Trial> trial = run_trial(RenderJob(changed, settings), samples, cancel);
    idea.restore(scene.edit);
    return trial;
}

std::string price_of_bias(const Trial& before, const Trial& after)
{
    return fmt::format("biased: the image is {} darker",
                       percent(std::max(0.0, 1 - after.brightness / before.brightness)));
}

}  // namespace

bool Remedy::helps() const
{
    return gain.value >= least_gain && gain.low > 1;
}

std::vector<Remedy> try_remedies(ProfiledScene scene, int samples, const std::atomic<bool>& cancel)
{
    std::vector<Idea> ideas;
    add_settings_ideas(scene, ideas);
    add_depth_idea(scene, ideas);
    add_light_ideas(scene, ideas);
    add_scene_ideas(scene, ideas);
    std::vector<Remedy> remedies;
    if (ideas.empty()) return remedies;
    const std::optional<Trial> before = run_trial(scene.job, samples, cancel);
    if (!before) return remedies;
    for (const Idea& idea : ideas) {
        const std::optional<Trial> after = run_idea(idea, scene, samples, cancel);
        if (cancel) break;
        if (!after) continue;
        remedies.push_back({idea.cause, idea.share, idea.action,
                            idea.is_biased ? price_of_bias(*before, *after) : idea.price, gain_of(*before, *after)});
    }
    std::stable_sort(remedies.begin(), remedies.end(), [](const Remedy& a, const Remedy& b) {
        if (a.helps() != b.helps()) return a.helps();
        return a.share > b.share;
    });
    return remedies;
}

}  // namespace fathom::cli
