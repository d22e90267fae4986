// SPDX-License-Identifier: Apache-2.0
#include "compile/memory_estimate.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "image/picture.h"
#include "lights/compile/light_pictures.h"
#include "materials/closures/measured_tables.h"
#include "scene/check.h"

namespace fathom {

namespace {

// Peak bytes, as measured plus a margin (bench/memory.py).
constexpr double bytes_per_light = 700;       // record and light tree, both while they grow
constexpr double bytes_per_segment = 1100;    // curve segment: at most 32 BVH primitives, about four on average
constexpr double bytes_per_point = 370;       // sphere of a point cloud
constexpr double bytes_while_moving = 96;     // triangle: boxes at both ends of a time interval
constexpr double bytes_per_environment = 28;  // texel: four floats and the sampling distribution

constexpr double bytes_per_light_texel = 32;  // four floats, temporarily stored twice

/// Bytes that BVH construction takes per triangle.
double tree_bytes(BvhQuality build)
{
    switch (build) {
        case BvhQuality::fast:
            return 120;
        case BvhQuality::standard:
            return 135;
        case BvhQuality::compact:
            return 190;
        case BvhQuality::high:
            break;
    }
    return 220;
}

bool emits(const SceneDescription& scene, const Shape& shape)
{
    if (shape.material < 0) return false;
    const Material& material = scene.materials[std::size_t(shape.material)];
    const Color& c = material.emission.radiance.value;
    return material.kind != MaterialKind::unlit && std::max({c.r, c.g, c.b}) > 0;
}

/// Number of occurrences of each node under the roots.
class Places {
public:
    explicit Places(const SceneDescription& scene)
        : scene_(scene), seen_(scene.nodes.size()), places_(scene.nodes.size())
    {
        for (const int root : scene.roots) visit(root);
        for (const int root : scene.roots) places_[std::size_t(root)] += 1;
        // `order_` has children before their parents.
        for (auto node = order_.rbegin(); node != order_.rend(); ++node)
            for (const int child : scene_.nodes[std::size_t(*node)].children)
                places_[std::size_t(child)] += places_[std::size_t(*node)];
    }
    double of(std::size_t node) const { return places_[node]; }

private:
    /// check_scene bounds the depth of recursion.
    void visit(int node)
    {
        if (seen_[std::size_t(node)]) return;
        seen_[std::size_t(node)] = true;
        for (const int child : scene_.nodes[std::size_t(node)].children) visit(child);
        order_.push_back(node);
    }

    const SceneDescription& scene_;
    std::vector<bool> seen_;
    std::vector<double> places_;
    std::vector<int> order_;
};

std::optional<PictureSize> size_of(const ImageFile& image)
{
    return image.bytes.empty() ? measure_picture(image.path)
                               : measure_picture(image.name, image.bytes.data(), image.bytes.size());
}

/// Bytes per texel in the tables, by the packing rules of textures/compile/images.cpp. Color images of more than 8 bits
/// stay floats, temporarily stored twice. Rarer cases are checked when an image is decoded.
double texel_bytes(const PictureSize& size, ColorSpace space)
{
    if (size.bytes_per_pixel == 4) return 4;
    return space == ColorSpace::srgb ? 32 : 8;
}

/// Estimates the memory of images.
class ImageMemory {
public:
    explicit ImageMemory(const SceneDescription& scene) : scene_(scene), sizes_(scene.images.size()) {}

    std::vector<MemoryEstimate> needs()
    {
        std::set<std::tuple<int, ColorSpace, float>> uses;
        double textures = 0, environment = 0;
        for (const Texture& t : scene_.textures) {
            if (t.kind != TextureKind::image || t.image < 0) continue;
            if (!uses.insert({t.image, t.color_space, t.height_scale}).second) continue;
            const PictureSize size = of(t.image);
            // Normal maps made from height maps have 16 bits.
            textures += size.pixels() * (t.height_scale != 0 ? 8 : texel_bytes(size, t.color_space));
        }
        const Environment& e = scene_.environment;
        if (e.kind == EnvironmentKind::image && e.image >= 0)
            environment += of(e.image).pixels() * bytes_per_environment;
        if (e.kind == EnvironmentKind::equal_area && e.image >= 0)
            environment += of(e.image).pixels() * 3 * bytes_per_environment;
        // A cube map is also resampled to an equirectangular image.
        if (e.kind == EnvironmentKind::cube)
            for (const int face : e.faces)
                if (face >= 0) environment += of(face).pixels() * 2 * bytes_per_environment;
        double lights = 0;
        std::set<std::pair<int, ColorSpace>> of_lights;
        for (const Light& l : scene_.lights)
            if (is_pictured(l) && l.picture.image >= 0 && !is_profile(scene_, l.picture.image) &&
                of_lights.insert({l.picture.image, l.picture.color_space}).second)
                lights += of(l.picture.image).pixels() * bytes_per_light_texel;
        return {{"textures", textures},
                {"environment", environment},
                {"images of lights", lights},
                {"decoding an image", largest_read_}};
    }

private:
    PictureSize of(int image)
    {
        std::optional<PictureSize>& size = sizes_[std::size_t(image)];
        if (size) return *size;
        const ImageFile& file = scene_.images[std::size_t(image)];
        size = size_of(file).value_or(PictureSize());
        std::error_code error;
        const double encoded =
            file.bytes.empty() && size->width > 0 ? double(std::filesystem::file_size(file.path, error)) : 0;
        largest_read_ = std::max(largest_read_, encoded + size->pixels() * double(size->bytes_per_pixel));
        return *size;
    }

    const SceneDescription& scene_;
    std::vector<std::optional<PictureSize>> sizes_;
    double largest_read_ = 0;
};

template <class T>
double bytes_of(const std::vector<T>& v)
{
    return double(v.size()) * sizeof(T);
}

}  // namespace

double ShapeMemory::triangle_bytes(const Mesh& mesh) const
{
    const double triangles = double(mesh.indices.size()) / 3, keys = double(1 + mesh.motion.size());
    return triangles * (16 + tree_bytes(build_) + (mesh.motion.empty() ? 0 : bytes_while_moving)) +
           (bytes_of(mesh.positions) + bytes_of(mesh.normals)) * keys + bytes_of(mesh.tangents) +
           bytes_of(mesh.colors) + bytes_of(mesh.uvs[0]) + bytes_of(mesh.uvs[1]);
}

/// Adds curves; returns the number of primitives per occurrence.
double ShapeMemory::add_curves(const Curves& curves)
{
    const double segments = double(curves.points.size());
    if (counted_.insert(&curves).second) curves_ += segments * bytes_per_segment * double(1 + curves.motion.size());
    return segments;
}

double ShapeMemory::add_points(const Points& points)
{
    const double balls = double(points.centers.size());
    if (counted_.insert(&points).second) points_ += balls * bytes_per_point;
    return balls;
}

void ShapeMemory::add(const Shape& shape, const Mesh* mesh, double places, bool is_light)
{
    double primitives = 6;  // primitives of a box, the most of any other kind of shape
    if (mesh)
        places_of_[mesh] += places, primitives = double(mesh->indices.size()) / 3;
    else if (const auto* c = std::get_if<CurvesInstance>(&shape.geometry))
        primitives = add_curves(scene_.curves[std::size_t(c->curves)]);
    else if (const auto* p = std::get_if<PointsInstance>(&shape.geometry))
        primitives = add_points(scene_.points[std::size_t(p->points)]);
    places_ += places;
    if (is_light) lights_ += primitives * places;
}

std::vector<MemoryEstimate> ShapeMemory::needs() const
{
    // A mesh with several occurrences is instanced, or, if it is small, copied.
    constexpr double fewest_of_instances = 4096;
    double triangles = 0;
    for (const auto& [mesh, places] : places_of_) {
        const bool is_copied = double(mesh->indices.size()) / 3 * places < fewest_of_instances;
        triangles += triangle_bytes(*mesh) * (is_copied ? places : 1);
    }
    return {{"triangles", triangles},
            {"curves", curves_},
            {"points", points_},
            {"shape instances", places_ * bytes_per_occurrence},
            {"lights", lights_ * bytes_per_light}};
}

std::vector<MemoryEstimate> estimate_memory(const SceneDescription& scene, BvhQuality build)
{
    check_scene(scene);
    const Places places(scene);
    ShapeMemory shapes(scene, build);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        if (places.of(i) == 0) continue;
        for (const Shape& shape : scene.nodes[i].shapes) {
            const auto* mesh = std::get_if<MeshInstance>(&shape.geometry);
            shapes.add(shape, mesh ? &scene.meshes[std::size_t(mesh->mesh)] : nullptr, places.of(i),
                       emits(scene, shape));
        }
    }
    std::vector<MemoryEstimate> needs = shapes.needs();
    for (MemoryEstimate& need : ImageMemory(scene).needs()) needs.push_back(std::move(need));
    double values = 0;
    for (const MeasuredBrdf& brdf : scene.measured) values += measured_value_count(brdf);
    if (values > 0) needs.push_back({"measured materials", values * sizeof(float)});
    return needs;
}

}  // namespace fathom
