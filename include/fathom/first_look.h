#pragma once
#include <optional>
#include <string>
#include <vector>

#include "fathom/edit.h"
#include "fathom/render.h"

namespace fathom {

/// What a small picture shows of how a scene is lit: of surfaces, lamps in view and the background left out.
struct FATHOM_API FirstLook {
    double covered = 0;  ///< share of the picture that shows surfaces
    double lit = 0;      ///< share of these that are not nearly black beside the brightest
    double middle = 0;   ///< luminance of those that are lit: the median
    double bright = 0;   ///< and what one in twenty is above

    /// Stops that bring what is lit to a middling brightness, and leave little above white.
    double exposure_ev() const;
};

/// Renders 64 pixels across at a few samples: a few hundredths of a second.
/// aspect: width / height of the picture that is to come.
FATHOM_API FirstLook first_look(const Scene& scene, double aspect);

/// Which light a scene is rendered in.
enum class LightChoice {
    automatic,  ///< the file's, and where that leaves what is seen in the dark a studio's beside it
    file,       ///< only what the file says, also if it is nothing
    studio,     ///< a studio instead of the file's environment and lamps without a surface
};

/// What models that a studio lights are best seen before.
inline constexpr Color studio_backdrop{0.55f, 0.55f, 0.55f};

/// A floor under the lowest point of a scene, a disk that fades out with the distance: it catches shadows.
struct Ground {
    /// Its reflectance; none: under a studio's light it looks as the backdrop where no shadow falls, else it is grey.
    std::optional<Color> color;
    Color backdrop = studio_backdrop;
    /// Only where a model has no light but a studio's, and the camera sees it from outside and the ground from above.
    bool only_where_it_fits = true;
    std::optional<Bounds> bounds;  ///< of what is shown in all pictures; else the scene as it is
};

struct AutoLitScene {
    Scene scene;
    std::vector<std::string> added;  ///< in words: "a studio light, since ...", "an exposure of +2 stops for its light"
    std::optional<double> exposure_ev;  ///< found for the light of the file; else its own, or none
    bool studio = false;
    bool ground = false;
    bool backdrop = false;  ///< it is best seen before something light
};

/// Compiles a scene so that there is light to see it by: for models, whose files often have none, or none that reaches
/// what they show.
FATHOM_API AutoLitScene compile_lit(SceneDescription scene, const std::string& camera, LightChoice light, double aspect,
                                    Warnings& warnings, TreeBuild build = TreeBuild::standard,
                                    const std::optional<Ground>& ground = {});

/// The same for a scene that goes on to change: it keeps the light that is found now.
FATHOM_API AutoLitScene compile_lit(SceneEdit& edit, LightChoice light, double aspect, Warnings& warnings,
                                    const std::optional<Ground>& ground = {});

}  // namespace fathom
