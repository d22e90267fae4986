// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/description/camera.h"
#include "fathom/description/environment.h"
#include "fathom/description/geometry.h"
#include "fathom/description/light.h"
#include "fathom/description/material.h"
#include "fathom/description/measured_brdf.h"
#include "fathom/description/node.h"
#include "fathom/description/render_hints.h"
#include "fathom/description/texture.h"

/// The contents of a scene as plain data, independent of file formats. Importers fill it from files, and programs fill
/// it to make a scene in code.
///
/// Objects refer to each other by index into the vectors of SceneDescription; -1 means none. Units are meters, radians
/// and seconds; radiance and colors are linear Rec.709, and a radiance of 1 is 1 nit. World space is right-handed and y
/// points up. docs/scene-format.md describes the same parameters with examples.
namespace fathom {

/// A complete scene.
struct SceneDescription {
    std::string file;                          ///< File that the scene was read from, for messages; may be empty.
    std::vector<std::filesystem::path> files;  ///< All files that were read, `file` first, images excluded.
    std::vector<ImageFile> images;             ///< Images of textures, lights and the environment.
    std::vector<Texture> textures;             ///< Textures, which materials and other textures refer to.
    std::vector<Material> materials;           ///< Materials, which shapes and mixtures refer to.
    std::vector<MeasuredBrdf> measured;        ///< Measured BRDFs of materials.
    std::vector<Mesh> meshes;                  ///< Triangle meshes, which shapes place.
    std::vector<Curves> curves;                ///< Sets of curves, which shapes place.
    std::vector<Points> points;                ///< Sets of spheres, which shapes place.
    std::vector<Light> lights;                 ///< Lights without a surface, which nodes place.
    std::vector<Camera> cameras;               ///< Cameras, which nodes place; the first one is the default.
    std::vector<Node> nodes;                   ///< Nodes, which place shapes, lights and cameras.
    std::vector<int> roots;                    ///< Indices of the nodes at the top of the scene.
    Environment environment;                   ///< Light from outside the scene.
    RenderHints hints;                         ///< Render settings of the file.
};

}  // namespace fathom
