// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Fixture of the Mitsuba import tests.
#include <string>

#include "formats/import_test_helpers.h"

namespace fathom::test {

class Mitsuba : public ImportTest {
protected:
    static std::string scene_of(const std::string& inside)
    {
        return "<scene version=\"3.0.0\">\n" + inside + "\n</scene>";
    }
    SceneDescription read(const std::string& inside) { return load("a.xml", scene_of(inside)); }
    std::string error(const std::string& inside) { return error_of("a.xml", scene_of(inside)); }
    /// Material of the only shape of a scene.
    static const Material& material_of(const SceneDescription& scene)
    {
        for (const Node& node : scene.nodes)
            for (const Shape& shape : node.shapes) return scene.materials.at(std::size_t(shape.material));
        throw std::runtime_error("no shape");
    }
    Material bsdf(const std::string& xml) { return material_of(read("<shape type=\"sphere\">" + xml + "</shape>")); }
    static const Camera& camera_of(const SceneDescription& scene) { return scene.cameras.at(0); }
    Camera sensor(const std::string& inside)
    {
        return camera_of(read("<sensor type=\"perspective\">" + inside + "</sensor>"));
    }
};

inline constexpr const char* wide_film =
    R"(<film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/></film>)";

}  // namespace fathom::test
