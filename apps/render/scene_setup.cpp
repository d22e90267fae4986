// SPDX-License-Identifier: Apache-2.0
#include "render/scene_setup.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "fathom/error.h"

namespace fathom::cli {

namespace {

constexpr Size default_size{800, 600};

const Camera* chosen_camera(const SceneDescription& scene, const std::string& name)
{
    for (const Camera& camera : scene.cameras)
        if (name.empty() || camera.name == name) return &camera;
    return nullptr;
}

/// Rounds the side of an image, to at least one pixel.
int rounded_side(double pixels)
{
    return std::max(1, int(std::lround(std::min(pixels, double(1 << 24)))));
}

Size resolve_size(const SceneOptions& options, const std::string& camera_name, const SceneDescription& scene)
{
    if (options.size) return *options.size;
    const RenderHints& hints = scene.hints;
    Size size{hints.width.value_or(default_size.width), hints.height.value_or(default_size.height)};
    if (size.width < 1 || size.height < 1)
        throw Error(scene.file, "", fmt::format("an image of {}x{} pixels can't be rendered", size.width, size.height));
    const Camera* camera = options.orbit_deg || options.turntable ? nullptr : chosen_camera(scene, camera_name);
    double aspect = camera && camera->aspect > 0 ? camera->aspect : 0;
    if (hints.width && hints.height) return size;
    if (hints.width || hints.height) {
        if (aspect == 0) aspect = double(default_size.width) / default_size.height;
        if (hints.width) size.height = rounded_side(size.width / aspect);
        if (hints.height) size.width = rounded_side(size.height * aspect);
    } else if (aspect > 0) {
        // The default size is the largest image of the camera's shape within these limits.
        if (aspect > double(size.width) / size.height)
            size.height = rounded_side(size.width / aspect);
        else
            size.width = rounded_side(size.height * aspect);
    }
    return size;
}

std::optional<BvhQuality> resolve_bvh_quality(const SceneOptions& options, const SceneDescription& scene)
{
    if (options.build || !scene.hints.build) return options.build;
    const auto name = std::find(bvh_quality_names.begin(), bvh_quality_names.end(), *scene.hints.build);
    if (name == bvh_quality_names.end())
        throw Error(scene.file, "build",
                    fmt::format("expected {}, found '{}'", fmt::join(bvh_quality_names, " or "), *scene.hints.build));
    return BvhQuality(name - bvh_quality_names.begin());
}

void use_environment(SceneDescription& scene, const std::filesystem::path& file)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) throw Error(file.string(), "--env", "there is no such image");
    scene.environment = {};
    scene.environment.kind = EnvironmentKind::image;
    scene.environment.image = int(scene.images.size());
    ImageFile image;
    image.name = file.filename().string();
    image.path = file;
    scene.images.push_back(image);
}

/// Replaces the file's lamps and environment with a clear sky.
void use_sky(SceneDescription& scene, const SceneOptions& options)
{
    scene.environment = {};
    scene.environment.kind = EnvironmentKind::sky;
    scene.environment.sun_disk = options.with_sun;
    scene.environment.to_sun = direction_to_sun(options.sun);
    for (Node& node : scene.nodes) node.light = -1;
    // The sky is in physical units, so the file's exposure does not fit it.
    scene.hints.exposure.reset();
}

/// Applies --env-rotate and --env-strength to the environment of the options or of the scene.
void adjust_environment(Environment& environment, const SceneOptions& options)
{
    if (options.environment_turn_deg == 0 && !options.environment_strength) return;
    if (environment.kind == EnvironmentKind::none)
        throw UsageError("--env-rotate, --env-strength: the scene has no environment; add --env FILE");
    const double turn = options.environment_turn_deg * std::numbers::pi / 180;
    environment.world_from_environment = Transform::rotate({0, 1, 0}, turn) * environment.world_from_environment;
    const auto strength = float(options.environment_strength.value_or(1));
    for (Color* c : {&environment.color, &environment.bottom, &environment.top})
        *c = {c->r * strength, c->g * strength, c->b * strength};
}

/// A name that no camera has.
std::string unused_name(const SceneDescription& scene, std::string name)
{
    while (chosen_camera(scene, name)) name += "'";
    return name;
}

/// The name of the camera that a name or number means. A camera that a number means gets a unique name.
std::string name_of_camera(SceneDescription& scene, const std::string& wanted)
{
    const bool is_number = !wanted.empty() && wanted.find_first_not_of("0123456789") == std::string::npos;
    if (!is_number || chosen_camera(scene, wanted)) return wanted;
    const std::uint64_t last = std::max<std::size_t>(scene.cameras.size(), 1) - 1;
    if (scene.cameras.empty() || wanted.size() > 9 || std::stoull(wanted) > last) return wanted;
    Camera& camera = scene.cameras[std::stoul(wanted)];
    const std::string name = std::exchange(camera.name, {});
    camera.name = unused_name(scene, name.empty() ? "camera " + wanted : name);
    return camera.name;
}

/// The chosen camera at its current place, with the options applied.
Camera moved_camera(const SceneDescription& scene, const std::string& name, const SceneOptions& options)
{
    Camera camera = world_camera(scene, name);
    if (options.look_from) camera.position = *options.look_from;
    if (options.look_at) camera.look_at = *options.look_at;
    // The focus distance of the old position does not fit the new one.
    if (options.look_from || options.look_at) camera.focus_distance = 0;
    if (options.up) camera.up = *options.up;
    if (options.fov_deg) {
        camera.kind = CameraKind::perspective;
        camera.fov_y = *options.fov_deg * std::numbers::pi / 180;
        camera.fov_aspect = 0;
    }
    const Vec3d forward = camera.look_at - camera.position;
    if (!(length(forward) > 0)) throw UsageError("--look-from, --look-at: the camera is at the point that it looks at");
    if (!(length(cross(normalize(forward), normalize(camera.up))) > 1e-9)) {
        if (options.up) throw UsageError("--up: the camera looks along this direction");
        // For a camera that looks straight up or down, any perpendicular direction is valid.
        camera.up = std::abs(normalize(forward).z) < 0.9 ? Vec3d{0, 0, -1} : Vec3d{0, 1, 0};
    }
    return camera;
}

/// Adds moved_camera() at the root of the scene, and returns its name.
std::string add_moved_camera(SceneDescription& scene, const std::string& name, const SceneOptions& options)
{
    Camera camera = moved_camera(scene, name, options);
    camera.name = unused_name(scene, "command line");
    Node node;
    node.camera = int(scene.cameras.size());
    scene.cameras.push_back(camera);
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(node);
    return camera.name;
}

/// Tells which animations the file has, and how to show them; empty without any.
std::string animations_note(const std::vector<Animation>& animations)
{
    if (animations.empty()) return {};
    constexpr std::size_t max_names = 8;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min(max_names, animations.size()); ++i) names.push_back(animations[i].name);
    if (animations.size() > max_names) names.push_back("...");
    return fmt::format(
        "showing the pose at rest; the file has {} {} ({}): --at SECONDS shows another pose, --frames A:B renders "
        "frames",
        animations.size(), animations.size() == 1 ? "animation" : "animations", fmt::join(names, ", "));
}

/// Index of the animation to play. `all`, unless it is a name, joins all animations; where several move one thing, the
/// last of them wins.
std::size_t chosen_animation(SceneFileContents& file, const std::string& wanted)
{
    std::vector<Animation>& animations = file.rig.animations;
    const bool is_a_name =
        std::any_of(animations.begin(), animations.end(), [&](const Animation& a) { return a.name == wanted; });
    if (wanted != "all" || is_a_name || animations.empty()) return find_animation(file, wanted);
    Animation all = std::move(animations.front());
    for (std::size_t i = 1; i < animations.size(); ++i) {
        if (all.problem.empty()) all.problem = animations[i].problem;
        std::move(animations[i].channels.begin(), animations[i].channels.end(), std::back_inserter(all.channels));
    }
    all.name = wanted;
    animations.clear();
    animations.push_back(std::move(all));
    return 0;
}

/// The scene in its pose at rest, or in the pose of the options' time, with a player for other times.
SceneDescription set_first_pose(SceneFileContents file, const SceneOptions& options, LoadedScene& loaded)
{
    if (!options.at_s) {
        loaded.note = animations_note(file.rig.animations);
        return std::move(file.scene);
    }
    const std::size_t animation = chosen_animation(file, options.animation);
    SceneDescription scene = std::move(file.scene);
    loaded.player.emplace(scene, std::move(file.rig), animation);
    set_pose(scene, loaded.player->pose(*options.at_s, options.shutter_s));
    return scene;
}

/// Adds the camera that frames the whole scene, where the options ask for it or the file has none.
void add_framing_camera(LoadedScene& loaded, const SceneOptions& options)
{
    SceneDescription& scene = loaded.description;
    FramingOptions framing;
    framing.aspect = double(loaded.size.width) / loaded.size.height;
    framing.force_camera = options.orbit_deg || options.turntable;
    if (options.orbit_deg) {
        framing.azimuth_deg = options.orbit_deg->first;
        framing.elevation_deg = options.orbit_deg->second;
    }
    // One camera for all times, so that motion is visible.
    if (loaded.player && (framing.force_camera || scene.cameras.empty()))
        framing.bounds = world_bounds(scene, *loaded.player);
    if (options.turntable) {
        const Bounds bounds = framing.bounds ? *framing.bounds : world_bounds(scene);
        if (!bounds.empty) loaded.middle = (bounds.min + bounds.max) * 0.5;
        framing.orbit_center = loaded.middle;
    }
    const std::size_t cameras = scene.cameras.size();
    if (add_default_camera(scene, framing) && !framing.force_camera) loaded.added = {"a camera that frames the scene"};
    if (scene.cameras.size() == cameras) return;
    // add_default_camera puts its camera before the others.
    if (cameras > 0) scene.cameras.front().name = unused_name(scene, "orbit");
    loaded.camera = scene.cameras.front().name;
}

std::optional<Ground> make_ground(const SceneDescription& scene, const LoadedScene& loaded, const SceneOptions& options,
                                  const RenderSettings& settings)
{
    if (options.ground == GroundChoice::shadow && settings.alpha)
        throw UsageError(
            "--ground shadow, --background transparent: the floor takes its color from a backdrop; leave out one of "
            "them, or give the floor a color");
    if (options.ground == GroundChoice::none || (options.ground == GroundChoice::automatic && settings.alpha))
        return {};
    Ground ground;
    if (options.ground == GroundChoice::color) ground.color = options.ground_color;
    ground.only_if_visible_from_above = options.ground == GroundChoice::automatic;
    ground.backdrop = settings.background.value_or(studio_backdrop);
    if (loaded.player) ground.bounds = world_bounds(scene, *loaded.player);
    return ground;
}

}  // namespace

LoadedScene load_for_render(const SceneOptions& options, Reporter& reporter, Warnings& warnings)
{
    const Reporter::Phase phase(reporter, "load", "reading " + options.file.string());
    check_scene_options(options);
    return set_up_scene(load_scene_file(options.file, load_options(options), warnings), options);
}

LoadedScene set_up_scene(SceneFileContents file, const SceneOptions& options)
{
    check_scene_options(options);
    LoadedScene loaded;
    SceneDescription& scene = loaded.description = set_first_pose(std::move(file), options, loaded);
    if (!options.environment.empty()) use_environment(scene, options.environment);
    if (options.sky) use_sky(scene, options);
    adjust_environment(scene.environment, options);
    loaded.camera = name_of_camera(scene, options.camera);
    if (!loaded.camera.empty()) world_camera(scene, loaded.camera);  // throws if there is none
    loaded.build = resolve_bvh_quality(options, scene);
    loaded.size = resolve_size(options, loaded.camera, scene);
    add_framing_camera(loaded, options);
    if (options.look_from || options.look_at || options.up || options.fov_deg) {
        loaded.moved_from = loaded.camera;
        loaded.camera = add_moved_camera(scene, loaded.camera, options);
    }
    // --size decides the shape of the image: a camera's own aspect ratio would stretch it.
    if (options.size)
        for (Camera& camera : scene.cameras) camera.aspect = 0;
    if (options.shutter_s > 0)
        for (Camera& camera : scene.cameras) camera.shutter_open = 0, camera.shutter_close = options.shutter_s;
    return loaded;
}

void report_added(const LoadedScene& loaded, Reporter& reporter)
{
    if (!loaded.added.empty())
        reporter.note(fmt::format("added, since the file lacks it: {}", fmt::join(loaded.added, ", ")));
    if (!loaded.note.empty()) reporter.note(loaded.note);
}

EditableScene make_edit(LoadedScene& loaded, const SceneOptions& options)
{
    // An environment that the user chose is to be the only light.
    if (!options.environment.empty()) loaded.description.hints.own_light = true;
    return EditableScene(std::move(loaded.description), loaded.camera, loaded.build.value_or(BvhQuality::standard));
}

LitScene compile_with_light(EditableScene& edit, const LoadedScene& loaded, const SceneOptions& options,
                            const RenderSettings& settings, Warnings& warnings)
{
    if (options.light == LightingMode::studio && !options.environment.empty())
        throw UsageError("--light studio, --env: give one of them");
    return compile_lit(edit, options.light, double(loaded.size.width) / loaded.size.height, warnings,
                       make_ground(edit.description(), loaded, options, settings));
}

void apply_light(const LitScene& lit, const ImageOptions& options, RenderSettings& settings, DisplayTransform& display,
                 Reporter& reporter)
{
    if (!lit.added.empty()) reporter.note(fmt::format("light: added {}", fmt::join(lit.added, ", ")));
    if (lit.exposure_ev && !options.exposure_ev) display.exposure_ev = *lit.exposure_ev;
    if (lit.backdrop && !settings.background) settings.background = studio_backdrop;
}

void decide_on_caustics(const LitScene& lit, const CausticsChoice& choice, RenderSettings& settings, Warnings& warnings,
                        Reporter& reporter)
{
    const std::string& refracted = lit.refracted_light;
    const auto use = [&](double light_paths, const std::string& reason) {
        settings.light_paths = light_paths;
        if (!choice.wanted)
            reporter.note(fmt::format("caustics: on, because {} (disable them with --caustics off)", reason));
    };
    if (!choice.wanted && choice.trial) {
        const LightTracingTrial trial =
            try_light_tracing(RenderJob(lit.scene, settings), nullptr, *choice.trial).value_or(LightTracingTrial{});
        settings.light_paths = 0;
        if (trial.light_paths > 0)
            use(trial.light_paths, trial.missing_light > 1e-3 ? fmt::format("{:.2g} % of the light would be missing",
                                                                            100 * trial.missing_light)
                                                              : "a trial shows less noise for the time");
    }
    const bool is_decided = !choice.wanted && (choice.trial == TrialEffort::full || settings.light_paths > 0);
    if (!is_decided && !refracted.empty() && settings.light_sampling && choice.wanted.value_or(true))
        use(usual_light_paths, refracted);
    if (!refracted.empty() && settings.light_paths == 0)
        warnings.add(
            fmt::format("{}: {}, and the light that the glass refracts is missing (caustics); --caustics on "
                        "renders it",
                        choice.file, refracted));
    if (refracted.empty() || settings.light_paths == 0 || settings.merge_caustics) return;
    // The estimate is rough, so that less than this may be noise of light that paths find.
    constexpr double least_fraction = 0.03;
    if (const double hidden = light_of_photons(RenderJob(lit.scene, settings)); hidden >= least_fraction)
        warnings.add(
            fmt::format("{}: caustics that are seen through glass or in mirrors are missing, about {:.2g} % of "
                        "the light; --caustics merged renders them, a little blurred",
                        choice.file, 100 * hidden));
}

void set_time(EditableScene& edit, const LoadedScene& loaded, const SceneOptions& options, double time_s)
{
    if (!loaded.player) return;
    edit.set_pose(loaded.player->pose(time_s, options.shutter_s));
    if (!loaded.moved_from) return;
    const std::vector<Camera>& cameras = edit.description().cameras;
    Camera camera = moved_camera(edit.description(), *loaded.moved_from, options);
    camera.name = loaded.camera;
    edit.set_camera(int(cameras.size()) - 1, camera);
}

Camera turntable_camera(const Camera& camera, const LoadedScene& loaded, double fraction)
{
    const Transform turn = Transform::translate(loaded.middle) *
                           Transform::rotate({0, 1, 0}, 2 * std::numbers::pi * fraction) *
                           Transform::translate(-loaded.middle);
    Camera turned = camera;
    turned.position = turn.point(camera.position);
    turned.look_at = turn.point(camera.look_at);
    turned.up = turn.vector(camera.up);
    return turned;
}

}  // namespace fathom::cli
