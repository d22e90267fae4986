// SPDX-License-Identifier: Apache-2.0
#include "presentation/ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/environment/studio.h"

namespace fathom {

namespace {

/// Radiance of an unoccluded white floor in the studio: the cosine-weighted mean of the studio's radiance. It does not
/// depend on the studio's rotation.
double radiance_of_white_floor()
{
    constexpr int rows = 128, columns = 256;
    double sum = 0;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            // Directions uniform in the squared cosine are distributed in proportion to the cosine.
            const double cosine = std::sqrt((i + 0.5) / rows), sine = std::sqrt(1 - cosine * cosine);
            const double phi = 2 * std::numbers::pi * (j + 0.5) / columns;
            sum += studio_radiance({sine * std::cos(phi), cosine, sine * std::sin(phi)});
        }
    return sum / (rows * columns);
}

/// A disk of radius 1 facing up: opaque up to radius `opaque`, then fading to transparent.
Mesh fading_disk(double opaque)
{
    constexpr std::uint32_t rings = 16, around = 96;
    Mesh mesh;
    mesh.name = "ground";
    const auto add = [&](double radius, double angle, double alpha) {
        mesh.positions.push_back({float(radius * std::cos(angle)), 0, float(radius * std::sin(angle))});
        mesh.colors.push_back({1, 1, 1, float(alpha)});
    };
    add(0, 0, 1);
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        const double x = double(ring) / (rings - 1), alpha = 1 - x * x * (3 - 2 * x);
        for (std::uint32_t i = 0; i < around; ++i)
            add(opaque + (1 - opaque) * x, 2 * std::numbers::pi * i / around, alpha);
    }
    for (std::uint32_t i = 0; i < around; ++i) {
        const std::uint32_t next = (i + 1) % around;
        mesh.indices.insert(mesh.indices.end(), {0, 1 + next, 1 + i});
        for (std::uint32_t inner = 1; inner + around < mesh.positions.size(); inner += around) {
            const std::uint32_t outer = inner + around;
            mesh.indices.insert(mesh.indices.end(), {inner + i, inner + next, outer + i});
            mesh.indices.insert(mesh.indices.end(), {inner + next, outer + next, outer + i});
        }
    }
    return mesh;
}

Material material_of(const Ground& ground, bool studio)
{
    Material material;
    material.name = "ground";
    material.use_vertex_color = true;
    material.opacity.mode = AlphaMode::blend;
    // The ground is invisible from below, so that cameras below it see the model.
    material.visibility.camera_backface_culling = true;
    constexpr float gray = 0.5f;
    material.base_color.value = ground.color.value_or(Color{gray, gray, gray});
    if (ground.color || !studio) return material;
    // No floor reflects enough to match a white backdrop, so emission provides the rest.
    constexpr double most = 0.8;
    const double white = radiance_of_white_floor();
    const auto reflected = [&](float tone) { return float(std::min(tone / white, most)); };
    const auto emitted = [&](float tone) { return float(std::max(tone - most * white, 0.0)); };
    const Color& tone = ground.backdrop;
    material.base_color.value = {reflected(tone.r), reflected(tone.g), reflected(tone.b)};
    material.emission.radiance.value = {emitted(tone.r), emitted(tone.g), emitted(tone.b)};
    return material;
}

double height_of_ground(const Bounds& model)
{
    // The ground is slightly below the model, to avoid coincident surfaces.
    return model.min.y - 1e-4 * length(model.max - model.min);
}

}  // namespace

bool ground_fits(const Bounds& model, const Camera& camera)
{
    const Vec3d &p = camera.position, &low = model.min, &high = model.max;
    const bool inside = p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z > low.z && p.z < high.z;
    return !inside && p.y > height_of_ground(model);
}

void add_ground(SceneDescription& scene, const Ground& ground, const Bounds& model, bool studio)
{
    const Vec3d size = model.max - model.min, middle = (model.min + model.max) * 0.5;
    // The key light is about 35 degrees high, so shadows are 1.5 times as long as objects are high.
    const double shadowed = std::hypot(size.x, size.z) / 2 + 1.5 * size.y, radius = 2 * shadowed;
    if (!(radius > 0)) return;
    Node node;
    node.name = "ground";
    node.parent_from_node = Transform::translate({middle.x, height_of_ground(model), middle.z}) *
                            Transform::scale({radius, radius, radius});
    node.shapes.push_back({MeshInstance{int(scene.meshes.size())}, int(scene.materials.size()), "ground"});
    scene.meshes.push_back(fading_disk(shadowed / radius));
    scene.materials.push_back(material_of(ground, studio));
    scene.roots.push_back(int(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
}

}  // namespace fathom
