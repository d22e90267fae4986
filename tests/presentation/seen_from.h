#pragma once
#include "fathom/description.h"

namespace fathom::test {

/// A model of one node and one material, with nothing in it yet, and a camera here that looks at the origin.
inline SceneDescription seen_from(Vec3d position)
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
