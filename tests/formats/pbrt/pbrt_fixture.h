// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Fixture of the pbrt import tests.
#include <stdexcept>
#include <string>

#include "formats/import_test_helpers.h"

namespace fathom::test {

class Pbrt : public ImportTest {
protected:
    /// A pbrt scene with this text after WorldBegin.
    SceneDescription world(const std::string& inside) { return load("a.pbrt", "WorldBegin\n" + inside); }
    std::string error(const std::string& inside) { return error_of("a.pbrt", "WorldBegin\n" + inside); }
    static const Shape& shape_of(const SceneDescription& scene)
    {
        for (const Node& node : scene.nodes)
            if (!node.shapes.empty()) return node.shapes[0];
        throw std::runtime_error("no shape");
    }
    static const Material& material_of(const SceneDescription& scene)
    {
        return scene.materials.at(std::size_t(shape_of(scene).material));
    }
    static const Mesh& mesh_of(const SceneDescription& scene)
    {
        return scene.meshes.at(std::size_t(std::get<MeshInstance>(shape_of(scene).geometry).mesh));
    }
    Material material(const std::string& text) { return material_of(world(text + "\nShape \"sphere\"")); }
    Camera camera(const std::string& text)
    {
        return load("a.pbrt", "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n" + text)
            .cameras.at(0);
    }
    static Vec3d origin(const SceneDescription& scene, std::size_t node)
    {
        return scene.nodes.at(node).parent_from_node.point({0, 0, 0});
    }
};

inline constexpr const char* triangle = R"("point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ])";

}  // namespace fathom::test
