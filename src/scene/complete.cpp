#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/load.h"
#include "scene/check.h"
#include "scene/motion.h"

namespace fathom {

namespace {

/// What of the scene a picture can show.
struct Contents {
    bool camera = false, environment = false, emitter = false;
    struct PlacedLight {
        const Light* light;
        Vec3d position;
    };
    std::vector<PlacedLight> lights;
};

/// Whether a surface is a lamp. A texture of at most radiance 1 is decoration, as the displays and glowing seams of
/// many models: taken for the only light it would leave the picture dark.
bool emits(const SceneDescription& scene, const Shape& shape)
{
    if (shape.material < 0) return false;
    const ColorInput& emission = scene.materials[std::size_t(shape.material)].emission;
    const float largest = std::max({emission.value.r, emission.value.g, emission.value.b});
    return emission.texture < 0 ? largest > 0 : largest > 1;
}

void add_contents(Contents& found, const SceneDescription& scene, const Transform& parent, int index)
{
    const Node& node = scene.nodes[std::size_t(index)];
    const Transform world_from_node = parent * transform_at(node, 0);
    found.camera |= node.camera >= 0;
    if (node.light >= 0)
        found.lights.push_back({&scene.lights[std::size_t(node.light)], world_from_node.point({0, 0, 0})});
    for (const Shape& shape : node.shapes) found.emitter |= emits(scene, shape);
    for (int child : node.children) add_contents(found, scene, world_from_node, child);
}

/// Stops that bring a grey surface in the middle of the scene to a middling brightness; 0 if it is near that already.
/// Files in real units have lights of hundreds of candela or thousands of lux, which are white without this.
double exposure_for(const std::vector<Contents::PlacedLight>& lights, const Bounds& bounds)
{
    const Vec3d center = bounds.min * 0.5 + bounds.max * 0.5;
    // A lamp inside a model is as far from its surfaces as these are from the middle, more or less.
    const double near = 0.25 * length(bounds.max - bounds.min);
    double lux = 0;
    for (const auto& [light, position] : lights) {
        const double brightest = std::max({light->intensity.r, light->intensity.g, light->intensity.b});
        const double distance = std::max(length(position - center), near);
        lux += light->kind == LightKind::directional ? brightest : brightest / (distance * distance);
    }
    constexpr double albedo = 0.5, wanted = 0.35;
    if (!(lux > 0) || !std::isfinite(lux) || bounds.empty) return 0;
    const double stops = std::log2(wanted * std::numbers::pi / (albedo * lux));
    return std::abs(stops) < 1.5 ? 0 : std::round(2 * stops) / 2;
}

/// The camera that sees the whole box from a direction, its distance no larger than that needs (with a margin of 5 %).
Camera framing_camera(const Bounds& bounds, const CompleteOptions& options)
{
    const double azimuth = options.azimuth_deg * std::numbers::pi / 180;
    const double elevation = options.elevation_deg * std::numbers::pi / 180;
    const Vec3d to_camera{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                          std::cos(azimuth) * std::cos(elevation)};
    // The derivative of to_camera by elevation: it is never parallel to the view, also straight from above.
    const Vec3d up{-std::sin(azimuth) * std::sin(elevation), std::cos(elevation),
                   -std::cos(azimuth) * std::sin(elevation)};
    const Vec3d right = cross(up, to_camera);

    Camera camera;
    camera.name = "framing";
    const Vec3d center = bounds.min * 0.5 + bounds.max * 0.5;
    const Vec3d half = bounds.max * 0.5 - bounds.min * 0.5;
    const double tan_y = std::tan(camera.fov_y / 2), tan_x = tan_y * options.aspect;
    double distance = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3d p{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
        const double aside = std::max(std::abs(dot(p, right)) / tan_x, std::abs(dot(p, up)) / tan_y);
        distance = std::max(distance, dot(p, to_camera) + 1.05 * aside);
    }
    // A scene without geometry, or one point, still gets a camera.
    if (!(distance > 0)) distance = 1;
    camera.position = center + distance * to_camera;
    camera.look_at = center;
    camera.up = up;
    return camera;
}

/// Puts a camera before the others: the first is the one that is rendered.
void add_first_camera(SceneDescription& scene, Camera camera)
{
    for (Node& node : scene.nodes)
        if (node.camera >= 0) ++node.camera;
    scene.cameras.insert(scene.cameras.begin(), std::move(camera));
    Node node;
    node.name = "framing camera";
    node.camera = 0;
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
}

/// Bright above and dim below, nearly neutral, so that colours stay what they are and forms show.
Environment studio()
{
    Environment environment;
    environment.kind = EnvironmentKind::gradient;
    environment.top = {1.0f, 1.0f, 1.05f};
    environment.bottom = {0.30f, 0.29f, 0.28f};
    return environment;
}

}  // namespace

Completed complete_scene(SceneDescription& scene, const CompleteOptions& options)
{
    check_scene(scene);
    Completed completed;
    Contents found;
    found.environment = scene.environment.kind != EnvironmentKind::none;
    for (int root : scene.roots) add_contents(found, scene, {}, root);
    const Bounds bounds = world_bounds(scene);
    if (!found.environment && !found.emitter && !found.lights.empty() && !scene.hints.exposure) {
        if (const double stops = exposure_for(found.lights, bounds); stops != 0) {
            scene.hints.exposure = stops;
            completed.added.push_back(fmt::format("an exposure of {:+} stops for its lights", stops));
        }
    }
    if (!found.camera || options.force_camera) {
        add_first_camera(scene, framing_camera(bounds, options));
        // One that was asked for is nothing that the file lacked.
        if (!options.force_camera) completed.added.push_back("a camera that frames the scene");
    }
    if (!found.environment && !found.emitter && found.lights.empty()) {
        scene.environment = studio();
        completed.added.push_back("a soft studio light");
    }
    return completed;
}

}  // namespace fathom
