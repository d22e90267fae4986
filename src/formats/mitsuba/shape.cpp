// SPDX-License-Identifier: Apache-2.0
// Reading of meshes, groups and instances.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/common/texture_walk.h"
#include "formats/io/read_file.h"
#include "formats/io/text_scanner.h"
#include "formats/mesh/face_colors.h"
#include "formats/mesh/mesh_cleanup.h"
#include "formats/mesh/mesh_sides.h"
#include "formats/mesh/vertex_normals.h"
#include "formats/mitsuba/reader.h"
#include "formats/mitsuba/sdf_grid.h"
#include "formats/ply/ply.h"

namespace fathom::mitsuba {

namespace {

constexpr std::size_t max_nodes = 20'000'000;

}  // namespace

int Reader::add_node(Node node)
{
    scene_.nodes.push_back(std::move(node));
    return int(scene_.nodes.size()) - 1;
}

Shape Reader::add_mesh(Mesh mesh)
{
    scene_.meshes.push_back(std::move(mesh));
    return {MeshInstance{int(scene_.meshes.size()) - 1}, -1, {}};
}

void Reader::read_shape(const Element& element, std::vector<int>& roots)
{
    Object shape(element, document_);
    if (shape.type() == "shapegroup") return;  // a group itself is invisible; only its instances are visible
    if (!open_shapes_.insert(&element).second) element.fail("a shape can't contain itself");
    struct Close {
        std::set<const Element*>& open;
        const Element* element;
        ~Close() { open.erase(element); }
    } const close{open_shapes_, &element};
    // Nested references can turn a short file into many shapes.
    if (scene_.nodes.size() > max_nodes) element.fail(fmt::format("more than {} shapes", max_nodes));
    Node node;
    node.name = element.attribute("id");
    if (shape.type() == "instance" || shape.type() == "merge") {
        node.parent_from_node = shape.transform("to_world");
        if (shape.type() == "merge") {
            for (const Element* nested : shape.children("shape")) read_shape(*nested, node.children);
        } else {
            for (const Element* group : shape.children("shape")) {
                if (group->type() != "shapegroup") group->fail("an instance must refer to a 'shapegroup'");
                Object members(*group, document_);
                read_group(members, node.children);
            }
        }
        shape.finish(context_.warnings);
        roots.push_back(add_node(std::move(node)));
        return;
    }
    node.parent_from_node = shape.transform("to_world");
    const int material = material_of_shape(shape);
    std::optional<Shape> geometry = read_geometry(shape, node);
    shape.ignore({"silhouette_sampling_weight"});
    shape.finish(context_.warnings);
    if (geometry) {
        geometry->material = material;
        geometry->name = node.name;
        node.shapes.push_back(*std::move(geometry));
    }
    for (int child : node.children)
        for (Shape& s : scene_.nodes[std::size_t(child)].shapes) s.material = material;
    for (const Element* emitter : shape.children("emitter"))
        if (emitter->type() == "directionalarea") add_beam(*emitter, shape, node);
    if (!node.shapes.empty() || !node.children.empty()) roots.push_back(add_node(std::move(node)));
}

void Reader::read_group(Object& group, std::vector<int>& roots)
{
    const auto [found, is_new] = groups_.emplace(&group.element(), std::vector<int>());
    if (is_new) {
        std::vector<int> members;
        for (const Element* nested : group.children("shape")) {
            if (nested->type() == "instance" || nested->type() == "shapegroup")
                nested->fail("shape groups can't contain instances");
            read_shape(*nested, members);
        }
        group.finish(context_.warnings);
        groups_[&group.element()] = members;
    }
    const std::vector<int>& members = groups_[&group.element()];
    roots.insert(roots.end(), members.begin(), members.end());
}

std::optional<Shape> Reader::read_geometry(Object& shape, Node& node)
{
    const std::string& type = shape.type();
    if (type == "obj") return model(shape, node);
    if (type == "ply") return ply(shape);
    if (type == "serialized") return serialized(shape);
    if (type == "sdfgrid") return sdf_grid(shape);
    if (type == "rectangle") return rectangle(shape);
    if (type == "cylinder") return cylinder(shape, node);
    if (type == "bsplinecurve" || type == "linearcurve") return curves(shape);
    if (type == "sphere") return sphere(shape, node);
    if (type == "disk") return disk(shape);
    if (type == "cube") return cube(shape);
    report(shape.element(), "is not supported and is ignored");
    return std::nullopt;
}

std::filesystem::path Reader::file_of(Object& shape)
{
    const std::string filename = shape.text("filename", "");
    if (filename.empty()) shape.element().fail(fmt::format("{} needs a 'filename'", shape.title()));
    return document_.locate(filename, context_);
}

Mesh Reader::finished(Mesh mesh, Object& shape, bool flip_v)
{
    if (flip_v)
        for (Vec2f& uv : mesh.uvs[0]) uv.y = 1 - uv.y;
    const bool is_faceted = shape.boolean("face_normals", false), has_normals = !is_faceted && !mesh.normals.empty();
    if (is_faceted)
        mesh.normals.clear();
    else if (has_normals)
        orient_to_normals(mesh);
    else
        set_vertex_normals(mesh, NormalWeight::angle);
    // A mesh without normals faces the side from which its corners are counterclockwise in world space, whatever its
    // transform.
    const bool is_turned = !has_normals && mirrors(shape);
    if (shape.boolean("flip_normals", false) != is_turned) flip(mesh);
    return mesh;
}

namespace {

/// Key of the options that distinguish meshes of one file.
std::string variant_of(Object& shape, bool flip_v)
{
    return fmt::format("{}{}{}{}", int(flip_v), int(shape.boolean("face_normals", false)),
                       int(shape.boolean("flip_normals", false)), int(mirrors(shape)));
}

}  // namespace

std::optional<Shape> Reader::model(Object& shape, Node& node)
{
    const std::filesystem::path file = file_of(shape);
    // Fathom's reader flips v, as Mitsuba does by default.
    const bool flip_v = !shape.boolean("flip_tex_coords", true);
    const std::string key = file.string() + '\n' + variant_of(shape, flip_v);
    auto found = models_.find(key);
    if (found == models_.end()) {
        SceneDescription model;
        try {
            model = load_file(file, {}, context_);
        } catch (const Error& error) {
            shape.element().fail(error.what());
        }
        for (Mesh& mesh : model.meshes) mesh = finished(std::move(mesh), shape, flip_v);
        // Mitsuba ignores the materials of the file.
        model.materials.clear();
        for (Node& n : model.nodes)
            for (Shape& s : n.shapes) s.material = -1;
        found = models_.emplace(key, append_scene(scene_, std::move(model))).first;
    }
    const Appended copy = copy_nodes(scene_, found->second);
    node.children = copy.roots;
    return std::nullopt;
}

std::string Reader::attribute_of(Object& shape)
{
    std::string name;
    for_each_reached(scene_, scene_.materials[std::size_t(material_of_shape(shape))], [&](int texture) {
        const auto found = attributes_.find(texture);
        if (found == attributes_.end() || found->second == name) return;
        if (name.empty())
            name = found->second;
        else
            report(shape.element(),
                   fmt::format("only one attribute of a mesh is supported: '{}' is used", printable(name)));
    });
    return name;
}

Mesh Reader::ply_mesh(Object& shape, const std::string& file, const std::string& attribute)
{
    constexpr std::string_view of_vertices = "vertex_", of_faces = "face_";
    PlyAttribute colors;
    colors.of_faces = attribute.starts_with(of_faces);
    if (!attribute.empty()) colors.name = attribute.substr((colors.of_faces ? of_faces : of_vertices).size());
    InputFile input = context_.open(file);
    PlyData data = read_ply_data(input, colors);
    if (data.mesh.indices.empty()) throw Error(file, "", "it contains no triangles");
    context_.warnings.add(file + ": faces with fewer than three vertices are ignored", data.bad_faces);
    // Fathom's reader flips v; Mitsuba doesn't by default.
    Mesh mesh = finished(std::move(data.mesh), shape, !shape.boolean("flip_tex_coords", false));
    if (colors.of_faces && !data.face_colors.empty()) set_face_colors(mesh, data.face_colors);
    if (!attribute.empty() && mesh.colors.empty())
        report(shape.element(), fmt::format("the mesh has no '{}': white is used", printable(attribute)));
    mesh.name = std::filesystem::path(file).stem().string();
    return mesh;
}

template <class Read>
Shape Reader::mesh_of_file(Object& shape, const std::string& file, const std::string& variant, const Read& read)
{
    const Key key{nullptr, file + '\n' + variant};
    if (const auto known = meshes_.find(key); known != meshes_.end()) return {MeshInstance{known->second}, -1, {}};
    try {
        Mesh mesh = read();
        clean_mesh(mesh, file, context_.mesh_faults);
        meshes_[key] = int(scene_.meshes.size());
        return add_mesh(std::move(mesh));
    } catch (const Error& error) {
        if (error.file() == *shape.element().place.file) throw;
        shape.element().fail(error.what());
    }
}

std::optional<Shape> Reader::ply(Object& shape)
{
    const std::string file = file_of(shape).string(), attribute = attribute_of(shape);
    const std::string variant = variant_of(shape, shape.boolean("flip_tex_coords", false)) + attribute;
    return mesh_of_file(shape, file, variant, [&] { return ply_mesh(shape, file, attribute); });
}

std::optional<Shape> Reader::serialized(Object& shape)
{
    const int index = shape.integer("shape_index", 0);
    const bool flip_v = shape.boolean("flip_tex_coords", false);
    const std::string file = file_of(shape).string();
    return mesh_of_file(shape, file, fmt::format("{}\n{}", index, variant_of(shape, flip_v)), [&] {
        auto found = serialized_.find(file);
        if (found == serialized_.end())
            found = serialized_.emplace(file, SerializedFile(file, context_.read(file))).first;
        if (index < 0 || std::size_t(index) >= found->second.count())
            shape.element().fail(
                fmt::format("there is no mesh {} in '{}': it has {}", index, file, found->second.count()));
        return finished(found->second.mesh(std::size_t(index)), shape, flip_v);
    });
}

std::optional<Shape> Reader::sdf_grid(Object& shape)
{
    const std::string file = file_of(shape).string(), normals = shape.text("normals", "smooth");
    if (normals != "smooth" && normals != "analytic")
        shape.element().fail(fmt::format("normals must be 'smooth' or 'analytic', found '{}'", printable(normals)));
    return mesh_of_file(shape, file, normals, [&] {
        Mesh mesh = sdf_mesh(file, context_.read(file), normals == "smooth");
        mesh.name = shape.text("filename", "");
        return mesh;
    });
}

std::optional<Shape> Reader::curves(Object& shape)
{
    const std::string file = file_of(shape).string(), text = context_.read(file);
    Curves curves;
    curves.name = shape.text("filename", "");
    curves.basis = shape.type() == "linearcurve" ? CurveBasis::linear : CurveBasis::bspline;
    const std::uint32_t least = curves.basis == CurveBasis::linear ? 2 : 4;
    TextScanner scan(file, text);
    std::uint32_t points = 0;
    const auto end_curve = [&] {
        if (points > 0 && points < least)
            scan.fail(fmt::format("a curve has {} points, but needs at least {}", points, least));
        if (points > 0) curves.counts.push_back(std::exchange(points, 0));
    };
    for (; !scan.at_end(); scan.next_line()) {
        const std::string_view first = scan.word();
        if (first.empty()) {
            end_curve();
            continue;
        }
        const float x = scan.to_number(first), y = scan.number(), z = scan.number();
        curves.points.push_back({x, y, z});
        curves.radii.push_back(scan.number());
        ++points;
    }
    end_curve();
    if (curves.counts.empty()) scan.fail("it contains no curves");
    scene_.curves.push_back(std::move(curves));
    return Shape{CurvesInstance{int(scene_.curves.size()) - 1}, -1, {}};
}

}  // namespace fathom::mitsuba
