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
void check_memory(const SceneDescription& scene, const Occurrences& occurrences)
{
    // An index and a number each, and what the tree takes for a triangle while it is built.
    constexpr double bytes_per_triangle = 16 + 3 * 64;
    double bytes = bytes_per_occurrence * double(occurrences.shapes.size());
    std::vector<bool> counted(scene.meshes.size());
    for (const ShapeOccurrence& p : occurrences.shapes) {
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
    auto data = std::make_shared<Data>();
    data->camera = world_camera(description, camera);

    auto tables = std::make_shared<SceneTables>();
    check_camera(description, data->camera);
    Compiler compiler{description, make_render_space(description, data->camera), *tables, warnings};
    tables->origin = compiler.space.origin;
    tables->render_scale = compiler.space.scale;
    tables->shutter_open = float(data->camera.shutter_open);
    tables->shutter_close = float(data->camera.shutter_close);
    check_camera(description, data->camera, compiler.space);
    compile_materials(compiler);
    const Occurrences occurrences = find_occurrences(compiler);
    check_occurrences(compiler, occurrences);
    check_memory(description, occurrences);
    compile_geometry(compiler, occurrences);
    compile_lights(compiler, occurrences.lights);

    data->fingerprint = fathom::fingerprint(*tables);
    data->tables = tables;
    data->kernel = make_kernel_scene(tables, build);
    data->statistics = statistics_of(*tables, *data->kernel);
    data->statistics.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    Scene scene;
    scene.data_ = std::move(data);
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
std::uint64_t Scene::fingerprint() const
{
    return data_->fingerprint;
}

CameraRecord Scene::Data::camera_record(const Camera& seen_by, int width, int height) const
{
    const double scale = tables->render_scale;
    CameraRecord t;
    const Vec3d forward = normalize(seen_by.look_at - seen_by.position);
    Vec3d right = cross(forward, seen_by.up);
    // Looking along `up`: any other direction will do.
    if (length(right) < 1e-9 * length(seen_by.up))
        right = cross(forward, std::abs(forward.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1});
    right = normalize(right);
    put(t.position, (seen_by.position - tables->origin) * scale);
    put(t.right, right), put(t.up, cross(right, forward)), put(t.forward, forward);
    t.orthographic = seen_by.kind == CameraKind::orthographic;
    const double half_height = t.orthographic ? seen_by.height / 2 * scale : std::tan(seen_by.fov_y / 2);
    t.half_height = float(half_height);
    t.half_width = float(half_height * width / height);
    t.lens_radius = float(seen_by.aperture / 2 * scale);
    const double focus =
        seen_by.focus_distance > 0 ? seen_by.focus_distance : length(seen_by.look_at - seen_by.position);
    t.focus_distance = float(focus * scale);
    t.shutter_open = float(seen_by.shutter_open);
    t.shutter_close = float(seen_by.shutter_close);
    return t;
}

std::string Scene::Data::key(const CameraRecord& seen_by) const
{
    Fingerprint f;
    f.add(&seen_by, sizeof seen_by);
    return fmt::format("{:016x}{:016x}", fingerprint, f.value());
}

}  // namespace fathom
