// SPDX-License-Identifier: Apache-2.0
#include "fathom/lighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/luminance.h"
#include "presentation/ground.h"
#include "presentation/refracted_lamps.h"

namespace fathom {

namespace {

constexpr int across = 64;
constexpr std::uint64_t samples = 16;

Image small_picture(const Scene& scene, double aspect, int max_depth)
{
    RenderSettings settings;
    settings.width = across;
    settings.height = std::clamp(int(std::lround(across / aspect)), 1, 4 * across);
    settings.max_depth = max_depth;
    settings.filter = Filter::box;
    settings.background = Color{0, 0, 0};
    settings.alpha = true;
    const RenderJob job(scene, settings);
    Film film(job);
    render(job, {0, samples}, film);
    return film.image(true, false);
}

double quantile(const std::vector<double>& sorted, double share)
{
    return sorted[std::min(sorted.size() - 1, std::size_t(share * double(sorted.size())))];
}

}  // namespace

double LightingProbe::exposure_ev() const
{
    constexpr double middling = 0.22, white = 1;
    if (!(middle > 0) || !(bright > 0)) return 0;
    return std::min(std::log2(middling / middle), std::log2(white / bright));
}

LightingProbe probe_lighting(const Scene& scene, double aspect)
{
    // The probe renders a few bounces of light and subtracts directly visible emission.
    const Image all = small_picture(scene, aspect, 4), lamps = small_picture(scene, aspect, 0);
    const std::vector<float>&shown = all.find("")->pixels, &own = lamps.find("")->pixels;
    const std::size_t pixels = shown.size() / 4;
    std::vector<double> light;
    for (std::size_t i = 0; i < pixels; ++i)
        if (shown[4 * i + 3] >= 0.5f) light.push_back(std::max(0.0, luminance(&shown[4 * i]) - luminance(&own[4 * i])));
    LightingProbe look;
    look.covered = double(light.size()) / double(pixels);
    if (light.empty()) return look;
    std::sort(light.begin(), light.end());
    look.bright = quantile(light, 0.95);
    constexpr double dark = 0.02;
    const auto first_lit = std::upper_bound(light.begin(), light.end(), dark * look.bright);
    look.lit = double(light.end() - first_lit) / double(light.size());
    light.erase(light.begin(), first_lit);
    if (!light.empty()) look.middle = quantile(light, 0.5);
    return look;
}

namespace {

/// The studio is rotated with the camera.
Environment studio_for(const Camera& camera)
{
    Environment studio;
    studio.kind = EnvironmentKind::studio;
    const Vec3d forward = camera.look_at - camera.position;
    studio.world_from_environment = Transform::rotate({0, 1, 0}, std::atan2(-forward.x, -forward.z));
    return studio;
}

void remove_lights(SceneDescription& scene)
{
    for (Node& node : scene.nodes) node.light = -1;
}

/// Whether the scene has lights other than emissive surfaces.
bool has_lamps(const SceneDescription& scene)
{
    return scene.environment.kind != EnvironmentKind::none ||
           std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.light >= 0; });
}

bool has_light(const SceneDescription& scene)
{
    return has_lamps(scene) || std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
               return std::max(
                          {m.emission.radiance.value.r, m.emission.radiance.value.g, m.emission.radiance.value.b}) > 0;
           });
}

/// Whether all materials are unlit. Such scenes are shown as they are, without a probe.
bool is_unlit(const SceneDescription& scene)
{
    return !scene.materials.empty() && std::all_of(scene.materials.begin(), scene.materials.end(),
                                                   [](const Material& m) { return m.kind == MaterialKind::unlit; });
}

/// Adds the ground if it is requested; the scene must then be compiled again.
///
/// fits  whether the model is lit by a studio alone
void add_ground_if_fitting(EditableScene& edit, LitScene& result, const std::optional<Ground>& ground, bool fits)
{
    if (!ground || (ground->only_if_visible_from_above && !fits)) return;
    const SceneDescription& scene = edit.description();
    const Bounds model = ground->bounds ? *ground->bounds : world_bounds(scene);
    if (model.empty) return;
    if (ground->only_if_visible_from_above && !ground_fits(model, world_camera(scene, edit.camera()))) return;
    result.scene = {};
    add_ground(edit.edit_description(), *ground, model, result.studio);
    result.ground = true;
    if (ground->only_if_visible_from_above)
        result.added.push_back("a ground plane that catches its shadow (disable it with --ground none)");
}

}  // namespace

namespace {

LitScene compile_with_light(EditableScene& edit, LightingMode light, double aspect, Warnings& warnings,
                            const std::optional<Ground>& ground)
{
    const SceneDescription& scene = edit.description();
    // Minimum fraction of the visible surface that must be lit; with less, exposure would only show a lamp and its
    // surroundings.
    constexpr double min_lit = 0.4;
    // Maximum exposure for scenes lit by emissive surfaces: with more, these would become white and their labels
    // unreadable.
    constexpr double max_stops_for_surfaces = 2;
    const bool lit = has_light(scene), own_light = scene.hints.own_light || light == LightingMode::file;
    const bool lamps = has_lamps(scene);
    const EnvironmentKind sky = scene.environment.kind;
    const bool wants_exposure =
        !scene.hints.exposure && lit && (sky == EnvironmentKind::none || sky == EnvironmentKind::sky);
    LitScene result;
    if (light == LightingMode::studio) remove_lights(edit.edit_description());
    const bool needs_studio =
        light == LightingMode::studio || (light == LightingMode::automatic && !lit && !is_unlit(scene));
    if (needs_studio) edit.set_environment(studio_for(world_camera(scene, edit.camera())));
    if (needs_studio || !wants_exposure || is_unlit(scene)) {
        // A backdrop shows the outlines of unlit, dark objects.
        result.backdrop = needs_studio || (light == LightingMode::automatic && is_unlit(scene) && !own_light);
        result.studio = needs_studio;
        if (needs_studio && light == LightingMode::automatic) result.added.push_back("a studio light");
        add_ground_if_fitting(edit, result, ground, needs_studio && !scene.hints.own_light);
        result.scene = edit.compile(warnings);
        return result;
    }
    result.scene = edit.compile(warnings);
    const LightingProbe look = probe_lighting(result.scene, aspect);
    if (look.covered == 0) return result;
    const bool is_decoration = !lamps && look.exposure_ev() > max_stops_for_surfaces;
    if ((look.lit < min_lit || is_decoration) && !own_light) {
        edit.set_environment(studio_for(result.scene.camera()));
        result.scene = {};
        result.studio = result.backdrop = true;
        result.added.push_back(
            is_decoration
                ? "a studio light, because its emissive surfaces light little of it (disable it with --light file)"
                : fmt::format("a studio light, because its own light reaches only {:.0f} % of what is visible (disable "
                              "it with --light file)",
                              100 * look.lit));
        add_ground_if_fitting(edit, result, ground, !lamps);
        result.scene = edit.compile(warnings);
        return result;
    }
    add_ground_if_fitting(edit, result, ground, false);
    if (result.ground) result.scene = edit.compile(warnings);
    // Deviations below half a stop are taken as intended.
    const double stops = std::round(2 * look.exposure_ev()) / 2;
    if (std::abs(stops) < 1.5) return result;
    result.exposure_ev = stops;
    result.added.push_back(
        fmt::format("an exposure of {:+} stops for its light (disable it with --exposure 0)", stops));
    return result;
}

}  // namespace

LitScene compile_lit(EditableScene& edit, LightingMode light, double aspect, Warnings& warnings,
                     const std::optional<Ground>& ground)
{
    LitScene result = compile_with_light(edit, light, aspect, warnings, ground);
    result.has_smooth_glass = has_smooth_glass(result.scene);
    result.refracted_light = describe_refracted_lamps(result.scene, edit.description());
    return result;
}

LitScene compile_lit(SceneDescription scene, const std::string& camera, LightingMode light, double aspect,
                     Warnings& warnings, BvhQuality build, const std::optional<Ground>& ground)
{
    EditableScene edit(std::move(scene), camera, build);
    return compile_lit(edit, light, aspect, warnings, ground);
}

}  // namespace fathom
