#include "options/scene_options.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "commands/commands.h"
#include "fathom/error.h"
#include "options/machine_options.h"

namespace fathom::cli {

namespace {

constexpr Size default_size{800, 600};

/// Azimuth and elevation, degrees, by name: the front of a model looks along +z, as glTF says.
const std::vector<std::string> view_names = {"front", "back", "left", "right", "top", "bottom", "three-quarter"};
constexpr std::pair<double, double> views[] = {{0, 0}, {180, 0}, {-90, 0}, {90, 0}, {0, 90}, {0, -90}, {30, 20}};

const Camera* chosen_camera(const SceneDescription& scene, const std::string& name)
{
    for (const Camera& camera : scene.cameras)
        if (name.empty() || camera.name == name) return &camera;
    return nullptr;
}

/// A side that keeps the shape, at least one pixel.
int side(double pixels)
{
    return std::max(1, int(std::lround(std::min(pixels, double(1 << 24)))));
}

Size picture_size(const SceneOptions& options, const std::string& camera_name, const SceneDescription& scene)
{
    if (options.size) return *options.size;
    const RenderHints& hints = scene.hints;
    Size size{hints.width.value_or(default_size.width), hints.height.value_or(default_size.height)};
    if (size.width < 1 || size.height < 1)
        throw Error(scene.file, "", fmt::format("a picture of {}x{} pixels", size.width, size.height));
    const Camera* camera = options.orbit_deg || options.turntable ? nullptr : chosen_camera(scene, camera_name);
    double aspect = camera && camera->aspect > 0 ? camera->aspect : 0;
    if (hints.width && hints.height) return size;
    if (hints.width || hints.height) {
        if (aspect == 0) aspect = double(default_size.width) / default_size.height;
        if (hints.width) size.height = side(size.width / aspect);
        if (hints.height) size.width = side(size.height * aspect);
    } else if (aspect > 0) {
        // Inside the default size, in the camera's shape.
        if (aspect > double(size.width) / size.height)
            size.height = side(size.width / aspect);
        else
            size.width = side(size.height * aspect);
    }
    return size;
}

std::optional<TreeBuild> tree_build_of(const SceneOptions& options, const SceneDescription& scene)
{
    if (options.build || !scene.hints.build) return options.build;
    const auto name = std::find(tree_build_names.begin(), tree_build_names.end(), *scene.hints.build);
    if (name == tree_build_names.end())
        throw Error(scene.file, "build",
                    fmt::format("expected {}, found '{}'", fmt::join(tree_build_names, " or "), *scene.hints.build));
    return TreeBuild(name - tree_build_names.begin());
}

void use_environment(SceneDescription& scene, const std::filesystem::path& file)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) throw Error(file.string(), "--env", "there is no such picture");
    scene.environment = {};
    scene.environment.kind = EnvironmentKind::image;
    scene.environment.image = int(scene.images.size());
    ImageFile image;
    image.name = file.filename().string();
    image.path = file;
    scene.images.push_back(image);
}

/// A clear sky instead of the file's lamps and environment.
void use_sky(SceneDescription& scene, const SceneOptions& options)
{
    scene.environment = {};
    scene.environment.kind = EnvironmentKind::sky;
    scene.environment.sun_disk = options.with_sun;
    scene.environment.to_sun = direction_to_sun(options.sun);
    for (Node& node : scene.nodes) node.light = -1;
    // It is exposed for, as other light that is not made to be seen by as it is.
    scene.hints.exposure.reset();
}

/// What the options say together of the light.
void check_light(const SceneOptions& options)
{
    if (options.sky && !options.environment.empty())
        throw UsageError("--light sun, --light sky, --env: one of them lights the scene");
    if (options.sun.given() && !options.sky)
        throw UsageError(
            "--sun-direction, --sun-elevation, --sun-azimuth, --sun-place: add --light sun or --light sky");
    check_sun(options.sun);
}

/// Whichever picture or gradient lights the scene from outside, that of the options or its own.
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

/// The name to compile with of the camera that a name or number means: a number may be that of one without a name of
/// its own, which gets one.
std::string name_of_camera(SceneDescription& scene, const std::string& wanted)
{
    const bool is_number = !wanted.empty() && wanted.find_first_not_of("0123456789") == std::string::npos;
    if (!is_number || chosen_camera(scene, wanted)) return wanted;
    const std::uint64_t most = std::max<std::size_t>(scene.cameras.size(), 1) - 1;
    if (scene.cameras.empty() || wanted.size() > 9 || std::stoull(wanted) > most) return wanted;
    Camera& camera = scene.cameras[std::stoul(wanted)];
    const std::string name = std::exchange(camera.name, {});
    camera.name = unused_name(scene, name.empty() ? "camera " + wanted : name);
    return camera.name;
}

/// Made of the chosen one, where that now is, and the options.
Camera moved_camera(const SceneDescription& scene, const std::string& name, const SceneOptions& options)
{
    Camera camera = world_camera(scene, name);
    if (options.look_from) camera.position = *options.look_from;
    if (options.look_at) camera.look_at = *options.look_at;
    // What was in focus at the old distance need not be at the new one.
    if (options.look_from || options.look_at) camera.focus_distance = 0;
    if (options.up) camera.up = *options.up;
    if (options.fov_deg) {
        camera.kind = CameraKind::perspective;
        camera.fov_y = *options.fov_deg * std::numbers::pi / 180;
        camera.fov_aspect = 0;
    }
    const Vec3d forward = camera.look_at - camera.position;
    if (!(length(forward) > 0)) throw UsageError("--look-from, --look-at: the camera looks at where it stands");
    if (!(length(cross(normalize(forward), normalize(camera.up))) > 1e-9)) {
        if (options.up) throw UsageError("--up: the camera looks along this direction");
        // Straight up or down: any direction across will do.
        camera.up = std::abs(normalize(forward).z) < 0.9 ? Vec3d{0, 0, -1} : Vec3d{0, 1, 0};
    }
    return camera;
}

/// Adds such a camera at the root of the scene.
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

}  // namespace

const std::vector<std::string> tree_build_names = {"fast", "standard", "high", "compact"};

void add_file_options(Command& command, SceneOptions& options)
{
    command.add_positional("SCENE", options.file,
                           "Fathom's own JSON, glTF, GLB, Mitsuba's XML, pbrt, OBJ, PLY, STL, ...");
    command.add_value("--scene", "NAME", "name or number of the scene in a glTF file that has several",
                      [&](const std::string& text) { options.scene = text; });
    command.add_value("--variant", "NAME", "name or number of the variant of materials in a glTF file that has several",
                      [&](const std::string& text) { options.variant = text; });
    command.add_value("--up-axis", "y|z", "the axis of the file that points up (default: as its format says)",
                      [&](const std::string& text) { options.up_axis = "yz"[parse_word(text, {"y", "z"})]; });
    command.add_values("-D,--define", "NAME=VALUE",
                       "the value of a parameter that a Mitsuba scene has; may be given several times",
                       [&](const std::string& text) {
                           const std::size_t equals = text.find('=');
                           if (equals == 0 || equals == std::string::npos)
                               throw UsageError(fmt::format("expected NAME=VALUE, found '{}'", text));
                           options.definitions[text.substr(0, equals)] = text.substr(equals + 1);
                       });
    command.add_flag("--confine", options.confine,
                     "read only files in the scene's folder and below, links followed: for scenes by strangers");
    add_machine_options(command);
}

LoadOptions load_options(const SceneOptions& options)
{
    LoadOptions load;
    load.scene = options.scene;
    load.variant = options.variant;
    load.up_axis = options.up_axis;
    load.confine = options.confine;
    load.definitions = options.definitions;
    return load;
}

void add_scene_options(Command& command, SceneOptions& options)
{
    add_file_options(command, options);
    command.add_value("--animation", "NAME|all",
                      "name or number of one of the file's animations, or all of them at once (default: the first)",
                      [&](const std::string& text) { options.animation = text; });
    command.add_value("--at", "SECONDS",
                      "show the animation's pose at this time, as 1.5 or 1.5s; after its end the last one",
                      [&](const std::string& text) { options.at_s = parse_time(text); });
    command.add_value("--size", "WxH", "size of the picture (default: the scene's, else 800x600)",
                      [&](const std::string& text) { options.size = parse_size(text); });
    command.add_value("--camera", "NAME", "name or number of one of the scene's cameras (default: the first)",
                      [&](const std::string& text) { options.camera = text; });
    command.add_value("--look-from", "X,Y,Z", "where the camera stands, metres",
                      [&](const std::string& text) { options.look_from = parse_vector(text); });
    command.add_value("--look-at", "X,Y,Z", "what it looks at",
                      [&](const std::string& text) { options.look_at = parse_vector(text); });
    command.add_value("--up", "X,Y,Z", "what is up in the picture", [&](const std::string& text) {
        options.up = parse_vector(text);
        if (!(length(*options.up) > 0)) throw UsageError("expected a direction, found 0,0,0");
    });
    command.add_value("--fov", "DEGREES", "full vertical angle of view",
                      [&](const std::string& text) { options.fov_deg = parse_number(text, 1e-3, 179.9); });
    command.add_value("--orbit", "AZ,EL", "frame the whole scene from this azimuth and elevation, degrees",
                      [&](const std::string& text) {
                          const std::vector<double> n = parse_numbers(text, 2);
                          if (std::abs(n[1]) > 90) throw UsageError("the elevation is from -90 to 90");
                          options.orbit_deg = {n[0], n[1]};
                      });
    command.add_value(
        "--view", "NAME",
        "frame the whole scene: front, back, left, right, top, bottom or three-quarter (--orbit 30,20, and "
        "the default for files without a camera)",
        [&](const std::string& text) { options.orbit_deg = views[parse_word(text, view_names)]; });
    command.add_value("--env", "FILE",
                      "light the scene by this equirectangular picture (HDR, EXR, PFM, ...); its middle looks along +x",
                      [&](const std::string& text) { options.environment = text; });
    command.add_value("--env-rotate", "DEGREES",
                      "turn the environment about the vertical axis, counter-clockwise seen from above",
                      [&](const std::string& text) { options.environment_turn_deg = parse_number(text, -1e6, 1e6); });
    command.add_value("--env-strength", "X", "multiply the light of the environment",
                      [&](const std::string& text) { options.environment_strength = parse_number(text, 0, 1e9); });
    command.add_value(
        "--light", "auto|file|studio|sun|sky",
        "auto (default): the file's, and a studio's where that leaves what is seen in the dark; only the file's; a "
        "studio; a clear sky with its sun, or without",
        [&](const std::string& text) {
            const int word = parse_word(text, {"auto", "file", "studio", "sun", "sky"});
            options.light = word < 3 ? LightChoice(word) : LightChoice::file;
            options.with_sun = word == 3;
            options.sky = word >= 3;
        });
    add_sun_options(command, options.sun);
    command.add_value("--ground", "shadow|none|COLOUR",
                      "a floor under the model: one that looks as the backdrop but for the model's shadow (default for "
                      "models that only a studio lights, seen from above and outside), none, or one of this colour",
                      [&](const std::string& text) {
                          options.ground = text == "none"     ? GroundChoice::none
                                           : text == "shadow" ? GroundChoice::shadow
                                                              : GroundChoice::color;
                          if (options.ground == GroundChoice::color) options.ground_color = parse_color(text);
                      });
    command.add_value(
        "--build", "fast|standard|high|compact",
        "the tree of the scene: the same picture, sooner begun, sooner done, or in a third less memory, "
        "for tens of millions of triangles (default: standard, or high where the samples are many enough)",
        [&](const std::string& text) { options.build = TreeBuild(parse_word(text, tree_build_names)); });
}

namespace {

/// "the file has 2 animations (walk, run): ..."
std::string note_on(const std::vector<Animation>& animations)
{
    if (animations.empty()) return {};
    constexpr std::size_t most = 8;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min(most, animations.size()); ++i) names.push_back(animations[i].name);
    if (animations.size() > most) names.push_back("...");
    return fmt::format(
        "the pose at rest is shown; of the file's {} {} ({}) --at SECONDS shows another, --frames A:B a film",
        animations.size(), animations.size() == 1 ? "animation" : "animations", fmt::join(names, ", "));
}

/// The animation to play; of the word `all`, where none has it for a name, one of what all of them move. Where several
/// move the same, the last of them does.
std::size_t chosen_animation(SceneFile& file, const std::string& wanted)
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

}  // namespace

LoadedScene load_for_render(const SceneOptions& options, Warnings& warnings)
{
    if (options.orbit_deg && (!options.camera.empty() || options.look_from || options.look_at))
        throw UsageError("--orbit, --view: places the camera by itself; leave out --camera, --look-from and --look-at");
    if (options.turntable && (!options.camera.empty() || options.look_from || options.look_at || options.up))
        throw UsageError(
            "--turntable: places the camera by itself; leave out --camera, --look-from, --look-at and --up, and say "
            "where it begins by --orbit or --view");
    if (!options.animation.empty() && !options.at_s)
        throw UsageError("--animation: of which time? add --at SECONDS, or --frames A:B");
    check_light(options);
    LoadedScene loaded;
    SceneFile file = load_scene_file(options.file, load_options(options), warnings);
    const std::size_t animation = options.at_s ? chosen_animation(file, options.animation) : 0;
    SceneDescription& scene = loaded.description = std::move(file.scene);
    if (options.at_s) {
        loaded.player.emplace(scene, std::move(file.rig), animation);
        set_pose(scene, loaded.player->pose(*options.at_s, options.shutter_s));
    } else {
        loaded.note = note_on(file.rig.animations);
    }
    if (!options.environment.empty()) use_environment(scene, options.environment);
    if (options.sky) use_sky(scene, options);
    adjust_environment(scene.environment, options);
    loaded.camera = name_of_camera(scene, options.camera);
    if (!loaded.camera.empty()) world_camera(scene, loaded.camera);  // throws if there is none
    loaded.build = tree_build_of(options, scene);
    loaded.size = picture_size(options, loaded.camera, scene);

    CompleteOptions complete;
    complete.aspect = double(loaded.size.width) / loaded.size.height;
    complete.force_camera = options.orbit_deg || options.turntable;
    if (options.orbit_deg) {
        complete.azimuth_deg = options.orbit_deg->first;
        complete.elevation_deg = options.orbit_deg->second;
    }
    // The same for all times, so that what moves is seen to move.
    if (loaded.player && (complete.force_camera || scene.cameras.empty()))
        complete.bounds = world_bounds(scene, *loaded.player);
    if (options.turntable) {
        const Bounds bounds = complete.bounds ? *complete.bounds : world_bounds(scene);
        if (!bounds.empty) loaded.middle = (bounds.min + bounds.max) * 0.5;
        complete.turned_about = loaded.middle;
    }
    const std::size_t cameras = scene.cameras.size();
    loaded.added = complete_scene(scene, complete).added;
    if (scene.cameras.size() > cameras) {
        // It is put before the others.
        if (cameras > 0) scene.cameras.front().name = unused_name(scene, "orbit");
        loaded.camera = scene.cameras.front().name;
    }
    if (options.look_from || options.look_at || options.up || options.fov_deg) {
        loaded.moved_from = loaded.camera;
        loaded.camera = add_moved_camera(scene, loaded.camera, options);
    }
    // The picture asked for decides its shape: a camera's own would stretch it.
    if (options.size)
        for (Camera& camera : scene.cameras) camera.aspect = 0;
    if (options.shutter_s > 0)
        for (Camera& camera : scene.cameras) camera.shutter_open = 0, camera.shutter_close = options.shutter_s;
    return loaded;
}

SceneEdit take_edit(LoadedScene& loaded, const SceneOptions& options)
{
    // Whoever gives a sky wants to see it by that.
    if (!options.environment.empty()) loaded.description.hints.own_light = true;
    return SceneEdit(std::move(loaded.description), loaded.camera, loaded.build.value_or(TreeBuild::standard));
}

namespace {

std::optional<Ground> ground_for(const SceneDescription& scene, const LoadedScene& loaded, const SceneOptions& options,
                                 const RenderSettings& settings)
{
    if (options.ground == GroundChoice::shadow && settings.alpha)
        throw UsageError(
            "--ground shadow, --background transparent: a floor looks as a backdrop that is there; leave out one of "
            "both, or give the floor a colour");
    if (options.ground == GroundChoice::none || (options.ground == GroundChoice::automatic && settings.alpha))
        return {};
    Ground ground;
    if (options.ground == GroundChoice::color) ground.color = options.ground_color;
    ground.only_where_it_fits = options.ground == GroundChoice::automatic;
    ground.backdrop = settings.background.value_or(studio_backdrop);
    if (loaded.player) ground.bounds = world_bounds(scene, *loaded.player);
    return ground;
}

}  // namespace

AutoLitScene compile_loaded(SceneEdit& edit, const LoadedScene& loaded, const SceneOptions& options,
                            const RenderSettings& settings, Warnings& warnings)
{
    if (options.light == LightChoice::studio && !options.environment.empty())
        throw UsageError("--light studio, --env: one of both lights the scene");
    return compile_lit(edit, options.light, double(loaded.size.width) / loaded.size.height, warnings,
                       ground_for(edit.description(), loaded, options, settings));
}

void set_time(SceneEdit& edit, const LoadedScene& loaded, const SceneOptions& options, double time_s)
{
    if (!loaded.player) return;
    edit.set_pose(loaded.player->pose(time_s, options.shutter_s));
    if (!loaded.moved_from) return;
    const std::vector<Camera>& cameras = edit.description().cameras;
    Camera camera = moved_camera(edit.description(), *loaded.moved_from, options);
    camera.name = loaded.camera;
    edit.set_camera(int(cameras.size()) - 1, camera);
}

Camera turned_camera(const Camera& camera, const LoadedScene& loaded, double share)
{
    const Transform turn = Transform::translate(loaded.middle) *
                           Transform::rotate({0, 1, 0}, 2 * std::numbers::pi * share) *
                           Transform::translate(-loaded.middle);
    Camera turned = camera;
    turned.position = turn.point(camera.position);
    turned.look_at = turn.point(camera.look_at);
    turned.up = turn.vector(camera.up);
    return turned;
}

}  // namespace fathom::cli
