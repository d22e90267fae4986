#pragma once
// Descriptions whose tables are looked at, and their tables.
#include "compile/scene_data.h"

namespace fathom {

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
    m.emission.value = {radiance, radiance, radiance};
    m.emission_two_sided = two_sided;
    d.materials.push_back(m);
    return int(d.materials.size()) - 1;
}
inline void add_light(SceneDescription& d, const Light& light, const Transform& place)
{
    Node node;
    node.parent_from_node = place;
    node.light = int(d.lights.size());
    d.lights.push_back(light);
    d.roots.push_back(int(d.nodes.size()));
    d.nodes.push_back(node);
}

}  // namespace fathom
