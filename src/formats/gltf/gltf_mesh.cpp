// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

#include "formats/gltf/gltf_reader.h"
#include "formats/io/read_file.h"
#include "formats/mesh/mesh_cleanup.h"
#include "formats/mesh/point_cloud.h"
#include "scene/deform.h"

namespace fathom {

namespace {

enum Mode { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

/// Converts strips and fans to triangles. Degenerate triangles, which join strips, are removed.
std::vector<std::uint32_t> as_triangles(std::vector<std::uint32_t> corners, int mode)
{
    if (mode == triangles) return corners;
    std::vector<std::uint32_t> result;
    result.reserve(3 * corners.size());
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        std::uint32_t a = corners[i], b = corners[i + 1], c = corners[i + 2];
        if (mode == triangle_fan) a = corners[0];
        if (mode == triangle_strip && i % 2 == 1) std::swap(b, c);
        if (a != b && b != c && c != a) result.insert(result.end(), {a, b, c});
    }
    return result;
}

template <class T>
std::vector<T> read_vectors(const Accessor& accessor, std::size_t first, std::size_t count, int components, float fill)
{
    std::vector<T> result(count);
    accessor.read(first, count, components, fill, &result.data()->x);
    return result;
}

/// Cleans a rest mesh but keeps all triangles: a degenerate one may have an area in another pose.
void clean_rest(Mesh& mesh)
{
    MeshFaults told_already;
    std::vector<std::uint32_t> indices = mesh.indices;
    clean_mesh(mesh, "", told_already);
    mesh.indices = std::move(indices);
}

}  // namespace

const std::vector<GltfReader::Part>& GltfReader::mesh(const JsonValue& index, const std::optional<JsonValue>& weights,
                                                      std::size_t node)
{
    constexpr auto no_node = std::numeric_limits<std::size_t>::max();
    const bool has_own_pose = weights || (node < is_morphed_.size() && is_morphed_[node]);
    const auto [found, is_new] = meshes_.try_emplace({index.count(), has_own_pose ? node : no_node});
    if (!is_new) return found->second;
    const JsonValue v = file_.follow("meshes", index);
    const auto name = v.get("name");
    const auto primitives = v.get("primitives");
    if (!primitives) v.fail("key 'primitives' is missing");
    primitives->array();
    for (std::size_t i = 0; i < primitives->size(); ++i) {
        const JsonValue primitive = (*primitives)[i];
        primitive.object();
        read_primitive(primitive, name ? printable(name->string()) : "", weights ? weights : v.get("weights"),
                       found->second);
    }
    return found->second;
}

std::vector<std::uint32_t> GltfReader::read_corners(const JsonValue& primitive, std::size_t vertices, int mode)
{
    std::vector<std::uint32_t> corners;
    if (const auto index = primitive.get("indices")) {
        const Accessor accessor(file_, *index);
        corners = accessor.read_indices();
        const std::uint32_t largest = *std::max_element(corners.begin(), corners.end());
        if (largest >= vertices)
            accessor.fail(fmt::format("index {} is out of range: there are {} vertices", largest, vertices));
    } else {
        if (vertices > std::numeric_limits<std::uint32_t>::max()) primitive.fail("there are more than 2^32 vertices");
        corners.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i) corners[i] = std::uint32_t(i);
    }
    const std::size_t whole = mode == triangles ? 3 : mode == lines ? 2 : 1;
    if (const std::size_t rest = corners.size() % whole) {
        file_.warn(whole == 3 ? "indices that don't complete a triangle are ignored"
                              : "indices that don't complete a line are ignored",
                   rest);
        corners.resize(corners.size() - rest);
    }
    return mode < triangles ? corners : as_triangles(std::move(corners), mode);
}

/// mesh  its indices are those of the points, or of the ends of lines
void GltfReader::add_points_or_lines(const Mesh& mesh, int mode, Part part, std::vector<Part>& parts)
{
    if (!mesh.colors.empty()) file_.warn("vertex colors of points and lines are not supported and are ignored");
    if (!part.joints.empty()) file_.warn("skins of points and lines are not supported: the rest pose is used");
    part.joints.clear();
    std::vector<Vec3f> ends;
    ends.reserve(mesh.indices.size());
    for (const std::uint32_t index : mesh.indices) ends.push_back(mesh.positions[index]);
    if (mode == points) {
        Points cloud = fitting_points(std::move(ends), file_.name(), file_.warnings());
        if (cloud.centers.empty()) return;
        cloud.name = mesh.name;
        part.shape.geometry = PointsInstance{int(scene_.points.size())};
        scene_.points.push_back(std::move(cloud));
    } else {
        if (mode == line_loop) ends.push_back(ends.front());
        std::vector<std::uint32_t> counts{std::uint32_t(ends.size())};
        if (mode == lines) counts.assign(ends.size() / 2, 2);
        Curves curves = fitting_lines(ends, counts, file_.name(), file_.warnings());
        if (curves.counts.empty()) return;
        curves.name = mesh.name;
        part.shape.geometry = CurvesInstance{int(scene_.curves.size())};
        scene_.curves.push_back(std::move(curves));
    }
    parts.push_back(std::move(part));
}

void GltfReader::read_attributes(const JsonValue& attributes, std::size_t first, Mesh& mesh, Part& part)
{
    const std::size_t vertices = mesh.positions.size();
    const auto open = [&](const char* name, int least, int most) -> std::optional<Accessor> {
        const auto index = attributes.get(name);
        if (!index) return std::nullopt;
        Accessor accessor(file_, *index);
        if (accessor.components() < least || accessor.components() > most)
            accessor.fail(fmt::format("{} with {} components", name, accessor.components()));
        if (accessor.count() < first + vertices)
            accessor.fail(fmt::format("has {} elements, fewer than the positions", accessor.count()));
        return accessor;
    };
    if (const auto a = open("NORMAL", 3, 3)) mesh.normals = read_vectors<Vec3f>(*a, first, vertices, 3, 0);
    if (const auto a = open("TANGENT", 4, 4)) mesh.tangents = read_vectors<Vec4f>(*a, first, vertices, 4, 0);
    if (const auto a = open("TEXCOORD_0", 2, 2)) mesh.uvs[0] = read_vectors<Vec2f>(*a, first, vertices, 2, 0);
    if (const auto a = open("TEXCOORD_1", 2, 2)) mesh.uvs[1] = read_vectors<Vec2f>(*a, first, vertices, 2, 0);
    if (const auto a = open("COLOR_0", 3, 4)) mesh.colors = read_vectors<Vec4f>(*a, first, vertices, 4, 1);
    // Each set adds four joints to each vertex.
    constexpr std::size_t max_sets = 8;
    std::size_t sets = 0;
    while (sets < max_sets && attributes.has(fmt::format("JOINTS_{}", sets)) &&
           attributes.has(fmt::format("WEIGHTS_{}", sets)))
        ++sets;
    if (sets == 0) return;
    file_.check_memory(attributes, 24.0 * double(sets + 1) * double(vertices));
    part.joints.resize(4 * sets * vertices);
    part.weights.resize(4 * sets * vertices);
    std::vector<float> numbers(4 * vertices);
    for (std::size_t set = 0; set < sets; ++set) {
        const auto each = [&](const std::string& name, const auto& put) {
            open(name.c_str(), 4, 4)->read(first, vertices, 4, 0, numbers.data());
            for (std::size_t i = 0; i < numbers.size(); ++i) put(4 * (i / 4 * sets + set) + i % 4, numbers[i]);
        };
        each(fmt::format("JOINTS_{}", set),
             [&](std::size_t i, float joint) { part.joints[i] = std::uint16_t(std::clamp(joint, 0.0f, 65535.0f)); });
        each(fmt::format("WEIGHTS_{}", set), [&](std::size_t i, float weight) { part.weights[i] = weight; });
    }
}

/// mesh  the mesh whose vertices the target moves
MorphTarget GltfReader::read_morph_target(const JsonValue& target, std::size_t first, const Mesh& mesh)
{
    const std::size_t vertices = mesh.positions.size();
    const auto read = [&](const char* name, int components, bool wanted, auto& to) {
        const auto index = wanted ? target.get(name) : std::nullopt;
        if (!index) return;
        const Accessor accessor(file_, *index);
        if (accessor.components() != components && !(components == 4 && accessor.components() == 3))
            accessor.fail(fmt::format("a morph target's {} with {} components", name, accessor.components()));
        if (accessor.count() < first + vertices) accessor.fail("has fewer elements than the mesh has vertices");
        to.resize(vertices);
        accessor.read(first, vertices, components, 0, &to.data()->x);
    };
    MorphTarget result;
    read("POSITION", 3, true, result.positions);
    read("NORMAL", 3, !mesh.normals.empty(), result.normals);
    read("TANGENT", 3, !mesh.tangents.empty(), result.tangents);
    read("COLOR_0", 4, !mesh.colors.empty(), result.colors);
    read("TEXCOORD_0", 2, !mesh.uvs[0].empty(), result.uvs[0]);
    read("TEXCOORD_1", 2, !mesh.uvs[1].empty(), result.uvs[1]);
    return result;
}

/// weights  weights at rest; by default 0 for all targets
void GltfReader::add_morphs(const JsonValue& primitive, const std::optional<JsonValue>& weights, std::size_t first,
                            Mesh& mesh, Part& part)
{
    const auto targets = primitive.get("targets");
    if (!targets) return;
    targets->array();
    std::size_t count = 0;
    if (weights) {
        count = std::min(targets->size(), weights->array().size());
        for (std::size_t i = 0; i < count; ++i) part.target_weights.push_back((*weights)[i].single());
    }
    const bool plays = !rig_.animations.empty();
    file_.check_memory(primitive, 72.0 * double(plays ? targets->size() : 1) * double(mesh.positions.size()));
    // Targets are read one by one, because only animated meshes keep those without weight.
    for (std::size_t i = 0; i < (plays ? targets->size() : count); ++i) {
        const float weight = i < count ? part.target_weights[i] : 0;
        if (weight == 0 && !plays) continue;
        std::vector<MorphTarget> target{read_morph_target((*targets)[i], first, mesh)};
        apply_morph_targets(mesh, target, std::span(&weight, 1));
        if (plays) part.targets.push_back(std::move(target[0]));
    }
}

std::optional<Accessor> GltfReader::read_positions(const JsonValue& primitive)
{
    const auto attributes = primitive.get("attributes");
    if (!attributes) primitive.fail("key 'attributes' is missing");
    attributes->object();
    const auto index = attributes->get("POSITION");
    if (!index) {
        file_.warn("primitives without positions are ignored");
        return std::nullopt;
    }
    if (const auto extensions = primitive.get("extensions"))
        if (extensions->has("KHR_draco_mesh_compression") && !file_.follow("accessors", *index).has("bufferView"))
            file_.add_decoded(decode_draco(file_, primitive));
    Accessor positions(file_, *index);
    if (positions.components() != 3) positions.fail("positions must be VEC3");
    const auto indices = primitive.get("indices");
    const auto index_count = indices ? Accessor(file_, *indices).count() : 0;
    file_.check_memory(primitive, 36.0 * double(positions.count()) + 12.0 * double(index_count));
    return positions;
}

namespace {

int primitive_mode(const JsonValue& primitive)
{
    const int mode = primitive.has("mode") ? primitive["mode"].integer() : triangles;
    if (mode < points || mode > triangle_fan) primitive["mode"].fail(fmt::format("{} is not a primitive mode", mode));
    return mode;
}

struct VertexRange {
    std::size_t first, count;
};

/// Makes the indices relative to the least one. Many files have one accessor for the vertices of all primitives; only
/// the range that a primitive uses is read.
VertexRange rebase(std::vector<std::uint32_t>& indices)
{
    const auto [least, most] = std::minmax_element(indices.begin(), indices.end());
    const VertexRange range{*least, std::size_t(*most) - *least + 1};
    if (range.first > 0)
        for (std::uint32_t& index : indices) index -= std::uint32_t(range.first);
    return range;
}

}  // namespace

void GltfReader::read_primitive(const JsonValue& primitive, const std::string& name,
                                const std::optional<JsonValue>& weights, std::vector<Part>& parts)
{
    const std::optional<Accessor> positions = read_positions(primitive);
    if (!positions) return;
    const int mode = primitive_mode(primitive);
    Mesh mesh;
    mesh.indices = read_corners(primitive, positions->count(), mode);
    if (mesh.indices.empty()) return;
    const VertexRange vertices = rebase(mesh.indices);

    Part part;
    mesh.name = name;
    mesh.positions = read_vectors<Vec3f>(*positions, vertices.first, vertices.count, 3, 0);
    read_attributes(primitive["attributes"], vertices.first, mesh, part);
    const bool moves =
        mode >= triangles && !rig_.animations.empty() && (!part.joints.empty() || primitive.has("targets"));
    if (moves) part.rest = mesh;
    add_morphs(primitive, weights, vertices.first, mesh, part);
    part.shape.name = mesh.name;
    if (mode < triangles) {
        part.shape.material = material(primitive, false);
        return add_points_or_lines(mesh, mode, std::move(part), parts);
    }
    clean_mesh(mesh, file_.name(), file_.mesh_faults());
    if (moves) clean_rest(part.rest);
    if (mesh.indices.empty() && !moves) return;

    part.shape.material = material(primitive, !mesh.colors.empty());
    part.shape.geometry = MeshInstance{int(scene_.meshes.size())};
    scene_.meshes.push_back(std::move(mesh));
    parts.push_back(std::move(part));
}

}  // namespace fathom
