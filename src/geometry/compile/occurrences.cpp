// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "compile/check_sizes.h"
#include "compile/compiler.h"
#include "geometry/compile/poses.h"
#include "scene/bounds.h"
#include "scene/motion.h"

namespace fathom {

namespace {

class SceneFlattener {
public:
    explicit SceneFlattener(const Compiler& c)
        : c_(c), open_(c.tables.shutter_open), close_(c.tables.shutter_close), moves_(c.scene.nodes.size())
    {
        for (std::size_t i = 0; i < moves_.size(); ++i) moves_[i] = moves(c.scene.nodes[i], open_, close_);
    }

    FlattenedScene run()
    {
        for (int root : c_.scene.roots) flatten_node(root, c_.space.from_world(), 0, false);
        if (still_things_ > 0)
            c_.warnings.add(
                c_.scene.file + ": motion of directional lights and cameras is not supported and is ignored",
                still_things_);
        return std::move(occurrences_);
    }

private:
    /// moving: number of moving nodes on the path to this one. movable: whether any of them is movable.
    void flatten_node(int index, const Transform& render_from_parent, int moving, bool movable)
    {
        const Node& node = c_.scene.nodes[std::size_t(index)];
        path_.push_back(index);
        moving += moves_[std::size_t(index)];
        movable |= node.movable;
        const Transform render_from_node = render_from_parent * transform_at(node, open_);
        int motion = -1;
        const bool has_lamp =
            node.light >= 0 && c_.scene.lights[std::size_t(node.light)].kind != LightKind::directional;
        if (moving > 0 && (has_lamp || !node.shapes.empty())) motion = add_motion(node);
        const bool carries_lamp = has_lamp && motion >= 0 && !vanishes_once(motion);
        for (const Shape& shape : node.shapes)
            occurrences_.shapes.push_back({&shape, render_from_node, std::uint32_t(occurrences_.shapes.size()), index,
                                           motion, movable || has_movable_vertices(shape)});
        if (node.light >= 0)
            occurrences_.lights.push_back(
                {&c_.scene.lights[std::size_t(node.light)], render_from_node, carries_lamp ? motion : -1});
        if (moving > 0) still_things_ += std::size_t(node.light >= 0 && !carries_lamp) + std::size_t(node.camera >= 0);
        for (int child : node.children) flatten_node(child, render_from_node, moving, movable);
        path_.pop_back();
    }

    bool vanishes_once(int motion) const
    {
        const std::vector<NodeKey>& poses = occurrences_.motions[std::size_t(motion)];
        return std::any_of(poses.begin(), poses.end(),
                           [](const NodeKey& pose) { return is_degenerate(pose.parent_from_node); });
    }

    bool has_movable_vertices(const Shape& shape) const
    {
        const auto* mesh = std::get_if<MeshInstance>(&shape.geometry);
        return mesh && c_.scene.meshes[std::size_t(mesh->mesh)].movable;
    }

    int add_motion(const Node& node)
    {
        std::vector<double> times{open_, close_};
        for (int i : path_)
            for (const NodeKey& key : c_.scene.nodes[std::size_t(i)].motion)
                if (open_ < key.time && key.time < close_) times.push_back(key.time);
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), times.end()), times.end());
        Bounds content;
        for (const Shape& shape : node.shapes) {
            const Bounds b = bounds_of(shape);
            if (b.empty) continue;
            if (content.empty) content = b;
            content.min = {std::min(content.min.x, b.min.x), std::min(content.min.y, b.min.y),
                           std::min(content.min.z, b.min.z)};
            content.max = {std::max(content.max.x, b.max.x), std::max(content.max.y, b.max.y),
                           std::max(content.max.z, b.max.z)};
        }
        if (content.empty) {
            // The node carries only a light: its position gets the accuracy of an object of moderate size in the scene.
            const double size = c_.space.radius / c_.space.scale / 16;
            content.min = {-size, -size, -size}, content.max = {size, size, size};
        }
        const auto at = [&](double time) {
            Transform t = c_.space.from_world();
            for (int i : path_) t = t * transform_at(c_.scene.nodes[std::size_t(i)], time);
            return t;
        };
        occurrences_.motions.push_back(fit_poses(at, times, content));
        return int(occurrences_.motions.size()) - 1;
    }

    /// Bounds of a shape in its own space; those of meshes are cached.
    Bounds bounds_of(const Shape& shape)
    {
        const auto* mesh = std::get_if<MeshInstance>(&shape.geometry);
        if (!mesh) return shape_bounds(c_.scene, shape);
        if (mesh_bounds_.empty()) mesh_bounds_.resize(c_.scene.meshes.size());
        Bounds& known = mesh_bounds_[std::size_t(mesh->mesh)];
        if (known.empty) known = shape_bounds(c_.scene, shape);
        return known;
    }

    const Compiler& c_;
    const double open_, close_;
    std::vector<bool> moves_;
    std::vector<Bounds> mesh_bounds_;
    std::vector<int> path_;
    std::size_t still_things_ = 0;
    FlattenedScene occurrences_;
};

}  // namespace

FlattenedScene flatten_scene(const Compiler& c)
{
    return SceneFlattener(c).run();
}

}  // namespace fathom
