// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bindings.h"
#include "commands/commands.h"
#include "fathom/save.h"
#include "options/render_words.h"
#include "scene.h"

namespace fathom::python {

namespace nb = nanobind;

namespace {

using Matrix = nb::ndarray<const double, nb::shape<4, 4>, nb::c_contig, nb::device::cpu>;
using FloatRows = Rows<float>;

Transform to_transform(const Matrix& matrix)
{
    Transform transform;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column) transform.m[row][column] = matrix(row, column);
    return transform;
}

nb::object to_matrix(const Transform& transform)
{
    std::vector<double> numbers;
    for (const auto& row : transform.m) numbers.insert(numbers.end(), row.begin(), row.end());
    for (const double value : {0.0, 0.0, 0.0, 1.0}) numbers.push_back(value);
    return to_array<double>(numbers, {4, 4});
}

/// Vertex data of add_mesh() as Python passes it; None where the mesh has none.
struct MeshArrays {
    FloatRows positions;
    Rows<std::uint32_t> indices;
    std::optional<FloatRows> normals, uvs, colors;
};

Mesh to_mesh(const MeshArrays& arrays, const std::string& name)
{
    Mesh mesh;
    mesh.name = name;
    mesh.positions = to_vector<Vec3f>(arrays.positions);
    mesh.indices.assign(arrays.indices.data(), arrays.indices.data() + arrays.indices.size());
    if (arrays.normals) mesh.normals = to_vector<Vec3f>(*arrays.normals);
    if (arrays.uvs) mesh.uvs[0] = to_vector<Vec2f>(*arrays.uvs);
    if (arrays.colors) mesh.colors = to_vector<Vec4f>(*arrays.colors);
    return mesh;
}

/// Adds the mesh and a node that places it; returns the index of the node.
int add_mesh(Scene& scene, const std::string& name, const MeshArrays& arrays, int material, const Matrix& transform)
{
    SceneDescription& description = scene.restructure();
    Node node;
    node.name = name;
    node.parent_from_node = to_transform(transform);
    node.shapes.push_back({MeshInstance{int(description.meshes.size())}, material, name});
    description.meshes.push_back(to_mesh(arrays, name));
    description.roots.push_back(int(description.nodes.size()));
    description.nodes.push_back(std::move(node));
    return description.roots.back();
}

/// Each mesh that a node places: node, index among its shapes, mesh, name.
std::vector<std::tuple<int, int, int, std::string>> placed_meshes(const Scene& scene)
{
    std::vector<std::tuple<int, int, int, std::string>> placed;
    const SceneDescription& description = scene.description();
    for (std::size_t n = 0; n < description.nodes.size(); ++n) {
        const Node& node = description.nodes[n];
        for (std::size_t s = 0; s < node.shapes.size(); ++s)
            if (const auto* mesh = std::get_if<MeshInstance>(&node.shapes[s].geometry)) {
                const std::string& own = description.meshes[std::size_t(mesh->mesh)].name;
                placed.emplace_back(int(n), int(s), mesh->mesh, own.empty() ? node.name : own);
            }
    }
    return placed;
}

/// Transforms to world space of all places of a node.
void add_places(const SceneDescription& scene, int at, const Transform& world_from_parent, int wanted, nb::list& places)
{
    const Node& node = scene.nodes[std::size_t(at)];
    const Transform world_from_node =
        world_from_parent * (node.motion.empty() ? node.parent_from_node : node.motion.front().parent_from_node);
    if (at == wanted) places.append(to_matrix(world_from_node));
    for (const int child : node.children) add_places(scene, child, world_from_node, wanted, places);
}

nb::list world_transforms(const Scene& scene, int node)
{
    nb::list places;
    const SceneDescription& description = scene.description();
    for (const int root : description.roots) add_places(description, root, {}, node, places);
    return places;
}

const Mesh& mesh_at(const Scene& scene, int mesh)
{
    return scene.description().meshes.at(std::size_t(mesh));
}
const Node& node_at(const Scene& scene, int node)
{
    return scene.description().nodes.at(std::size_t(node));
}

template <class Number, class T>
nb::object rows_or_none(const std::vector<T>& values)
{
    if (values.empty()) return nb::none();
    return to_array<Number>(values, {values.size(), sizeof(T) / sizeof(Number)});
}

std::vector<NodeKey> to_node_keys(const std::vector<std::pair<double, Matrix>>& keys)
{
    std::vector<NodeKey> result;
    for (const auto& [time, matrix] : keys) result.push_back({time, to_transform(matrix)});
    return result;
}

std::vector<MeshKey> to_mesh_keys(const std::vector<std::pair<double, FloatRows>>& keys)
{
    std::vector<MeshKey> result;
    for (const auto& [time, positions] : keys) result.push_back({time, to_vector<Vec3f>(positions), {}});
    return result;
}

nb::dict to_dict(const Warnings& warnings)
{
    nb::dict counts;
    for (const auto& [text, count] : warnings.counts()) counts[text.c_str()] = count;
    return counts;
}

/// Reads a file; `words` are options of `fathom render` that say how.
nb::tuple load(const std::filesystem::path& file, std::vector<std::string> words)
{
    Warnings warnings;
    std::unique_ptr<Scene> scene;
    {
        const nb::gil_scoped_release release;
        cli::RenderOptions options;
        words.push_back(file.string());
        cli::parse_render_words(words, options);
        scene = std::make_unique<Scene>(load_scene_file(file, cli::load_options(options.scene), warnings));
    }
    return nb::make_tuple(nb::cast(scene.release(), nb::rv_policy::take_ownership), to_dict(warnings));
}

nb::dict save(const Scene& scene, const std::filesystem::path& file)
{
    Warnings warnings;
    {
        const nb::gil_scoped_release release;
        file.extension() == ".glb" ? save_glb(scene.description(), file, warnings)
                                   : save_scene(scene.description(), file, warnings);
    }
    return to_dict(warnings);
}

std::vector<std::byte> to_bytes(const nb::bytes& bytes)
{
    const auto* begin = static_cast<const std::byte*>(bytes.data());
    return {begin, begin + bytes.size()};
}

/// Replaces image files by their contents, so that the scene doesn't depend on them; read(path) returns bytes.
void embed_images(Scene& scene, const nb::callable& read)
{
    for (ImageFile& image : scene.builder.edit_scene().images) {
        // IES files are recognized by the name of the file.
        if (image.path.empty() || image.path.extension() == ".ies") continue;
        image.bytes = to_bytes(nb::cast<nb::bytes>(read(image.path)));
        image.name = image.path.filename().string();
        image.path.clear();
    }
}

/// A function of a changing scene, which fails while the scene is rendered.
template <class Result, class... Arguments>
auto when_idle(Result (Scene::*change)(Arguments...))
{
    return [change](Scene& scene, Arguments... arguments) {
        const BusyScene busy(scene);
        return (scene.*change)(std::forward<Arguments>(arguments)...);
    };
}

void bind_changes(nb::class_<Scene>& scene)
{
    scene.def("set_material", when_idle(&Scene::set_material))
        .def("set_light", when_idle(&Scene::set_light))
        .def("set_environment", when_idle(&Scene::set_environment))
        .def("set_camera", when_idle(&Scene::set_camera))
        .def("set_shape_material", when_idle(&Scene::set_shape_material))
        .def("set_transform",
             [](Scene& s, int node, const Matrix& matrix) {
                 const BusyScene busy(s);
                 s.set_transform(node, to_transform(matrix));
             })
        .def("set_motion",
             [](Scene& s, int node, const std::vector<std::pair<double, Matrix>>& keys) {
                 const BusyScene busy(s);
                 s.set_motion(node, to_node_keys(keys));
             })
        .def(
            "set_vertices",
            [](Scene& s, int mesh, const FloatRows& positions, const std::optional<FloatRows>& normals) {
                const BusyScene busy(s);
                s.set_vertices(mesh, to_vector<Vec3f>(positions),
                               normals ? to_vector<Vec3f>(*normals) : std::vector<Vec3f>());
            },
            nb::arg("mesh"), nb::arg("positions"), nb::arg("normals").none())
        .def("set_vertex_motion", [](Scene& s, int mesh, const std::vector<std::pair<double, FloatRows>>& keys) {
            const BusyScene busy(s);
            s.set_vertex_motion(mesh, to_mesh_keys(keys));
        });
}

void bind_additions(nb::class_<Scene>& scene)
{
    scene
        .def(
            "add_mesh",
            [](Scene& s, const std::string& name, const FloatRows& positions, const Rows<std::uint32_t>& indices,
               std::optional<FloatRows> normals, std::optional<FloatRows> uvs, std::optional<FloatRows> colors,
               int material, const Matrix& transform) {
                const BusyScene busy(s);
                return add_mesh(s, name, {positions, indices, std::move(normals), std::move(uvs), std::move(colors)},
                                material, transform);
            },
            nb::arg("name"), nb::arg("positions"), nb::arg("indices"), nb::arg("normals").none(), nb::arg("uvs").none(),
            nb::arg("colors").none(), nb::arg("material"), nb::arg("transform"))
        .def("add_image",
             [](Scene& s, const std::string& name, const nb::bytes& bytes) { s.add_image(name, to_bytes(bytes)); })
        .def("add_material",
             [](Scene& s, const std::string& json, const std::string& name) {
                 const BusyScene busy(s);
                 s.restructure();
                 return s.builder.add_material(json, name);
             })
        .def("add_light",
             [](Scene& s, const std::string& json, const std::string& name) {
                 const BusyScene busy(s);
                 s.restructure();
                 return s.builder.add_light(json, name);
             })
        .def("add_node",
             [](Scene& s, const std::string& json) {
                 const BusyScene busy(s);
                 s.restructure();
                 return s.builder.add_node(json);
             })
        .def("set_render", [](Scene& s, const std::string& json) {
            const BusyScene busy(s);
            s.restructure();
            s.builder.set_render(json);
        });
}

void bind_contents(nb::class_<Scene>& scene)
{
    scene.def("placed_meshes", &placed_meshes)
        .def("world_transforms", &world_transforms)
        .def("transform", [](const Scene& s, int node) { return to_matrix(node_at(s, node).parent_from_node); })
        .def("shape_material", [](const Scene& s, int node,
                                  int shape) { return node_at(s, node).shapes.at(std::size_t(shape)).material; })
        .def("node_light", [](const Scene& s, int node) { return node_at(s, node).light; })
        .def("positions", [](const Scene& s, int mesh) { return rows_or_none<float>(mesh_at(s, mesh).positions); })
        .def("normals", [](const Scene& s, int mesh) { return rows_or_none<float>(mesh_at(s, mesh).normals); })
        .def("uvs", [](const Scene& s, int mesh) { return rows_or_none<float>(mesh_at(s, mesh).uvs[0]); })
        .def("colors", [](const Scene& s, int mesh) { return rows_or_none<float>(mesh_at(s, mesh).colors); })
        .def("indices",
             [](const Scene& s, int mesh) {
                 const std::vector<std::uint32_t>& indices = mesh_at(s, mesh).indices;
                 return to_array<std::uint32_t>(indices, {indices.size() / 3, 3});
             })
        .def("counts",
             [](const Scene& s) {
                 const SceneDescription& d = s.description();
                 return std::map<std::string, std::size_t>{
                     {"materials", d.materials.size()}, {"textures", d.textures.size()}, {"images", d.images.size()},
                     {"meshes", d.meshes.size()},       {"lights", d.lights.size()},     {"cameras", d.cameras.size()},
                     {"nodes", d.nodes.size()}};
             })
        .def("material_name", [](const Scene& s, int i) { return s.description().materials.at(std::size_t(i)).name; })
        .def("material_json", [](const Scene& s, int i) { return s.builder.material_json(i); })
        .def("texture_json", [](const Scene& s, int i) { return s.builder.texture_json(i); })
        .def("light_json", [](const Scene& s, int i) { return s.builder.light_json(i); })
        .def("camera_json", [](const Scene& s, int i) { return s.builder.camera_json(i); })
        .def("environment_json", [](const Scene& s) { return s.builder.environment_json(); })
        .def("file", [](const Scene& s) { return s.description().file; })
        .def("take_warnings", [](Scene& s) { return to_dict(s.builder.take_warnings()); })
        .def("set_own_light", [](Scene& s, bool own) { s.restructure().hints.own_light = own; })
        .def("was_compiled_whole", &Scene::was_compiled_whole)
        .def("embed_images", &embed_images)
        .def("save", &save);
}

}  // namespace

void bind_scene(nb::module_& module)
{
    nb::class_<Scene> scene(module, "Scene", "Scene of the C++ library; fathom.Scene wraps it.");
    scene.def("__init__", [](Scene* self) {
        SceneFileContents contents;
        contents.scene.hints.own_light = true;
        new (self) Scene(std::move(contents));
    });
    bind_additions(scene);
    bind_changes(scene);
    bind_contents(scene);
    module.def("load", &load);
    module.def("texture_parameters", &SceneBuilder::texture_parameters);
    module.def("render_options", [] {
        std::vector<std::tuple<std::string, std::string, std::string, std::string>> options;
        for (const cli::OptionText& text : cli::render_option_texts())
            options.emplace_back(text.name, text.value, text.help, text.default_text);
        return options;
    });
}

}  // namespace fathom::python
