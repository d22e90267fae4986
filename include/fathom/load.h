// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/description.h"

namespace fathom {

/// Collects problems that still leave an image. Each message is stored once, with a count. Printing them is up to the
/// program.
class Warnings {
public:
    /// Adds a message, or increases its count if it is there already.
    ///
    /// message  One line that names file and place.
    /// times    How often it occurred; 0 adds nothing.
    void add(const std::string& message, std::size_t times = 1)
    {
        if (times > 0) counts_[message] += times;
    }
    /// Returns the messages in alphabetical order, each with its count.
    const std::map<std::string, std::size_t>& counts() const { return counts_; }
    /// Returns whether there are no messages.
    bool empty() const { return counts_.empty(); }

private:
    std::map<std::string, std::size_t> counts_;
};

/// Choices for reading a scene file.
struct LoadOptions {
    std::string scene;    ///< glTF: name or number of the scene to read; empty: the default scene of the file.
    std::string variant;  ///< glTF: name or number of the material variant; empty: the default materials.
    std::string format;   ///< Extension that the file is read as, such as "glb"; empty: that of its name.
    char up_axis = 0;     ///< Axis of the file that points up, 'y' or 'z'; 0: as usual in the format. Scenes with z up
                          ///< are rotated, so that y is up in the result.
    /// Reads only files in the folder of the scene and below it, after following links; for untrusted files. By default
    /// a scene can refer to any file.
    bool confine = false;
    /// Mitsuba: values of the scene's parameters (`$name`) by name. They override the defaults in the file.
    std::map<std::string, std::string> definitions;
};

/// Reads a scene or model. The format is recognized by content or extension: Fathom's JSON, glTF and GLB, Mitsuba 3,
/// pbrt, OBJ, PLY, STL, and the formats that Assimp reads.
///
/// file      Relative paths inside the file are relative to its folder.
/// options   Scene, variant, axis and restrictions.
/// warnings  Receives problems that still leave an image.
///
/// Returns a description that passes the checks of Scene::compile, except that it may lack a camera and lights. Throws
/// Error if a file can't be read or understood, or doesn't fit into memory.
FATHOM_API SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions& options,
                                       Warnings& warnings);

/// Axis-aligned box.
struct Bounds {
    Vec3d min, max;     ///< Opposite corners in meters; unspecified if the box is empty.
    bool empty = true;  ///< True if the box contains no point.
};
/// Returns a world-space box around all geometry, including instances and displacement. Moving nodes are evaluated at
/// up to nine of their key times.
FATHOM_API Bounds world_bounds(const SceneDescription& scene);

/// How add_default_camera() frames a scene. The camera looks from the direction given by azimuth and elevation; azimuth
/// 0 is +z, azimuth 90 is +x.
struct FramingOptions {
    double azimuth_deg = 30, elevation_deg = 20;  ///< Direction from the scene to the camera, in degrees.
    bool force_camera = false;                    ///< Adds a camera even if the scene has one, and puts it first.
    double aspect = 4.0 / 3;                      ///< Width / height of the image.
    std::optional<Bounds> bounds;                 ///< Box to frame, in world space; empty: the scene's geometry.
    /// Point on a vertical axis. The scene then stays in view when the camera is rotated about that axis.
    std::optional<Vec3d> orbit_center;
};
/// Adds a camera that frames the scene, unless the scene has one. compile_lit() adds light.
///
/// Returns whether a camera was added. Throws Error if the scene is invalid.
FATHOM_API bool add_default_camera(SceneDescription& scene, const FramingOptions& options);

/// Returns a camera in world space, where its node places it when its shutter opens. The height of orthographic
/// cameras, the aperture and the focus distance are multiplied by the scale of the node (the cube root of its volume
/// scale).
///
/// name  Name of the camera; empty selects the first one that is part of the scene.
///
/// Throws Error, listing the cameras, if the scene has none of that name.
FATHOM_API Camera world_camera(const SceneDescription& scene, const std::string& name);

}  // namespace fathom
