#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/description.h"

namespace fathom {

/// Things that are wrong but leave a picture, each cause once, with a count.
class Warnings {
public:
    /// `message` is one line that names file and place. The same message again only counts.
    void add(const std::string& message, std::size_t times = 1)
    {
        if (times > 0) counts_[message] += times;
    }
    const std::map<std::string, std::size_t>& counts() const { return counts_; }
    bool empty() const { return counts_.empty(); }

private:
    std::map<std::string, std::size_t> counts_;
};

struct LoadOptions {
    std::string scene;    ///< glTF: name or number of the scene to load; empty: the one that the file says
    std::string variant;  ///< glTF: name or number of the variant of materials; empty: as the file has it
    char up_axis =
        0;  ///< 'y' or 'z': which axis of the file points up; 0: as the format says. z-up files are turned to y-up
    /// Only files of the scene's folder and below are read, links followed: for scenes by strangers. Else a scene reads
    /// whatever it names.
    bool confine = false;
    /// Mitsuba: values of the scene's parameters (`$name` in it), by name; they go before its own defaults.
    std::map<std::string, std::string> definitions;
};

/// Reads a scene or model file; the format is told by the content or the extension: Fathom's own JSON, glTF, GLB,
/// scenes of Mitsuba 3, OBJ, PLY, STL, and what Assimp reads. Relative paths in it are relative to the file.
///
/// Throws Error for a file that can't be read or understood; adds to `warnings` what leaves a picture.
FATHOM_API SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions& options,
                                       Warnings& warnings);

/// Box around all geometry in world space, instances included.
struct Bounds {
    Vec3d min, max;
    bool empty = true;
};
FATHOM_API Bounds world_bounds(const SceneDescription& scene);

/// What complete_scene added because it was lacking, in words; empty if nothing.
struct CompletedScene {
    std::vector<std::string> added;
};

/// Gives a scene that lacks one a camera that frames it (orbit: azimuth and elevation in degrees, seen from the front).
/// Light to see it by: compile_lit.
struct CompleteOptions {
    double azimuth_deg = 30, elevation_deg = 20;
    bool force_camera = false;  ///< frame the scene even if it has a camera (--orbit)
    double aspect = 4.0 / 3;
    std::optional<Bounds> bounds;  ///< what is framed; else the scene as it is
    /// The scene is to be in view, too, when the camera is turned about the vertical axis through this point.
    std::optional<Vec3d> orbit_center;
};
FATHOM_API CompletedScene complete_scene(SceneDescription& scene, const CompleteOptions& options);

/// The camera of that name (empty: the first) where its node puts it, in world space; lengths take the node's scale.
/// Throws Error, naming the cameras there are, if there is none of that name in the scene.
FATHOM_API Camera world_camera(const SceneDescription& scene, const std::string& name);

}  // namespace fathom
