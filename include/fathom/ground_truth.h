// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/job.h"
#include "fathom/vector.h"

/// Ground truth for training and evaluation: what one ray through the center of each pixel meets. In contrast to the
/// layers of RenderSettings::aovs nothing is filtered or averaged, so that depths at edges are those of one surface,
/// and ids are exact. The results have the same bits for all numbers of threads and all kernels.
///
/// Rays start in the middle of the lens, at the middle of the shutter interval. A surface with alpha counts as opaque
/// where its opacity is 0.5 or more. Glass and other transmissive surfaces are surfaces like all others. Rays pass what
/// camera rays pass: hidden surfaces, the backs of single-sided ones, and boundaries of index 1 around fog and smoke.
namespace fathom {

/// An object: one place of a node that has shapes. A node with several parents is an object in each of them.
struct SceneObject {
    std::string name;     ///< Name of the node, or of its mesh, or else "object N"; not necessarily unique.
    int node = -1;        ///< Index of the node.
    int first_shape = 0;  ///< Number of shapes of the objects before this one.
    Transform pose;       ///< Rotation and translation that place the object in the world.
    Transform stretch;    ///< What the node applies before `pose`: scaling, shear, or mirroring.
};
/// Returns all objects of a scene in the order of its nodes (depth first), at a time in seconds.
FATHOM_API std::vector<SceneObject> scene_objects(const SceneDescription& scene, double time_s = 0);

/// A pinhole camera in the terms of computer vision, for an image with square pixels.
struct PinholeCamera {
    /// Focal lengths in pixels, and the principal point from the outer corner of the top left pixel, whose center is at
    /// (0.5, 0.5).
    double fx = 1, fy = 1, cx = 0, cy = 0;
    /// Rotation and translation of the camera. Its axes are those of OpenGL: x right, y up, z towards the viewer.
    Transform world_from_camera;
};
/// Returns the pinhole camera of a job. Throws Error if its camera is not a perspective one.
FATHOM_API PinholeCamera pinhole_camera(const RenderJob& job);

/// What the rays through the centers of the pixels meet. Vectors have an element for each pixel, row by row from the
/// top left, and values as stated where a ray meets nothing.
struct FATHOM_API GroundTruth {
    int width = 0, height = 0;         ///< Size of the image.
    std::vector<float> depth;          ///< Distance along the view axis in meters (spherical cameras: along the ray);
                                       ///< infinity.
    std::vector<float> distance;       ///< Distance along the ray in meters; infinity.
    std::vector<Vec3f> normal;         ///< Unit normal in world space, on the side of the camera; 0. It is
                                       ///< interpolated from vertex normals; normal and bump maps don't change it.
    std::vector<Vec3f> camera_normal;  ///< The normal in camera space: x right, y up, z towards the viewer; 0.
    std::vector<Vec3f> position;       ///< World-space position in meters; 0.
    std::vector<std::uint32_t> instance;  ///< Object: index into scene_objects() plus 1; 0.
    std::vector<std::uint32_t> material;  ///< Material: index into SceneDescription::materials plus 1; 0.

    /// A pixel's surface point in a form that can be found again in another state of the scene.
    struct Point {
        Vec3f place;         ///< Position in the space of the instance, or render space.
        float u = 0, v = 0;  ///< Barycentric weights of a triangle's last two vertices.
        std::uint32_t primitive = 0xffffffffu, instance = 0xffffffffu;  ///< Indices of the compiled scene.
    };
    std::vector<Point> points;  ///< Used by optical_flow().
};

/// Pixels of an object.
struct ObjectMask {
    std::uint32_t instance = 0;          ///< GroundTruth::instance of the object.
    std::vector<std::uint32_t> visible;  ///< Pixels whose first surface is the object's: x + y * width, ascending.
    std::vector<std::uint32_t> whole;    ///< Pixels that it would cover if nothing were in front of it; includes
                                         ///< `visible`.
};

/// Traces one ray through the center of each pixel.
///
/// job      Scene, camera, size and number of threads; crop and other settings don't matter.
/// objects  scene_objects() of the description that the scene was compiled from.
FATHOM_API GroundTruth trace_ground_truth(const RenderJob& job, const std::vector<SceneObject>& objects);

/// Returns the masks of all objects that have a pixel in the image, by instance.
FATHOM_API std::vector<ObjectMask> trace_masks(const RenderJob& job, const std::vector<SceneObject>& objects);

/// Returns the optical flow from an image to another one: for each pixel, how many pixels to the right (x) and down (y)
/// its surface point lies in the other image. It can lie outside, or be hidden there by other surfaces. NaN where
/// nothing is hit, or the point is behind the other camera.
///
/// truth  Ground truth of `job`.
/// job    The job of this image.
/// other  The job of the other image: the same scene with another camera, or another state of the scene, whose nodes
///        and vertices have moved; its middle of the shutter interval counts.
///
/// Throws Error if the scenes have different shapes, or a camera is equal-area.
FATHOM_API std::vector<Vec2f> optical_flow(const GroundTruth& truth, const RenderJob& job, const RenderJob& other);

}  // namespace fathom
