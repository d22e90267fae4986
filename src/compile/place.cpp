#include "compile/compiler.h"

namespace fathom {

namespace {

void place_node(const SceneDescription& scene, int index, const Transform& render_from_parent, Placed& placed)
{
    const Node& node = scene.nodes[std::size_t(index)];
    const Transform render_from_node = render_from_parent * node.parent_from_node;
    for (const Shape& shape : node.shapes)
        placed.shapes.push_back({&shape, render_from_node, std::uint32_t(placed.shapes.size())});
    if (node.light >= 0) placed.lights.push_back({&scene.lights[std::size_t(node.light)], render_from_node});
    for (int child : node.children) place_node(scene, child, render_from_node, placed);
}

}  // namespace

Placed place(const SceneDescription& scene, const RenderSpace& space)
{
    Placed placed;
    for (int root : scene.roots) place_node(scene, root, space.from_world(), placed);
    return placed;
}

}  // namespace fathom
