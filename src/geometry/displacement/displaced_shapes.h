// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fathom/description.h"
#include "fathom/load.h"
#include "kernel/tables.h"

namespace fathom {

struct FlattenedShape;

/// Displaced meshes of a scene, one for each combination of content and displacing material.
class DisplacedShapes {
public:
    /// A displaced mesh.
    struct Entry {
        Mesh mesh;
        Bounds bounds;  ///< bounds over all motion keys
    };

    /// Creates the meshes for the scene's materials, with textures from the tables.
    void make(const SceneDescription& scene, const SceneTables& tables, const std::vector<FlattenedShape>& shapes,
              Warnings& warnings);
    /// The displaced mesh of a shape, or null. Entries keep their address until make() is called again.
    const Entry* find(const SceneDescription& scene, const Shape& shape) const;
    /// Frees the meshes; entries and their bounds stay.
    void drop_meshes();
    bool empty() const { return entries_.empty(); }
    /// Whether displacement settings of materials have changed since make().
    bool differ(const SceneDescription& scene) const;
    /// Whether some entry derives from this mesh.
    bool has(const Mesh& mesh) const;

private:
    /// Displacement settings of a material.
    struct Settings {
        FloatInput height{0, -1, 0};
        float midlevel = 0;
        double edge_length = 0;

        explicit Settings(const Material& material);
        bool displaces() const { return height.value != 0; }
        bool operator==(const Settings& other) const;
    };
    static std::vector<Settings> settings_of(const SceneDescription& scene);
    void add(const SceneDescription& scene, const SceneTables& tables, const Shape& shape, Warnings& warnings);

    std::vector<Settings> settings_;  ///< indexed by material
    std::map<std::pair<const void*, int>, Entry> entries_;
};

}  // namespace fathom
