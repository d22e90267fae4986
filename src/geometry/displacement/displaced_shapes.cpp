// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/displaced_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "compile/compiler.h"
#include "compile/render_space.h"
#include "geometry/compile/instancing.h"
#include "geometry/displacement/displace.h"
#include "geometry/displacement/texture_detail.h"
#include "kernel/kernel.h"
#include "materials/compile/inputs.h"
#include "scene/displacement.h"
#include "scene/tessellate.h"

namespace fathom {

namespace {

/// Displacement heights of mesh vertices, from a texture.
class Heights {
public:
    Heights(const SceneTables& tables, const FloatInput& height, float midlevel)
        : tables_(tables), height_(height), midlevel_(double(midlevel))
    {
    }

    void find(const Mesh& mesh, std::size_t begin, std::size_t end, float* heights)
    {
        if (height_.texture < 0) {
            std::fill_n(heights, end - begin, 1.0f);
        } else {
            std::vector<KernelTexturePoint> points(end - begin);
            for (std::size_t i = begin; i < end; ++i) points[i - begin] = point(mesh, i);
            look_up_texture(tables_, std::uint32_t(height_.texture), std::uint32_t(height_.channel), points.data(),
                            points.size(), heights);
        }
        for (std::size_t i = 0; i < end - begin; ++i) {
            heights[i] = float(double(height_.value) * (double(heights[i]) - midlevel_));
            if (std::isfinite(heights[i])) continue;
            heights[i] = 0;
            ++not_finite;
        }
    }

    std::atomic<std::size_t> not_finite = 0;

private:
    static KernelTexturePoint point(const Mesh& mesh, std::size_t i)
    {
        KernelTexturePoint p;
        for (std::size_t set = 0; set < 2; ++set)
            if (!mesh.uvs[set].empty()) p.uv[set] = mesh.uvs[set][i];
        p.position = mesh.positions[i];
        if (!mesh.colors.empty()) p.vertex_color = mesh.colors[i];
        return p;
    }

    const SceneTables& tables_;
    const FloatInput height_;
    const double midlevel_;
};

Bounds bounds_of(const Mesh& mesh)
{
    Bounds box;
    const auto add = [&](const std::vector<Vec3f>& positions) {
        for (const Vec3f& q : positions) {
            const Vec3d p = to_double(q);
            if (box.empty) box = {p, p, false};
            box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
            box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
        }
    };
    if (mesh.motion.empty()) add(mesh.positions);
    for (const MeshKey& key : mesh.motion) add(key.positions);
    return box;
}

std::string name_of(const SceneDescription& scene, const Shape& shape)
{
    if (const auto* instance = std::get_if<MeshInstance>(&shape.geometry)) {
        const std::string& name = scene.meshes[std::size_t(instance->mesh)].name;
        return fmt::format("meshes[{}]{}", instance->mesh, name.empty() ? "" : " '" + name + "'");
    }
    return shape.name.empty() ? "shape" : "shape '" + shape.name + "'";
}

}  // namespace

DisplacedShapes::Settings::Settings(const Material& m)
    : height(m.displacement.height), midlevel(m.displacement.midlevel), edge_length(m.displacement.edge_length)
{
}

bool DisplacedShapes::Settings::operator==(const Settings& other) const
{
    return height.value == other.height.value && height.texture == other.height.texture &&
           height.channel == other.height.channel && midlevel == other.midlevel && edge_length == other.edge_length;
}

std::vector<DisplacedShapes::Settings> DisplacedShapes::settings_of(const SceneDescription& scene)
{
    return {scene.materials.begin(), scene.materials.end()};
}

bool DisplacedShapes::differ(const SceneDescription& scene) const
{
    return settings_ != settings_of(scene);
}

bool DisplacedShapes::has(const Mesh& mesh) const
{
    return std::any_of(entries_.begin(), entries_.end(), [&](const auto& e) { return e.first.first == &mesh; });
}

const DisplacedShapes::Entry* DisplacedShapes::find(const SceneDescription& scene, const Shape& shape) const
{
    if (entries_.empty()) return nullptr;
    const auto found = entries_.find({described_geometry(scene, shape), shape.material});
    return found == entries_.end() ? nullptr : &found->second;
}

void DisplacedShapes::drop_meshes()
{
    for (auto& [key, entry] : entries_) entry.mesh = {};
}

void DisplacedShapes::make(const SceneDescription& scene, const SceneTables& tables,
                           const std::vector<FlattenedShape>& shapes, Warnings& warnings)
{
    entries_.clear();
    settings_ = settings_of(scene);
    if (std::none_of(settings_.begin(), settings_.end(), [](const Settings& s) { return s.displaces(); })) return;
    for (const FlattenedShape& p : shapes)
        if (p.shape->material >= 0 && settings_[std::size_t(p.shape->material)].displaces())
            add(scene, tables, *p.shape, warnings);
}

void DisplacedShapes::add(const SceneDescription& scene, const SceneTables& tables, const Shape& shape,
                          Warnings& warnings)
{
    const auto* instance = std::get_if<MeshInstance>(&shape.geometry);
    if (!can_be_displaced(shape)) {
        warnings.add(fmt::format(
            "{}: displacement of curves, of points and of spheres with a center_end is not supported", scene.file));
        return;
    }
    const auto [place, is_new] = entries_.try_emplace({described_geometry(scene, shape), shape.material});
    if (!is_new) return;
    const Mesh made = instance ? Mesh() : tessellate(shape.geometry);
    const Mesh& mesh = instance ? scene.meshes[std::size_t(instance->mesh)] : made;

    const Settings& settings = settings_[std::size_t(shape.material)];
    const TextureDetail detail(tables, texture_id(settings.height.texture));
    Heights heights(tables, settings.height, settings.midlevel);
    Displacement by;
    by.may_be_coarser = !(settings.edge_length > 0);
    if (by.may_be_coarser)
        by.parts = [&](const Mesh& m, std::uint32_t a, std::uint32_t b) { return detail.parts(m, a, b); };
    else
        by.parts = [&](const Mesh& m, std::uint32_t a, std::uint32_t b) {
            return length(to_double(m.positions[b]) - to_double(m.positions[a])) / settings.edge_length;
        };
    by.heights = [&](const Mesh& m, std::size_t begin, std::size_t end, float* to) { heights.find(m, begin, end, to); };

    const std::string name = name_of(scene, shape);
    Displaced displaced = displace(mesh, by, scene.file, name);
    const std::size_t triangles = displaced.mesh.indices.size() / 3;
    if (displaced.wanted_triangles > double(triangles))
        warnings.add(
            fmt::format("{}: {}: displacement at the resolution of its texture would make {:.1f} million triangles; it "
                        "is limited to {:.1f} million (displacement_edge_length sets the resolution)",
                        scene.file, name, displaced.wanted_triangles / 1e6, double(triangles) / 1e6));
    if (heights.not_finite > 0)
        warnings.add(
            fmt::format("{}: {}: displacement heights that are not finite are replaced by 0", scene.file, name),
            heights.not_finite);
    place->second.bounds = bounds_of(displaced.mesh);
    place->second.mesh = std::move(displaced.mesh);
}

}  // namespace fathom
