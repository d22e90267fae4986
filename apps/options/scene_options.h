#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "fathom/first_look.h"
#include "fathom/load.h"
#include "fathom/render.h"
#include "fathom/scene_file.h"
#include "options/arguments.h"
#include "options/sun_options.h"

namespace fathom::cli {

enum class GroundChoice { automatic, none, shadow, color };

/// What scene is meant, and from where it is seen.
struct SceneOptions {
    std::filesystem::path file;
    std::string scene;           ///< of a file with several; empty: the one that the file says
    std::string variant;         ///< of materials
    std::string animation;       ///< name or number; empty: the first
    std::optional<double> at_s;  ///< the time of its pose; none: the pose at rest
    double shutter_s = 0;        ///< for how long what moves is seen from then on
    char up_axis = 0;
    bool confine = false;
    std::string camera;
    std::optional<Vec3d> look_from, look_at, up;
    std::optional<double> fov_deg;
    std::optional<std::pair<double, double>> orbit_deg;  ///< azimuth, elevation
    bool turntable = false;                              ///< frame the whole scene for a camera that goes around it
    std::filesystem::path environment;
    double environment_turn_deg = 0;
    std::optional<double> environment_strength;
    LightChoice light = LightChoice::automatic;
    bool sky = false, with_sun = false;  ///< instead of all other light; the sun with its sky
    SunOptions sun;
    GroundChoice ground = GroundChoice::automatic;
    Color ground_color;
    std::optional<Size> size;
    std::optional<TreeBuild> build;
    std::map<std::string, std::string> definitions;  ///< of parameters, by name
};

/// Which file, and how it is read.
void add_file_options(Command& command, SceneOptions& options);
LoadOptions load_options(const SceneOptions& options);
/// These, and from where it is seen.
void add_scene_options(Command& command, SceneOptions& options);

/// A scene that can be compiled: with a camera and light, and the options applied.
struct LoadedScene {
    SceneDescription description;
    std::string camera;              ///< the name to compile with; empty: the first
    Size size;                       ///< of the picture: the option's, the scene's, or 800x600 in the camera's shape
    std::vector<std::string> added;  ///< what the file lacked
    std::optional<TreeBuild> build;  ///< the option's or the scene's
    std::optional<AnimationPlayer> player;  ///< if there is a time
    std::string note;                       ///< what else the file could show; may be empty
    Vec3d middle;                           ///< of what a turntable turns
    std::optional<std::string> moved_from;  ///< the camera that the options made another one of, `camera`
};
LoadedScene load_for_render(const SceneOptions& options, Warnings& warnings);

/// The scene to compile, and to change for further pictures. The description is used up.
SceneEdit take_edit(LoadedScene& loaded, const SceneOptions& options);
/// Compiles it, with light.
///
/// settings  what is behind the scene: the ground goes over into it
AutoLitScene compile_loaded(SceneEdit& edit, const LoadedScene& loaded, const SceneOptions& options,
                            const RenderSettings& settings, Warnings& warnings);
/// Brings it to another time.
void set_time(SceneEdit& edit, const LoadedScene& loaded, const SceneOptions& options, double time_s);
/// The camera after this share of a turn of a turntable: counter-clockwise, seen from above.
Camera turned_camera(const Camera& camera, const LoadedScene& loaded, double share);

extern const std::vector<std::string> tree_build_names;  ///< by TreeBuild

}  // namespace fathom::cli
