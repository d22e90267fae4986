// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "fathom/lighting.h"
#include "fathom/load.h"
#include "fathom/render.h"
#include "options/arguments.h"
#include "options/command.h"
#include "options/sun_options.h"

namespace fathom::cli {

enum class GroundChoice { automatic, none, shadow, color };

/// Options for the scene file, its lighting and the camera.
struct SceneOptions {
    std::filesystem::path file;
    std::string format;                              ///< extension that the file is read as; empty: its own
    std::string scene;                               ///< scene of a file with several; empty: the file's default
    std::string variant;                             ///< material variant
    std::map<std::string, std::string> definitions;  ///< parameters by name
    char up_axis = 0;
    bool confine = false;
    std::string animation;       ///< name, number or "all"; empty: the first
    std::optional<double> at_s;  ///< time of the pose; none: the pose at rest
    double shutter_s = 0;        ///< how long the shutter is open from then on
    std::string camera;          ///< name or number; empty: the first
    std::optional<Vec3d> look_from, look_at, up;
    std::optional<double> fov_deg;
    std::optional<std::pair<double, double>> orbit_deg;  ///< azimuth, elevation
    bool turntable = false;                              ///< frames the whole scene for a camera that goes around it
    std::filesystem::path environment;
    double environment_turn_deg = 0;
    std::optional<double> environment_strength;
    LightingMode light = LightingMode::automatic;
    bool sky = false, with_sun = false;  ///< a clear sky replaces all other light, with or without the sun's disk
    SunOptions sun;
    GroundChoice ground = GroundChoice::automatic;
    Color ground_color;
    std::optional<Size> size;
    std::optional<BvhQuality> build;
};

/// Adds the file and how it is read, --memory and --nice.
void add_file_options(Command& command, SceneOptions& options);
/// Adds the options of add_file_options() and those for animation, camera and light.
void add_scene_options(Command& command, SceneOptions& options);
LoadOptions load_options(const SceneOptions& options);
/// Throws UsageError for options that contradict each other.
void check_scene_options(const SceneOptions& options);

extern const std::vector<std::string> bvh_quality_names;  ///< indexed by BvhQuality

}  // namespace fathom::cli
