// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "fathom/editable_scene.h"
#include "fathom/image.h"
#include "fathom/lighting.h"
#include "fathom/render.h"
#include "fathom/scene_file.h"
#include "options/image_options.h"
#include "options/scene_options.h"
#include "report/reporter.h"

namespace fathom::cli {

/// A scene that can be compiled: it has a camera, and the options are applied.
struct LoadedScene {
    SceneDescription description;
    std::string camera;  ///< name of the camera to render; empty: the first
    Size size;           ///< of the image: the option's, the scene's, or 800x600 at the camera's aspect ratio
    std::vector<std::string> added;         ///< descriptions of what the file lacked
    std::optional<BvhQuality> build;        ///< BVH quality from the option or the scene
    std::optional<AnimationPlayer> player;  ///< player of the animation, if the options give a time
    std::string note;                       ///< note on other content of the file, such as animations; may be empty
    Vec3d middle;                           ///< center of a turntable
    std::optional<std::string> moved_from;  ///< the camera from which the options made `camera`
};

/// Loads the file and applies the options; reports progress, what was added and what else could be shown. Throws Error
/// and UsageError.
LoadedScene load_for_render(const SceneOptions& options, Reporter& reporter, Warnings& warnings);
/// Applies the options to a scene that was read already: all of them except those of load_options(). Throws Error and
/// UsageError.
LoadedScene set_up_scene(SceneFileContents file, const SceneOptions& options);
void report_added(const LoadedScene& loaded, Reporter& reporter);

/// The scene to compile and to change for further images. Takes the description out of `loaded`.
EditableScene make_edit(LoadedScene& loaded, const SceneOptions& options);
/// Compiles the scene with its light and ground.
///
/// settings  say which backdrop the ground fades into
LitScene compile_with_light(EditableScene& edit, const LoadedScene& loaded, const SceneOptions& options,
                            const RenderSettings& settings, Warnings& warnings);
/// Reports which light was added, and applies its exposure and backdrop unless options say otherwise.
void apply_light(const LitScene& lit, const ImageOptions& options, RenderSettings& settings, DisplayTransform& display,
                 Reporter& reporter);

/// Who decides on light tracing.
struct CausticsChoice {
    std::string file;                    ///< name of the scene, for warnings
    std::optional<bool> wanted;          ///< the user's choice
    std::optional<TrialEffort> trial{};  ///< the trial that the render is long enough for
};
/// Sets RenderSettings::light_paths if the user left the choice to the program: by a trial, or else, and after a quick
/// trial, if glass refracts light that path tracing alone cannot find. Warns if that light will be missing, or the part
/// of it that only photons show.
void decide_on_caustics(const LitScene& lit, const CausticsChoice& choice, RenderSettings& settings, Warnings& warnings,
                        Reporter& reporter);

/// Moves animation and camera to another time.
void set_time(EditableScene& edit, const LoadedScene& loaded, const SceneOptions& options, double time_s);
/// The camera after a fraction of a turntable's turn, counterclockwise seen from above.
Camera turntable_camera(const Camera& camera, const LoadedScene& loaded, double fraction);

}  // namespace fathom::cli
