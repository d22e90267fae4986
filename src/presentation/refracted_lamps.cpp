// SPDX-License-Identifier: Apache-2.0
#include "presentation/refracted_lamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "compile/scene_data.h"
#include "lights/compile/kind.h"

namespace fathom {

namespace {

constexpr int pixels_across = 64;

/// A camera at the position of a lamp, and the lamp's cone of emission.
struct LampView {
    Camera camera;
    Vec3d axis;
    double cos_cone =
        -1;  ///< cosine of the emission cone, outside of which there is no light; -1: emits in all directions
};

Camera looking_along(Vec3d position, Vec3d direction)
{
    Camera camera;
    camera.position = position;
    camera.look_at = position + direction;
    camera.up = std::abs(direction.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    return camera;
}

class LampViews {
public:
    LampViews(const SceneTables& tables, const std::function<Bounds()>& bounds) : t_(tables), bounds_(bounds) {}

    /// Returns the view of a light that rays cannot hit; nothing for other lights.
    std::optional<LampView> of(const LightRecord& light)
    {
        if (light.primitive != no_index || LightRecordKind(light.kind) == LightRecordKind::environment) return {};
        if (light.is<SpotLightRecord>()) return cone(light.get<SpotLightRecord>());
        if (light.is<PicturedLightRecord>()) return cone(light.get<PicturedLightRecord>().spot);
        if (light.is<BeamLightRecord>()) return beam(light.get<BeamLightRecord>());
        if (light.is<DirectionalLightRecord>()) return direction(light.get<DirectionalLightRecord>());
        LightBall ball;
        visit_light(light, [&](const auto& own) { ball = own.ball({}); });
        return all_around(ball.center);
    }

private:
    Vec3d world(const Vec3d& p) const { return p * (1 / t_.render_scale) + t_.origin; }

    LampView all_around(const Vec3d& center) const
    {
        LampView view{looking_along(world(center), {0, 0, -1}), {0, 0, -1}};
        view.camera.kind = CameraKind::equal_area;
        return view;
    }
    LampView cone(const SpotLightRecord& light) const
    {
        const Vec3d axis = normalize(to_vector(light.axis));
        const double cos_cone = 1 - double(light.outer), angle = std::acos(std::clamp(cos_cone, -1.0, 1.0));
        LampView view{looking_along(world(to_vector(light.position)), axis), axis, cos_cone};
        if (angle > 1.2)
            view.camera.kind = CameraKind::equal_area;
        else
            view.camera.fov_y = std::max(2 * angle, 1e-4);
        return view;
    }
    LampView beam(const BeamLightRecord& light) const
    {
        const Vec3d axis = normalize(to_vector(light.axis));
        LampView view{looking_along(world(to_vector(light.center)), axis), axis};
        view.camera.kind = CameraKind::orthographic;
        const double reach = std::max(length(to_vector(light.half_u)), length(to_vector(light.half_v)));
        view.camera.height = 2 * reach / t_.render_scale;
        return view;
    }
    std::optional<LampView> direction(const DirectionalLightRecord& light)
    {
        if (light.one_minus_cos > 0) return {};
        const Bounds all = bounds_();
        const Vec3d axis = normalize(to_vector(light.axis)), middle = (all.min + all.max) * 0.5;
        const double radius = std::max(length(all.max - all.min) / 2, 1e-6);
        LampView view{looking_along(middle - axis * (2 * radius), axis), axis};
        view.camera.kind = CameraKind::orthographic;
        view.camera.height = 2 * radius;
        return view;
    }

    const SceneTables& t_;
    const std::function<Bounds()>& bounds_;
};

/// Whether the surface transmits light only by smooth refraction. It then blocks shadow rays, and connections through
/// it are impossible.
bool refracts_smoothly(const ShadingTables& tables, const MaterialRecord& m)
{
    constexpr float rough = 0.0316228f;  // the square root of the alpha below which microfacets are treated as mirrors
    const auto is_smooth = [&](const auto& record) {
        return record.roughness_texture.texture == no_index && record.roughness <= rough;
    };
    if (m.features.has_any(MaterialFeature::thin | MaterialFeature::index_matched_boundary)) return false;
    switch (m.closure) {
        case ClosureKind::glass:
            return is_smooth(m.parameters_as<GlassRecord>());
        case ClosureKind::disney_transmitting:
            return is_smooth(m.parameters_as<PrincipledRecord>());
        case ClosureKind::layered_transmitting: {
            const auto record = m.parameters_as<PrincipledRecord>();
            return is_smooth(record) && (tables.layers[record.table].features & LayersRecord::with_transmission) != 0;
        }
        default:
            return false;
    }
}

/// Numbers of hits: on refracting surfaces, and on all surfaces.
struct Seen {
    std::size_t glass = 0, all = 0;
};

Seen look_from(const Scene& scene, const LampView& view, const std::vector<bool>& is_glass)
{
    RenderSettings settings;
    settings.width = settings.height = pixels_across;
    settings.max_depth = 0;
    settings.filter = Filter::box;
    settings.aovs = {Aov::position, Aov::material_id, Aov::depth};
    Camera camera = view.camera;
    camera.shutter_open = scene.camera().shutter_open, camera.shutter_close = scene.camera().shutter_close;
    const RenderJob job(scene, camera, settings);
    Film film(job);
    render(job, {0, 1}, film);
    const Image image = film.image(false, false);
    const std::vector<float>&places = image.find("position")->pixels, &materials = image.find("material")->pixels,
          &depths = image.find("depth")->pixels;
    Seen seen;
    for (std::size_t i = 0; i < depths.size(); ++i) {
        if (!std::isfinite(depths[i])) continue;
        const Vec3d to = to_vector(&places[3 * i]) - view.camera.position;
        if (view.cos_cone > -1 && dot(to, view.axis) < view.cos_cone * length(to)) continue;
        ++seen.all;
        const std::size_t material = std::size_t(materials[i]);
        seen.glass += material < is_glass.size() && is_glass[material];
    }
    return seen;
}

}  // namespace

bool has_smooth_glass(const Scene& scene)
{
    const SceneTables& tables = *scene.data().tables;
    return std::any_of(tables.materials.begin(), tables.materials.end(),
                       [&](const MaterialRecord& m) { return refracts_smoothly(tables, m); });
}

RefractedLamps find_refracted_lamps(const Scene& scene, const std::function<Bounds()>& bounds)
{
    constexpr std::size_t max_lamps = 16;
    constexpr double nearly_all = 0.98;
    RefractedLamps result;
    if (!has_smooth_glass(scene)) return result;
    const SceneTables& tables = *scene.data().tables;
    std::vector<bool> is_glass;
    for (const MaterialRecord& m : tables.materials) is_glass.push_back(refracts_smoothly(tables, m));
    LampViews views(tables, bounds);
    double shares = 0;
    std::size_t lit = 0;
    for (const LightRecord& light : tables.lights) {
        const std::optional<LampView> view = views.of(light);
        if (!view) continue;
        if (result.lamps == max_lamps) break;
        ++result.lamps;
        const Seen seen = look_from(scene, *view, is_glass);
        if (seen.all == 0) continue;
        const double share = double(seen.glass) / double(seen.all);
        result.hidden += share > nearly_all;
        shares += share, ++lit;
    }
    if (lit > 0) result.light_on_glass = shares / double(lit);
    return result;
}

std::string describe_refracted_lamps(const Scene& scene, const SceneDescription& description)
{
    constexpr double noticeable = 0.01;
    const RefractedLamps found = find_refracted_lamps(scene, [&] { return world_bounds(description); });
    if (found.light_on_glass < noticeable) return "";
    if (found.hidden > 0)
        return fmt::format("{} of {} lights without size are visible through glass only", found.hidden, found.lamps);
    return fmt::format("{:.0f} % of the light of lights without size falls on glass",
                       std::max(1.0, 100 * found.light_on_glass));
}

}  // namespace fathom
