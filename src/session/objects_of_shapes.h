// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fathom/ground_truth.h"

namespace fathom {

/// Object of each shape of a scene, by object_id of the compiled scene.
inline std::vector<std::uint32_t> objects_of_shapes(const std::vector<SceneObject>& objects)
{
    std::vector<std::uint32_t> of_shape;
    for (std::size_t i = 0; i < objects.size(); ++i)
        of_shape.resize(std::size_t(objects[i].first_shape), std::uint32_t(i));
    return of_shape;
}

/// Number of an object in GroundTruth::instance. Shapes past the last entry belong to the last object.
inline std::uint32_t instance_of(const std::vector<std::uint32_t>& of_shape, std::uint32_t shape, std::size_t objects)
{
    return shape < of_shape.size() ? of_shape[shape] : std::uint32_t(objects);
}

}  // namespace fathom
