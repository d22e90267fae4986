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

/// Meshes of shapes whose materials displace them, one for each material that a mesh is shown with.
class DisplacedShapes {
public:
    struct Entry {
        Mesh mesh;
        Bounds bounds;  ///< at all keys
    };

    /// Makes them for the scene's materials as they are, with the textures among the tables.
    void make(const SceneDescription& scene, const SceneTables& tables, const std::vector<FlattenedShape>& shapes,
              Warnings& warnings);
    /// What stands for a shape; null if it is shown as it is. Entries stay in their place until make() is called again.
    const Entry* find(const SceneDescription& scene, const Shape& shape) const;
    /// Gives back the memory of meshes; their places and bounds stay.
    void drop_meshes();
    bool empty() const { return entries_.empty(); }
    /// Whether materials displace otherwise than when they were made.
    bool differ(const SceneDescription& scene) const;
    /// Whether some entry was made of this mesh.
    bool has(const Mesh& mesh) const;

private:
    /// As the material has it.
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

    std::vector<Settings> settings_;  ///< of each material
    std::map<std::pair<const void*, int>, Entry> entries_;
};

}  // namespace fathom
