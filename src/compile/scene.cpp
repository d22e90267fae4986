#include <fmt/format.h>
#include <chrono>
#include <cmath>
#include <cstring>

#include "compile/check_sizes.h"
#include "compile/compiler.h"
#include "compile/fingerprint.h"
#include "compile/scene_data.h"
#include "fathom/error.h"
#include "fathom/memory.h"
#include "scene/check.h"

namespace fathom {

namespace {

/// Around the camera, so that what is near it keeps its precision; scaled so that the scene's radius is 512 to 1024.
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
    if (radius > 0 && std::isfinite(radius)) space.scale = std::exp2(9 - std::floor(std::log2(radius)));
    return space;
}

SceneStatistics statistics_of(const SceneTables& tables, const KernelScene& kernel)
{
    SceneStatistics s;
    s.triangles = tables.world_triangles;
    std::vector<std::size_t> triangles(tables.shapes.size());
    for (std::uint32_t i = tables.world_triangles; i < tables.first_quad(); ++i)
        ++triangles[tables.shape_of_primitive[i]];
    for (const InstanceRecord& instance : tables.instances) s.triangles += triangles[instance.mesh_shape];
    s.primitives = tables.primitive_count();
    s.instances = tables.instances.size();
    s.lights = tables.lights.size();
    const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
    s.memory_bytes = bytes(tables.positions) + bytes(tables.normals) + bytes(tables.tangents) + bytes(tables.colors) +
                     bytes(tables.uv0) + bytes(tables.uv1) + bytes(tables.triangles) + bytes(tables.quads) +
                     bytes(tables.shape_of_primitive) + bytes(tables.shapes) + bytes(tables.instances) +
                     bytes(tables.curves) + bytes(tables.curve_points) + bytes(tables.points) + bytes(tables.poses) +
                     bytes(tables.texels) + bytes(tables.environment.texels) + bytes(tables.lights) +
                     kernel.memory_bytes();
    for (const auto& image : tables.packed_images) s.memory_bytes += bytes(image);
    return s;
}

/// Refuses a scene whose compiled form can't fit, before it is tried. Meshes placed more than once are counted once:
/// they become instances, or are small.
void check_memory(const SceneDescription& scene, const Placed& placed)
{
    // An index and a number each, and what the tree takes for a triangle while it is built.
    constexpr double bytes_per_triangle = 16 + 3 * 64;
    double bytes = bytes_per_placed_shape * double(placed.shapes.size());
    std::vector<bool> counted(scene.meshes.size());
    for (const PlacedShape& p : placed.shapes) {
        const auto* instance = std::get_if<MeshInstance>(&p.shape->geometry);
        if (!instance || counted[std::size_t(instance->mesh)]) continue;
        counted[std::size_t(instance->mesh)] = true;
        const Mesh& mesh = scene.meshes[std::size_t(instance->mesh)];
        bytes += bytes_per_triangle * double(mesh.indices.size()) / 3 +
                 12.0 * double(mesh.positions.size() + mesh.normals.size()) * double(1 + mesh.motion.size()) +
                 16.0 * double(mesh.tangents.size() + mesh.colors.size()) +
                 8.0 * double(mesh.uvs[0].size() + mesh.uvs[1].size());
    }
    if (const double available = double(available_memory_bytes()); bytes > available)
        throw Error(scene.file, "",
                    fmt::format("the scene needs about {:.1f} GB of memory, {:.1f} GB are there", bytes / 1e9,
                                available / 1e9));
}

void put(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}

}  // namespace

Scene Scene::compile(const SceneDescription& description, const std::string& camera, Warnings& warnings,
                     TreeBuild build)
{
    const auto start = std::chrono::steady_clock::now();
    check_scene(description);
    Scene scene;
    scene.data_ = std::make_shared<Data>();
    scene.data_->camera = world_camera(description, camera);

    auto tables = std::make_shared<SceneTables>();
    check_camera(description, scene.data_->camera);
    Compiler compiler{description, make_render_space(description, scene.data_->camera), *tables, warnings};
    tables->origin = compiler.space.origin;
    tables->render_scale = compiler.space.scale;
    tables->shutter_open = float(scene.data_->camera.shutter_open);
    tables->shutter_close = float(scene.data_->camera.shutter_close);
    check_camera(description, scene.data_->camera, compiler.space);
    compile_materials(compiler);
    const Placed placed = place(compiler);
    check_placed(compiler, placed);
    check_memory(description, placed);
    compile_geometry(compiler, placed);
    compile_lights(compiler, placed.lights);

    scene.data_->fingerprint = fingerprint(*tables);
    scene.data_->tables = tables;
    scene.data_->kernel = make_kernel_scene(tables, build);
    scene.data_->statistics = statistics_of(*tables, *scene.data_->kernel);
    scene.data_->statistics.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return scene;
}

const SceneStatistics& Scene::statistics() const
{
    return data_->statistics;
}
const Camera& Scene::camera() const
{
    return data_->camera;
}
void Scene::set_camera(const Camera& camera)
{
    data_->camera = camera;
}

CameraRecord Scene::Data::camera_table(int width, int height) const
{
    const double scale = tables->render_scale;
    CameraRecord t;
    const Vec3d forward = normalize(camera.look_at - camera.position);
    Vec3d right = cross(forward, camera.up);
    // Looking along `up`: any other direction will do.
    if (length(right) < 1e-9 * length(camera.up))
        right = cross(forward, std::abs(forward.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1});
    right = normalize(right);
    put(t.position, (camera.position - tables->origin) * scale);
    put(t.right, right), put(t.up, cross(right, forward)), put(t.forward, forward);
    t.orthographic = camera.kind == CameraKind::orthographic;
    const double half_height = t.orthographic ? camera.height / 2 * scale : std::tan(camera.fov_y / 2);
    t.half_height = float(half_height);
    t.half_width = float(half_height * width / height);
    t.lens_radius = float(camera.aperture / 2 * scale);
    const double focus = camera.focus_distance > 0 ? camera.focus_distance : length(camera.look_at - camera.position);
    t.focus_distance = float(focus * scale);
    t.shutter_open = float(camera.shutter_open);
    t.shutter_close = float(camera.shutter_close);
    return t;
}

std::string Scene::Data::key(int width, int height) const
{
    const CameraRecord table = camera_table(width, height);
    Fingerprint f;
    f.add(&table, sizeof table);
    return fmt::format("{:016x}{:016x}", fingerprint, f.value());
}

}  // namespace fathom
