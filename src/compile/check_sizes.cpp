// SPDX-License-Identifier: Apache-2.0
#include "compile/check_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fathom/error.h"
#include "scene/bounds.h"

namespace fathom {

namespace {

/// Largest coordinate in meters. Beyond it, doubles are coarser than a meter.
constexpr double farthest = 1e15;
/// Largest coordinate in render space, where scenes have a radius of at most 1024: products of three such numbers still
/// fit into float.
constexpr double largest_in_render_space = 1e12;
/// Limit of lengths in the object space of instances, where one unit of render space can be long too.
constexpr double largest_in_own_space = 1e12;

bool is_finite(Vec3d v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

[[noreturn]] void refuse(const SceneDescription& scene, const Camera& camera, const std::string& what)
{
    throw Error(scene.file, fmt::format("camera '{}'", camera.name), what);
}

double largest(Vec3d v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Bounds of shapes in their own space, cached for shared geometry.
class Boxes {
public:
    explicit Boxes(const Compiler& c) : scene_(c.scene), displaced_(c.displaced) {}

    const Bounds& of(const Shape& shape)
    {
        if (const DisplacedShapes::Entry* entry = displaced_.find(scene_, shape)) return entry->bounds;
        const std::pair<std::size_t, int> key{shape.geometry.index(), shared_index(shape)};
        if (key.second < 0) return own_ = shape_bounds(scene_, shape);
        const auto [found, is_new] = shared_.try_emplace(key);
        if (is_new) found->second = shape_bounds(scene_, shape);
        return found->second;
    }

private:
    static int shared_index(const Shape& shape)
    {
        if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) return mesh->mesh;
        if (const auto* curves = std::get_if<CurvesInstance>(&shape.geometry)) return curves->curves;
        if (const auto* points = std::get_if<PointsInstance>(&shape.geometry)) return points->points;
        return -1;
    }

    const SceneDescription& scene_;
    const DisplacedShapes& displaced_;
    std::map<std::pair<std::size_t, int>, Bounds> shared_;
    Bounds own_;
};

/// Checks that the geometry of flattened shapes fits into float in render space.
class PlacedChecker {
public:
    explicit PlacedChecker(const Compiler& c) : c_(c), boxes_(c) {}

    void check(const FlattenedShape& p, const FlattenedScene& occurrences)
    {
        const Bounds& box = boxes_.of(*p.shape);
        if (box.empty) {
            if (p.shape->geometry.index() != 0) refuse(p, "its size exceeds the range of floating-point numbers");
            return;
        }
        if (!(std::max(largest(box.min), largest(box.max)) <= farthest))
            refuse(p, fmt::format("a coordinate of its shape is {:.3g}; the limit is {:g}",
                                  std::max(largest(box.min), largest(box.max)), farthest));
        check_box(p, p.render_from_node, box);
        if (p.motion >= 0)
            for (const NodeKey& pose : occurrences.motions[std::size_t(p.motion)])
                check_box(p, pose.parent_from_node, box);
        const auto* sphere = std::get_if<Sphere>(&p.shape->geometry);
        if (!sphere || !sphere->center_end) return;
        for (const double time : {c_.tables.shutter_open, c_.tables.shutter_close})
            check_point(p, p.render_from_node.point(sphere->center + (*sphere->center_end - sphere->center) * time));
    }

private:
    [[noreturn]] void refuse(const FlattenedShape& p, const std::string& what) const
    {
        const std::string& name = c_.scene.nodes[std::size_t(p.node)].name;
        throw Error(c_.scene.file, fmt::format("nodes[{}]{}", p.node, name.empty() ? "" : " '" + name + "'"), what);
    }

    void check_box(const FlattenedShape& p, const Transform& t, const Bounds& box) const
    {
        for (int i = 0; i < 8; ++i)
            check_point(p, t.point({i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                                    i & 4 ? box.max.z : box.min.z}));
    }
    void check_point(const FlattenedShape& p, Vec3d render) const
    {
        const double metres = largest(render) / c_.space.scale;
        if (!is_finite(render)) refuse(p, "places its shape beyond the range of floating-point numbers");
        if (metres > farthest || largest(render) > largest_in_render_space)
            refuse(p, fmt::format("places its shape {:.3g} m away from the camera; the limit is {:g} m", metres,
                                  std::min(farthest, largest_in_render_space / c_.space.scale)));
    }

    const Compiler& c_;
    Boxes boxes_;
};

}  // namespace

void check_camera(const SceneDescription& scene, const Camera& camera)
{
    const auto check = [&](double value, const char* what, const char* unit) {
        if (!(std::abs(value) <= farthest))
            refuse(scene, camera, fmt::format("{} {:.3g}{}; the limit is {:g}{}", what, value, unit, farthest, unit));
    };
    for (const Vec3d& v : {camera.position, camera.look_at, camera.look_at - camera.position})
        for (const double x : {v.x, v.y, v.z}) check(x, "a coordinate is", "");
    if (!(is_finite(camera.up) && largest(camera.up) > 0 && is_finite(normalize(camera.up))))
        refuse(scene, camera, "'up' is not a direction");
    if (!(length(camera.look_at - camera.position) > 0))
        refuse(scene, camera, "its position and its look_at point are the same");
    check(camera.aperture, "the aperture is", " m");
    check(camera.focus_distance, "the focus distance is", " m");
    check(camera.height, "the height is", " m");
    check(camera.shift_x, "the shift is", "");
    check(camera.shift_y, "the shift is", "");
    check(camera.shutter_open, "the shutter opens at", " s");
    check(camera.shutter_close, "the shutter closes at", " s");
    if (camera.shutter_open < camera.shutter_close && !(float(camera.shutter_open) < float(camera.shutter_close)))
        refuse(scene, camera,
               fmt::format("the shutter opens at {:.9g} s and closes at {:.9g} s, which are equal in single precision; "
                           "use times closer to 0",
                           camera.shutter_open, camera.shutter_close));
}

void check_camera(const SceneDescription& scene, const Camera& camera, const RenderSpace& space)
{
    const auto check = [&](double metres, const char* what) {
        if (!(std::abs(metres) * space.scale <= largest_in_render_space))
            refuse(scene, camera,
                   fmt::format("{} is {:.3g} m, which is too large compared with the scene", what, metres));
    };
    check(camera.aperture, "the aperture");
    check(camera.focus_distance, "the focus distance");
    check(length(camera.look_at - camera.position), "the distance to its look_at point");
    if (camera.kind == CameraKind::orthographic) check(camera.height, "the height");
}

void check_flattened(const Compiler& c, const std::vector<FlattenedShape>& shapes, const FlattenedScene& all)
{
    PlacedChecker checker(c);
    for (const FlattenedShape& p : shapes) checker.check(p, all);
}

bool is_degenerate(const Transform& render_from_node)
{
    const Transform inverse = render_from_node.inverse();
    double sum = 0;
    for (const auto& row : inverse.m)
        for (const double x : row) sum += std::abs(x);
    return !(sum > 0 && sum <= largest_in_own_space);
}

}  // namespace fathom
