// SPDX-License-Identifier: Apache-2.0
#include "compile/scene_compiler.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "compile/check_sizes.h"
#include "compile/memory_estimate.h"
#include "fathom/memory.h"
#include "geometry/compile/instancing.h"

namespace fathom {

namespace {

/// Render space is centered on the camera, for precision close to it, and scaled so that the scene's radius is 512 to
/// 1024.
RenderSpace make_render_space(const SceneDescription& scene, const Camera& camera)
{
    RenderSpace space;
    const Bounds bounds = world_bounds(scene);
    space.origin = camera.position;
    if (bounds.empty) return space;
    double radius = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner{i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                           i & 4 ? bounds.max.z : bounds.min.z};
        radius = std::max(radius, length(corner - space.origin));
    }
    if (radius > 0 && std::isfinite(radius)) {
        space.scale = std::exp2(9 - std::floor(std::log2(radius)));
        space.radius = radius * space.scale;
        space.ball_center = space.point((bounds.min + bounds.max) * 0.5);
        space.ball_radius = 0.5 * length(bounds.max - bounds.min) * space.scale;
    }
    return space;
}

/// Number of triangles of instanced shapes, by shape.
std::vector<std::size_t> count_triangles(const GeometryTables& tables)
{
    std::vector<std::size_t> triangles(tables.shapes.size());
    for (std::uint32_t i = tables.world_triangles; i < tables.first_quad(); ++i)
        ++triangles[tables.shape_of_primitive[i]];
    return triangles;
}

CompileStatistics statistics_of(const SceneTables& tables, const KernelScene& kernel,
                                const std::vector<std::size_t>& triangles)
{
    CompileStatistics s;
    s.triangles = tables.world_triangles;
    for (const InstanceRecord& instance : tables.instances) s.triangles += triangles[instance.mesh_shape];
    s.primitives = tables.primitive_count();
    s.instances = tables.instances.size();
    s.lights = tables.lights.size();
    const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
    s.memory_bytes = bytes(tables.positions) + bytes(tables.normals) + bytes(tables.tangents) + bytes(tables.colors) +
                     bytes(tables.uv0) + bytes(tables.uv1) + bytes(tables.triangles) + bytes(tables.quads) +
                     bytes(tables.shape_of_primitive) + bytes(tables.shapes) + bytes(tables.instances) +
                     bytes(tables.curves) + bytes(tables.curve_points) + bytes(tables.points) + bytes(tables.poses) +
                     bytes(tables.texels) + bytes(tables.environment.texels) + bytes(tables.environment.conditional) +
                     bytes(tables.environment.conditional_guides) + bytes(tables.lights) + bytes(tables.light_tree) +
                     bytes(tables.light_pictures) + bytes(tables.picture_texels) + kernel.memory_bytes();
    for (const auto& image : tables.packed_images) s.memory_bytes += bytes(image);
    return s;
}

/// Throws Error if the compiled scene would not fit into memory, before compilation of geometry. Images are decoded
/// already.
void check_memory(const Compiler& c, const FlattenedScene& occurrences, BvhQuality build)
{
    ShapeMemory shapes(c.scene, build);
    for (const FlattenedShape& p : occurrences.shapes) {
        const MaterialRecord& material = c.tables.materials[material_index(c.tables, *p.shape)];
        const bool is_light =
            material.features.has(MaterialFeature::emits) && !material.features.has(MaterialFeature::unlit);
        shapes.add(*p.shape, c.mesh_of(*p.shape), 1, is_light);
    }
    check_memory(c.scene.file, shapes.needs());
}

void set_shutter(SceneTables& tables, const Camera& camera)
{
    tables.shutter_open = float(camera.shutter_open);
    tables.shutter_close = float(camera.shutter_close);
}

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

std::shared_ptr<Scene::Data> SceneCompiler::compile(Warnings& warnings)
{
    const Stopwatch watch;
    check_scene(scene_);
    auto data = std::make_shared<Scene::Data>();
    data->camera = world_camera(scene_, camera_);
    check_camera(scene_, data->camera);
    space_ = make_render_space(scene_, data->camera);
    check_camera(scene_, data->camera, space_);

    tables_ = std::make_shared<SceneTables>();
    tables_->origin = space_.origin;
    tables_->render_scale = space_.scale;
    set_shutter(*tables_, data->camera);
    textured_emissions_.clear();
    Compiler c = compiler(warnings);
    compile_materials(c);
    occurrences_ = flatten_scene(c);
    displaced_.make(scene_, *tables_, occurrences_.shapes, warnings);
    check_flattened(c, occurrences_.shapes, occurrences_);
    check_memory(c, occurrences_, build_);
    tables_->editable = std::any_of(occurrences_.shapes.begin(), occurrences_.shapes.end(),
                                    [](const FlattenedShape& p) { return p.movable; });
    contents_ = compile_geometry(c, occurrences_);
    displaced_.drop_meshes();
    triangles_ = count_triangles(*tables_);
    compile_instances(c, occurrences_, contents_);
    compile_environment(c);
    compile_lights(c, occurrences_);

    fingerprints_ = {fingerprint_vertices(*tables_), fingerprint_geometry(*tables_), fingerprint_materials(*tables_),
                     fingerprint_instances(*tables_)};
    data->tables = tables_;
    data->kernel = make_kernel_scene(tables_, build_);
    finish(*data);
    data->statistics.build_s = watch.seconds();
    return data;
}

bool SceneCompiler::update(Scene::Data& data, const SceneChanges& changes, Warnings& warnings)
{
    const Stopwatch watch;
    check_parts(scene_, changes.parts);
    data.camera = world_camera(scene_, camera_);
    check_camera(scene_, data.camera);
    check_camera(scene_, data.camera, space_);
    const bool other_times = tables_->shutter_open != float(data.camera.shutter_open) ||
                             tables_->shutter_close != float(data.camera.shutter_close);
    // Bounds of immovable geometry are valid only for the shutter interval of the last full compilation.
    if (other_times && contents_.fixed_motion) return false;
    if (!displacement_unchanged(changes, other_times)) return false;
    set_shutter(*tables_, data.camera);
    Compiler c = compiler(warnings);
    FlattenedScene now = flatten_scene(c);
    if (!static_shapes_unmoved(now)) return false;
    for (std::size_t i = 0; i < now.shapes.size(); ++i) now.shapes[i].instanced = occurrences_.shapes[i].instanced;
    const std::vector<int> meshes = other_times ? with_moving(changes.parts.meshes) : changes.parts.meshes;
    check_moved(c, now, meshes);
    occurrences_ = std::move(now);
    const bool other_materials = !changes.parts.materials.empty();
    if (other_materials && !update_materials(c)) return false;
    if (!update_vertices(c, meshes, other_times)) return false;
    compile_instances(c, occurrences_, contents_);
    if (changes.environment) compile_environment(c);
    compile_lights(c, occurrences_);

    if (!meshes.empty()) fingerprints_.vertices = fingerprint_vertices(*tables_);
    if (other_materials || changes.environment) fingerprints_.materials = fingerprint_materials(*tables_);
    fingerprints_.places = fingerprint_instances(*tables_);
    std::vector<std::uint32_t> shapes;
    for (int mesh : meshes)
        if (const auto shape = contents_.shapes.find(&scene_.meshes[std::size_t(mesh)]);
            shape != contents_.shapes.end())
            shapes.push_back(shape->second);
    data.kernel->update(shapes);
    finish(data);
    data.statistics.build_s = watch.seconds();
    return true;
}

bool SceneCompiler::refresh_space()
{
    const RenderSpace now = make_render_space(scene_, world_camera(scene_, camera_));
    space_.radius = now.radius;
    return now.origin == space_.origin && now.scale == space_.scale;
}

/// Whether displaced meshes are unchanged; changed ones require full compilation.
bool SceneCompiler::displacement_unchanged(const SceneChanges& changes, bool other_times) const
{
    const auto is_displaced = [&](int mesh) { return displaced_.has(scene_.meshes[std::size_t(mesh)]); };
    const std::vector<int>& meshes = changes.parts.meshes;
    if (std::any_of(meshes.begin(), meshes.end(), is_displaced) || displaced_.differ(scene_)) return false;
    return !other_times || displaced_.empty();
}

/// Returns whether no immovable shape has moved.
bool SceneCompiler::static_shapes_unmoved(const FlattenedScene& now) const
{
    const auto same_poses = [](const std::vector<NodeKey>& a, const std::vector<NodeKey>& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const NodeKey& x, const NodeKey& y) {
            return x.time == y.time && x.parent_from_node.m == y.parent_from_node.m;
        });
    };
    const auto same = [&](const FlattenedShape& a, const FlattenedShape& b) {
        if (a.shape != b.shape || a.movable != b.movable) return false;
        if (a.movable) return true;
        if (a.render_from_node.m != b.render_from_node.m || (a.motion < 0) != (b.motion < 0)) return false;
        return a.motion < 0 ||
               same_poses(occurrences_.motions[std::size_t(a.motion)], now.motions[std::size_t(b.motion)]);
    };
    return std::equal(occurrences_.shapes.begin(), occurrences_.shapes.end(), now.shapes.begin(), now.shapes.end(),
                      same);
}

/// Applies the position checks of compile() to shapes that moved.
void SceneCompiler::check_moved(const Compiler& c, const FlattenedScene& now, const std::vector<int>& meshes) const
{
    std::vector<FlattenedShape> moved;
    for (std::size_t i = 0; i < now.shapes.size(); ++i) {
        const FlattenedShape& p = now.shapes[i];
        const auto* mesh = std::get_if<MeshInstance>(&p.shape->geometry);
        const bool other_shape = mesh && std::find(meshes.begin(), meshes.end(), mesh->mesh) != meshes.end();
        if (other_shape || p.motion >= 0 || p.render_from_node.m != occurrences_.shapes[i].render_from_node.m)
            moved.push_back(p);
    }
    check_flattened(c, moved, now);
}

/// Returns the given meshes and those with vertex motion, whose vertices differ at other shutter times.
std::vector<int> SceneCompiler::with_moving(std::vector<int> meshes) const
{
    for (const auto& [content, shape] : contents_.shapes)
        if (tables_->shapes[shape].moving_vertices > 0)
            meshes.push_back(int(static_cast<const Mesh*>(content) - scene_.meshes.data()));
    std::sort(meshes.begin(), meshes.end());
    meshes.erase(std::unique(meshes.begin(), meshes.end()), meshes.end());
    return meshes;
}

/// other_times: the shutter interval changed, so only these meshes may have moving vertices.
bool SceneCompiler::update_vertices(Compiler& c, const std::vector<int>& meshes, bool other_times)
{
    if (meshes.empty()) return true;
    const std::vector<float> times = Instancing(c, occurrences_).vertex_times();
    if (times.size() != tables_->vertex_times.size()) return false;
    // The remaining moving vertices are compiled for the previous key times.
    if (!other_times && times != tables_->vertex_times) return false;
    tables_->vertex_times = times;
    return std::all_of(meshes.begin(), meshes.end(),
                       [&](int mesh) { return replace_vertices(c, contents_, scene_.meshes[std::size_t(mesh)]); });
}

/// Returns false if a material changed in a way that geometry depends on.
bool SceneCompiler::update_materials(Compiler& c)
{
    const std::vector<MaterialRecord> before = tables_->materials;
    compile_material_records(c);
    const auto alike = [](const MaterialRecord& a, const MaterialRecord& b) {
        using enum MaterialFeature;
        constexpr MaterialFeatures shown = textured | normal_mapped | bumped;
        return a.alpha_mode == b.alpha_mode && a.has_inside() == b.has_inside() &&
               (a.features & shown) == (b.features & shown) &&
               (a.emission_texture == no_index) == (b.emission_texture == no_index);
    };
    return std::equal(before.begin(), before.end(), tables_->materials.begin(), tables_->materials.end(), alike);
}

void SceneCompiler::finish(Scene::Data& data) const
{
    data.fingerprint = fingerprints_.all();
    data.statistics = statistics_of(*tables_, *data.kernel, triangles_);
}

}  // namespace fathom
