// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom::test {

/// A model with one empty node and one material, and a camera at this position that looks at the origin.
inline SceneDescription model_viewed_from(Vec3d position)
{
    SceneDescription d;
    d.file = "model";
    d.cameras.emplace_back();
    d.cameras[0].position = position;
    d.cameras[0].look_at = {0, 0, 0};
    d.nodes.emplace_back();
    d.nodes[0].camera = 0;
    d.roots = {0};
    d.materials.emplace_back();
    return d;
}

}  // namespace fathom::test
