// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "fathom/api.h"
#include "fathom/bvh_quality.h"
#include "fathom/description.h"
#include "fathom/load.h"

namespace fathom {

/// Size of a compiled scene and the time that its compilation took.
struct CompileStatistics {
    /// Sizes of the scene:
    ///
    /// triangles     Number of triangles, those of each instance counted separately. Quads (parallelograms) are not
    ///               among them.
    /// primitives    Number of triangles, quads, spheres, disks, curve segments and points in memory; those of
    ///               instances count once.
    /// instances     Number of instances, including those of movable nodes and meshes.
    /// lights        Number of emissive primitives, lights without a surface, and the environment.
    /// memory_bytes  Memory of geometry, acceleration structures, textures and lights.
    std::size_t triangles = 0, primitives = 0, instances = 0, lights = 0, memory_bytes = 0;
    double build_s = 0;  ///< Time that the last compilation or update took, in seconds.
};

/// An immutable compiled scene: geometry in acceleration structures, materials, textures and lights in tables.
///
/// A copy shares the data of its original, so a Scene is passed by value. Several threads may use it at once. A
/// default-constructed Scene is empty and may only be assigned to. Use EditableScene for scenes that change.
class FATHOM_API Scene {
public:
    /// Compiles `description` on all threads that ThreadLimit allows.
    ///
    /// camera    Name of one of the scene's cameras; empty selects the first one.
    /// warnings  Receives problems that leave a usable scene, such as textures that can't be read.
    /// build     Quality of the BVH; it changes time and memory, not the image.
    ///
    /// Throws Error if the scene can't be rendered: no camera, an index out of range, a number that is not finite, a
    /// cycle of nodes, or not enough memory.
    static Scene compile(const SceneDescription& description, const std::string& camera, Warnings& warnings,
                         BvhQuality build = BvhQuality::standard);

    /// Returns sizes and the compilation time.
    const CompileStatistics& statistics() const;
    /// Returns the camera that the scene was compiled for, in world space.
    const Camera& camera() const;
    /// Returns a 64-bit hash of everything that determines the image except camera and settings. It is not
    /// cryptographic.
    std::uint64_t fingerprint() const;

    /// Internal state, defined inside the library.
    struct Data;
    /// Returns the internal state.
    const Data& data() const { return *data_; }

private:
    friend class EditableScene;
    std::shared_ptr<const Data> data_;
};

}  // namespace fathom
