// SPDX-License-Identifier: Apache-2.0
#include "options/scene_options.h"

#include <fmt/format.h>
#include <cmath>

#include "options/machine_options.h"

namespace fathom::cli {

namespace {

/// Azimuth and elevation in degrees by name: in glTF, the front of a model looks along +z.
const std::vector<std::string> view_names = {"front", "back", "left", "right", "top", "bottom", "three-quarter"};
constexpr std::pair<double, double> views[] = {{0, 0}, {180, 0}, {-90, 0}, {90, 0}, {0, 90}, {0, -90}, {30, 20}};

void add_animation_options(Command& command, SceneOptions& o)
{
    command.begin_group("Animation");
    command.add_value(
        {"--animation", "NAME|all", "animation to play, by name or number, or all of them at once", "the first"},
        [&](const std::string& text) { o.animation = text; });
    command.add_value(
        {"--at", "SECONDS", "show the animation's pose at this time, such as 1.5 or 1.5s; after its end, its last pose",
         "the pose at rest"},
        [&](const std::string& text) { o.at_s = parse_time(text); });
}

void add_camera_options(Command& command, SceneOptions& o)
{
    command.begin_group("Camera");
    command.add_value(
        {"--size", "WxH", "image size in pixels", "the scene's, otherwise 800x600 at the camera's aspect ratio"},
        [&](const std::string& text) { o.size = parse_size(text); });
    command.add_value({"--camera", "NAME", "camera of the scene, by name or number", "the first"},
                      [&](const std::string& text) { o.camera = text; });
    command.add_value({"--look-from", "X,Y,Z", "position of the camera, in meters", "the camera's"},
                      [&](const std::string& text) { o.look_from = parse_vector(text); });
    command.add_value({"--look-at", "X,Y,Z", "point that the camera looks at", "the camera's"},
                      [&](const std::string& text) { o.look_at = parse_vector(text); });
    command.add_value({"--up", "X,Y,Z", "direction that is up in the image", "the camera's"},
                      [&](const std::string& text) {
                          o.up = parse_vector(text);
                          if (!(length(*o.up) > 0)) throw UsageError("expected a direction, found 0,0,0");
                      });
    command.add_value({"--fov", "DEGREES", "full vertical field of view", "the camera's"},
                      [&](const std::string& text) { o.fov_deg = parse_number(text, 1e-3, 179.9); });
    command.add_value({"--orbit", "AZ,EL",
                       "frame the whole scene from this azimuth and elevation, in degrees; its silhouette fills the "
                       "image",
                       ""},
                      [&](const std::string& text) {
                          const std::vector<double> n = parse_numbers(text, 2);
                          if (std::abs(n[1]) > 90) throw UsageError("the elevation is from -90 to 90");
                          o.orbit_deg = {n[0], n[1]};
                      });
    command.add_value({"--view", "NAME",
                       "frame the whole scene from the front, back, left, right, top, bottom or three-quarter "
                       "(--orbit 30,20)",
                       "three-quarter for files without a camera"},
                      [&](const std::string& text) { o.orbit_deg = views[parse_choice(text, view_names)]; });
}

void add_light_options(Command& command, SceneOptions& o)
{
    command.begin_group("Light and background");
    command.add_value(
        {"--light", "auto|file|studio|sun|sky",
         "auto: the file's light, and studio lights if the model would be dark; file: only the file's light. "
         "The others replace the file's lamps and environment; studio: by studio lights, sun: by a "
         "clear sky with the sun, sky: by a clear sky without the sun",
         "auto"},
        [&](const std::string& text) {
            const int choice = parse_choice(text, {"auto", "file", "studio", "sun", "sky"});
            o.light = choice < 3 ? LightingMode(choice) : LightingMode::file;
            o.with_sun = choice == 3;
            o.sky = choice >= 3;
        });
    add_sun_options(command, o.sun);
    command.add_value({"--env", "FILE",
                       "light the scene with this equirectangular image (HDR, EXR, PFM, ...), whose center is towards "
                       "+x",
                       ""},
                      [&](const std::string& text) { o.environment = text; });
    command.add_value({"--env-rotate", "DEGREES",
                       "rotate the environment about the vertical axis, counterclockwise seen from above", "0"},
                      [&](const std::string& text) { o.environment_turn_deg = parse_number(text, -1e6, 1e6); });
    command.add_value({"--env-strength", "X", "multiply the light of the environment", "1"},
                      [&](const std::string& text) { o.environment_strength = parse_number(text, 0, 1e9); });
    command.add_value({"--ground", "shadow|none|COLOR",
                       "floor under the model; shadow: looks like the backdrop except for the model's shadow; none; or "
                       "a floor of this color",
                       "shadow for models lit by the studio alone and seen from above and outside"},
                      [&](const std::string& text) {
                          o.ground = text == "none"     ? GroundChoice::none
                                     : text == "shadow" ? GroundChoice::shadow
                                                        : GroundChoice::color;
                          if (o.ground == GroundChoice::color) o.ground_color = parse_color(text);
                      });
}

void check_light(const SceneOptions& o)
{
    if (o.sky && !o.environment.empty()) throw UsageError("--light sun, --light sky, --env: give one of them");
    if (o.sun.given() && !o.sky)
        throw UsageError(
            "--sun-direction, --sun-elevation, --sun-azimuth, --sun-place: add --light sun or --light sky");
    check_sun(o.sun);
}

}  // namespace

const std::vector<std::string> bvh_quality_names = {"fast", "standard", "high", "compact"};

void add_file_options(Command& command, SceneOptions& o)
{
    command.add_positional("SCENE", o.file,
                           "scene or model file: Fathom's JSON, glTF, GLB, Mitsuba XML, pbrt, OBJ, PLY, STL, ...; - "
                           "is the standard input");
    command.begin_group("Scene file");
    command.add_value(
        {"--format", "EXTENSION", "format of the file, as the extension of such files: glb, obj, stl, ...",
         "found by its content and name"},
        [&](const std::string& text) { o.format = parse_extension(text); });
    command.add_value(
        {"--scene", "NAME", "scene of a glTF file that has several, by name or number", "the file's choice"},
        [&](const std::string& text) { o.scene = text; });
    command.add_value(
        {"--variant", "NAME", "material variant of a glTF file that has several, by name or number", "none"},
        [&](const std::string& text) { o.variant = text; });
    command.add_value({"--up-axis", "y|z", "axis of the file that points up", "that of the file's format"},
                      [&](const std::string& text) { o.up_axis = "yz"[parse_choice(text, {"y", "z"})]; });
    command.add_values({"-D,--define", "NAME=VALUE", "value of a parameter of a Mitsuba scene; can be repeated", ""},
                       [&](const std::string& text) {
                           const std::size_t equals = text.find('=');
                           if (equals == 0 || equals == std::string::npos)
                               throw UsageError(fmt::format("expected NAME=VALUE, found '{}'", text));
                           o.definitions[text.substr(0, equals)] = text.substr(equals + 1);
                       });
    command.add_flag({"--confine", "",
                      "for untrusted files: read only files in the scene's folder and below, with links resolved", ""},
                     o.confine);
    add_machine_options(command);
}

LoadOptions load_options(const SceneOptions& options)
{
    LoadOptions load;
    load.scene = options.scene;
    load.variant = options.variant;
    load.format = options.format;
    load.up_axis = options.up_axis;
    load.confine = options.confine;
    load.definitions = options.definitions;
    return load;
}

void add_scene_options(Command& command, SceneOptions& o)
{
    add_file_options(command, o);
    add_animation_options(command, o);
    add_camera_options(command, o);
    add_light_options(command, o);
    command.begin_group("Scene file");
    command.add_value({"--config", "FILE",
                       "read further options from this file, one `name = value` a line, such as `spp = 1024`; those of "
                       "the command line override them",
                       ""},
                      [](const std::string&) {});
    command.begin_group("Machine");
    command.add_value({"--build", "fast|standard|high|compact",
                       "bounding volume hierarchy: fast builds sooner, high renders faster, compact takes a third less "
                       "memory, for tens of millions of triangles; the image is the same",
                       "standard, or high for many samples"},
                      [&](const std::string& text) { o.build = BvhQuality(parse_choice(text, bvh_quality_names)); });
}

void check_scene_options(const SceneOptions& o)
{
    if (o.orbit_deg && (!o.camera.empty() || o.look_from || o.look_at))
        throw UsageError("--orbit, --view: place the camera; leave out --camera, --look-from and --look-at");
    if (o.turntable && (!o.camera.empty() || o.look_from || o.look_at || o.up))
        throw UsageError(
            "--turntable: places the camera; leave out --camera, --look-from, --look-at and --up, and choose the first "
            "view with --orbit or --view");
    if (!o.animation.empty() && !o.at_s) throw UsageError("--animation: add --at SECONDS or --frames A:B");
    check_light(o);
}

}  // namespace fathom::cli
