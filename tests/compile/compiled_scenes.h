// SPDX-License-Identifier: Apache-2.0
#pragma once
// Functions that build small scene descriptions and compile them to tables for inspection.
#include "compile/scene_data.h"
#include "support/placed_light.h"

namespace fathom {

using test::add_light;

inline SceneDescription empty_scene()
{
    SceneDescription d;
    d.file = "test";
    d.nodes.emplace_back();
    d.roots = {0};
    d.cameras.emplace_back();
    d.nodes[0].camera = 0;
    return d;
}
inline Scene compiled(const SceneDescription& d)
{
    Warnings warnings;
    return Scene::compile(d, "", warnings);
}
inline int add_lamp(SceneDescription& d, float radiance, bool two_sided = false)
{
    Material m;
    m.emission.radiance.value = {radiance, radiance, radiance};
    m.emission.two_sided = two_sided;
    d.materials.push_back(m);
    return int(d.materials.size()) - 1;
}

}  // namespace fathom
