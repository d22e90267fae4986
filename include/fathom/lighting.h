// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "fathom/editable_scene.h"
#include "fathom/render.h"

namespace fathom {

/// Statistics of a small test image that tell how well a scene is lit. Pixels that show the background are excluded,
/// and so is the emission of surfaces that the camera sees directly.
struct FATHOM_API LightingProbe {
    double covered = 0;  ///< Fraction of the pixels that show surfaces, 0 to 1.
    double lit = 0;      ///< Fraction of the covered pixels with a luminance above 2 % of `bright`, 0 to 1.
    double middle = 0;   ///< Median luminance of the lit pixels.
    double bright = 0;   ///< 95th percentile of the luminance of all pixels that show surfaces.

    /// Returns the exposure, in stops, that brings the median to 0.22 and the 95th percentile to at most 1; 0 if
    /// nothing is lit.
    double exposure_ev() const;
};

/// Renders a test image of 64 pixels across with 16 samples per pixel and at most 4 scattering events, which takes a
/// few hundredths of a second.
///
/// scene   The scene, which is seen by the camera that it was compiled for.
/// aspect  Width / height of the final image.
FATHOM_API LightingProbe probe_lighting(const Scene& scene, double aspect);

/// Which light a scene is rendered in.
enum class LightingMode {
    automatic,  ///< The file's light, plus a studio if it leaves most of the image dark.
    file,       ///< Only the file's light, even if there is none.
    studio,     ///< A studio instead of the environment and the lights without a surface. Emissive surfaces remain.
};

/// Recommended color of the background behind models in studio light, linear Rec.709.
inline constexpr Color studio_backdrop{0.55f, 0.55f, 0.55f};

/// A horizontal disk below the lowest point of a scene, which shows shadows and fades out towards its edge.
struct Ground {
    /// Reflectance, linear Rec.709. Empty: in studio light the ground has the brightness of `backdrop` where no shadow
    /// falls; in other light it is gray (0.5).
    std::optional<Color> color;
    Color backdrop = studio_backdrop;  ///< Color of the background that the ground blends into, linear Rec.709.
    /// Adds the ground only if the studio is the model's only light, and the camera is outside the model and above the
    /// ground.
    bool only_if_visible_from_above = true;
    /// World-space box of what all images of a sequence show; empty: of the scene as it is.
    std::optional<Bounds> bounds;
};

/// A compiled scene and what was added to light it.
struct LitScene {
    Scene scene;  ///< The compiled scene.
    /// Descriptions of what was added, for messages: "a studio light", "an exposure of +2 stops for its light ...".
    std::vector<std::string> added;
    /// Exposure in stops for the file's light, in steps of 0.5; empty if the scene should be shown with its own
    /// exposure.
    std::optional<double> exposure_ev;
    bool studio = false;    ///< A studio was added.
    bool ground = false;    ///< A ground was added.
    bool backdrop = false;  ///< A light background such as studio_backdrop is recommended.
    /// Says, for people, how much light of point-like lights falls on smooth glass, which refracts it where path
    /// tracing alone cannot find it: "7 % of the light of lights without size falls on glass".
    /// RenderSettings::light_paths renders that light. Empty if it is less than 1 %.
    std::string refracted_light;
    /// Whether anything is made of smooth glass, which throws caustics if a small light shines on it.
    bool has_smooth_glass = false;
};

/// Compiles a scene so that it is visible. It is meant for models, whose files often contain no light, or light that
/// doesn't reach what the camera sees.
///
/// scene     What to compile; it must have a camera (see add_default_camera()).
/// camera    As in Scene::compile().
/// light     Which light to use. With `automatic`, probe_lighting() decides: a studio is added if less than 40 % of the
///           surfaces in view are lit, unless RenderHints::own_light is set.
/// aspect    Width / height of the final image.
/// warnings  As in Scene::compile().
/// build     As in Scene::compile().
/// ground    Ground to add; empty: none.
///
/// Throws Error as Scene::compile().
FATHOM_API LitScene compile_lit(SceneDescription scene, const std::string& camera, LightingMode light, double aspect,
                                Warnings& warnings, BvhQuality build = BvhQuality::standard,
                                const std::optional<Ground>& ground = {});

/// Compiles a scene that will change as compile_lit() above does, and adds light and ground to the description of
/// `edit`, so that later scenes keep them.
FATHOM_API LitScene compile_lit(EditableScene& edit, LightingMode light, double aspect, Warnings& warnings,
                                const std::optional<Ground>& ground = {});

}  // namespace fathom
